"""What a pool's manifest says about each of its agents."""

from typing import Any, Literal

import msgspec


class Record(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A part of a manifest; what is not told is not written, so that it does not enter the hash."""


class SelfPlay(Record, frozen=True, kw_only=True):
    """What an agent reaches with itself.

    Attributes:
        mean: Soup reward of an episode, points.
        low: Lower end of the mean's 95 % interval over episodes.
        high: Upper end.
        episodes: How many were played.
    """

    mean: float
    low: float
    high: float
    episodes: int


class SeatProfile(Record, frozen=True, kw_only=True):
    """What the chef on one seat does in an episode with a copy of itself on the other one, on average.

    With a copy on the other seat the team's return is the same number for both seats, so a seat has its share of it:
    the points of the soups that its own chef delivers.

    Attributes:
        mean: Its share of the return, points; the two seats' sum is the team's.
        low: Lower end of the mean's 95 % interval over episodes.
        high: Upper end.
        partial_reward: Points for useful steps on the way (3 / 3 / 5).
        pots: Ingredients put into pots.
        plates: Soups put on plates.
        deliveries: Soups brought to the serving tile.
        counter_drops: Things put on counters.
        counter_pickups: Things taken from counters.
    """

    mean: float
    low: float
    high: float
    partial_reward: float
    pots: float
    plates: float
    deliveries: float
    counter_drops: float
    counter_pickups: float


class Profile(Record, frozen=True, kw_only=True):
    """How an agent behaves in the episodes of its `SelfPlay`.

    Attributes:
        entropy: Mean entropy of its action distribution over the states that it met, nats; ln 6 = 1.79 is uniform.
        seats: By seat.
    """

    entropy: float
    seats: tuple[SeatProfile, SeatProfile]


class HashedFile(Record, frozen=True, kw_only=True):
    """A file of the pool.

    Attributes:
        path: Relative to the pool's folder, with `/`.
        sha256: Of its content, hexadecimal.
    """

    path: str
    sha256: str


class PoolFiles(Record, frozen=True, kw_only=True):
    """An agent's two files.

    Attributes:
        weights: `<layout>/<name>.safetensors`.
        architecture: `<layout>/<name>.json`.
    """

    weights: HashedFile
    architecture: HashedFile


class AgentRecord(Record, frozen=True, kw_only=True):
    """How an agent of a pool came to be, and what it does.

    Attributes:
        name: Unique on its layout.
        layout: The shipped layout it plays.
        method: How it was trained, such as "self-play".
        seed: Its training seed.
        namespace: What the seed was derived in.
        lineage: Equal for agents that are tied by initialisation, training partners or checkpoints.
        training: The training's settings.
        steps: Joint steps of training up to this agent.
        cooking: Cooking mode it was trained under.
        mode: How its actions are chosen.
        self_play: Its return with itself.
        configuration: Name of the method's configuration that the settings came from; None in format 1.
        checkpoint: Share of its run's training that it has had, from 0 (untrained) to 1 (final); None in format 1.
        profile: What it does with itself; None in format 1.
    """

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


class PoolAgent(AgentRecord, frozen=True, kw_only=True):
    """One agent of a pool.

    Attributes:
        files: Where it lies.
    """

    files: PoolFiles

    @property
    def trained(self) -> float:
        """Share of its run's training that it has had; agents of format 1 are final."""
        return 1.0 if self.checkpoint is None else self.checkpoint


class Manifest(Record, frozen=True, kw_only=True):
    """What `manifest.json` holds.

    Attributes:
        format: Version of this file format.
        name: The pool's name.
        cooking: Cooking mode of all its agents.
        mode: How all its agents' actions are chosen.
        hash: SHA-256 of everything else, agents sorted by layout and name.
        agents: The entries.
    """

    format: int
    name: str
    cooking: Literal["auto", "manual"]
    mode: Literal["sample", "greedy"]
    hash: str
    agents: tuple[PoolAgent, ...]
