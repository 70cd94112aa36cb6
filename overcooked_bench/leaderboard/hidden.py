"""The hidden tier: pools whose hashes are published before anybody is scored with them, and their weights later."""

from importlib.resources import files
from pathlib import Path
from typing import Annotated, Final

import msgspec
from msgspec import Meta

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.files import read_text

HIDDEN: Final = Path(str(files("overcooked_bench.baselines")), "pools", "hidden.yaml")
"""The shipped list."""

Hash = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
Day = Annotated[str, Meta(pattern=r"^\d{4}-\d\d-\d\d$")]


class HiddenPool(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A pool that maintainers keep back.

    Attributes:
        name: As its manifest says.
        twin_of: The shipped pool that was built from the same recipe.
        sha256: Hash of the pool, as its manifest.json says it; covers the files of all agents.
        partners: Number of its agents over all layouts, floors included.
        published: The day on which the hash was published, YYYY-MM-DD.
        revealed: The day on which its weights were published; None as long as they are not.
    """

    name: str
    twin_of: str
    sha256: Hash
    partners: Annotated[int, Meta(ge=1)]
    published: Day
    revealed: Day | None = None


class _Listed(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    pools: tuple[HiddenPool, ...]


def hidden_pools(file: str | Path = HIDDEN) -> tuple[HiddenPool, ...]:
    """Reads the list of hidden pools.

    Raises:
        WrongUse: It cannot be read; names the line.
    """
    return parse_yaml(read_text(file, LONGEST), str(file)).convert(_Listed).pools


def hidden_pool(sha256: str) -> HiddenPool | None:
    """Returns the hidden pool of a hash, None if no such hash was published."""
    return next((pool for pool in hidden_pools() if pool.sha256 == sha256), None)
