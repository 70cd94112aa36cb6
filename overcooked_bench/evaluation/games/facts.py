"""`Facts`: what a store says about its score, checked once for everybody who reads it."""

from typing import Annotated

import msgspec
from msgspec import Meta

from overcooked_bench.evaluation.games.store import Store, StoreError


class Facts(msgspec.Struct, frozen=True, kw_only=True):
    """What a store says about its score besides the protocol and the partners; a text is empty if it does not say.

    Attributes:
        protocol: Hash of what was played.
        agent: Hash of the scored agent.
        agent_name: What it was called.
        agent_given: How it was named, unless by an absolute path.
        pool: Hash of the pool, "none" without one.
        pool_name: What it was called.
        pool_given: How it was named, unless by an absolute path.
        seed: The score's seed.
        salt: The run's salt.
        training_seeds: S; None in stores of older versions.
    """

    protocol: str = ""
    agent: str = ""
    agent_name: str = ""
    agent_given: str = ""
    pool: str = "none"
    pool_name: str = ""
    pool_given: str = ""
    seed: Annotated[int, Meta(ge=-(2**63), le=2**63 - 1)] = 0
    salt: str = ""
    training_seeds: Annotated[int, Meta(ge=1, le=2**63 - 1)] | None = None


def read_facts(store: Store) -> Facts:
    """Reads what a store says about its score.

    Raises:
        StoreError: A number is none, or out of range; names the file and the key.
    """
    try:
        return msgspec.convert(store.facts, Facts, strict=False)
    except msgspec.ValidationError as error:
        raise StoreError(f"{store.file}: what identifies the score cannot be used ({error})") from None
