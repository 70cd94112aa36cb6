"""Reads manifests of all older formats.

Formats 1 and 2 list trained agents alone; the protocol named the scripted partners, whatever the pool.
"""

from collections.abc import Callable
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.agents.pools.records import (
    Entry,
    HashedFile,
    Manifest,
    PolicyReference,
    Profile,
    Record,
    Role,
    ScriptedReference,
    SelfPlay,
    Training,
)

_BESIDE: Final[tuple[tuple[str, Role], ...]] = (
    ("onion_courier", "partner"),
    ("dish_courier", "partner"),
    ("greedy", "partner"),
    ("random", "floor"),
    ("stay", "floor"),
)
"""The scripted partners that the first protocol added to every pool, all in version 1."""


class _Files(Record, frozen=True, kw_only=True):
    weights: HashedFile
    architecture: HashedFile


class _Agent(Record, frozen=True, kw_only=True):
    """A trained agent in formats 1 and 2; the optional keys came with format 2."""

    name: str
    layout: str
    method: str
    seed: int
    namespace: str
    lineage: str
    training: dict[str, Any]
    steps: int
    cooking: Literal["auto", "manual"]
    mode: Literal["sample", "greedy"]
    self_play: SelfPlay
    configuration: str | None = None
    checkpoint: float | None = None
    profile: Profile | None = None
    files: _Files


class _Agents(Record, frozen=True, kw_only=True):
    """A manifest of format 1 or 2."""

    format: int
    name: str
    cooking: Literal["auto", "manual"]
    mode: Literal["sample", "greedy"]
    hash: str
    agents: tuple[_Agent, ...]


def _from_1(data: bytes) -> tuple[Manifest, bytes]:
    return _from_agents(data, "has", lambda told: told is not None)


def _from_2(data: bytes) -> tuple[Manifest, bytes]:
    return _from_agents(data, "lacks", lambda told: told is None)


UPGRADES: Final[dict[int, Callable[[bytes], tuple[Manifest, bytes]]]] = {1: _from_1, 2: _from_2}
"""For each older format: converts a file's content to the manifest in the current format, and to the hashed bytes.

Raises ValueError if the content is not of that format.
"""


def _from_agents(data: bytes, verb: str, wrong: Callable[[Any], bool]) -> tuple[Manifest, bytes]:
    old = msgspec.json.decode(data, type=_Agents)
    for agent in old.agents:
        for key in ("configuration", "checkpoint", "profile"):
            if wrong(getattr(agent, key)):
                raise ValueError(
                    f"agent {agent.layout}/{agent.name}: it {verb} {key!r}, which came with format 2; this one is "
                    f"{old.format}"
                )
        if (agent.cooking, agent.mode) != (old.cooking, old.mode):
            raise ValueError(
                f"agent {agent.layout}/{agent.name}: cooking {agent.cooking!r} and mode {agent.mode!r} in a pool of "
                f"{old.cooking!r} and {old.mode!r}; make one pool of each"
            )
    layouts = sorted({agent.layout for agent in old.agents})
    beside = [scripted_entry(name, layout, role) for layout in layouts for name, role in _BESIDE]
    manifest = Manifest(
        format=old.format,
        name=old.name,
        cooking=old.cooking,
        mode=old.mode,
        hash=old.hash,
        entries=(*map(_entry, old.agents), *beside),
    )
    hashed = tuple(sorted(old.agents, key=lambda agent: (agent.layout, agent.name)))
    return manifest, msgspec.json.encode(msgspec.structs.replace(old, hash="", agents=hashed), order="sorted")


def scripted_entry(name: str, layout: str, role: Role, version: int = 1) -> Entry:
    """Returns the entry of a scripted agent."""
    reference = ScriptedReference(agent=name, version=version)
    return Entry(
        name=name, layout=layout, reference=reference, role=role, stratum="scripted", lineage=f"scripted/{name}"
    )


def _entry(agent: _Agent) -> Entry:
    training = Training(
        method=agent.method,
        seed=agent.seed,
        namespace=agent.namespace,
        settings=agent.training,
        steps=agent.steps,
        self_play=agent.self_play,
        configuration=agent.configuration,
        checkpoint=agent.checkpoint,
        profile=agent.profile,
    )
    return Entry(
        name=agent.name,
        layout=agent.layout,
        reference=PolicyReference(weights=agent.files.weights, architecture=agent.files.architecture),
        role="partner",
        stratum=training.stratum,
        lineage=agent.lineage,
        training=training,
    )
