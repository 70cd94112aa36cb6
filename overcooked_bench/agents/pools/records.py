"""The entries of a pool's manifest."""

import json
from typing import Any, Literal

import msgspec

from overcooked_bench.agents.scripted import scripted_sha256

Role = Literal["partner", "floor"]
"""A partner counts; a floor is played and shown, and enters no score."""


class Record(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A part of a manifest. Optional keys default to None and are then left out of the file and of its hash."""


class SelfPlay(Record, frozen=True, kw_only=True):
    """An agent's return with itself.

    Attributes:
        mean: Soup reward per episode, points.
        low: Lower end of the mean's 95 % interval over episodes.
        high: Upper end.
        episodes: Number of episodes.
    """

    mean: float
    low: float
    high: float
    episodes: int


class SeatProfile(Record, frozen=True, kw_only=True):
    """The average play of the chef on one seat, per episode, with a copy of itself on the other seat.

    With a copy on the other seat the team's return is the same number for both seats, so a seat has its share of it:
    the points of the soups that its own chef delivers.

    Attributes:
        mean: Its share of the return, points; the two seats' sum is the team's.
        low: Lower end of the mean's 95 % interval over episodes.
        high: Upper end.
        partial_reward: Points for useful steps on the way (3 / 3 / 5).
        pots: Ingredients put into pots.
        plates: Soups put on plates.
        deliveries: Soups delivered.
        counter_drops: Objects put on counters.
        counter_pickups: Objects taken from counters.
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
        entropy: Mean entropy of its action distribution over the states that it visited, nats; ln 6 = 1.79 is uniform.
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


class PolicyReference(Record, frozen=True, kw_only=True, tag_field="kind", tag="policy"):
    """A frozen policy: two files in the pool's folder.

    Attributes:
        weights: `<layout>/<name>.safetensors`.
        architecture: `<layout>/<name>.json`.
    """

    weights: HashedFile
    architecture: HashedFile

    @property
    def sha256(self) -> str:
        """Hash of the weights."""
        return self.weights.sha256


class ScriptedReference(Record, frozen=True, kw_only=True, tag_field="kind", tag="scripted"):
    """A scripted agent of the catalogue.

    Attributes:
        agent: Its name there.
        version: The version that the pool requires; no other one is played.
    """

    agent: str
    version: int

    @property
    def sha256(self) -> str:
        """Hash of name and version, that of the catalogue."""
        return scripted_sha256(self.agent, self.version)


class BehaviourReference(Record, frozen=True, kw_only=True, tag_field="kind", tag="behaviour"):
    """A behaviour, as scenarios write their partners.

    Attributes:
        behaviour: The mapping with `does` and its parameters.
        version: The version of the language of behaviours that the pool requires; no other one is played.
    """

    behaviour: dict[str, Any]
    version: int

    @property
    def text(self) -> str:
        """The mapping as the catalogue reads it."""
        return json.dumps(self.behaviour, sort_keys=True)

    @property
    def sha256(self) -> str:
        """Hash of the mapping and the version, that of the catalogue."""
        return scripted_sha256(f"script:{self.text}/{self.version}", 1)


class Training(Record, frozen=True, kw_only=True):
    """How a frozen policy was trained, and how it plays.

    Attributes:
        method: How it was trained, such as "self-play".
        seed: Its training seed.
        namespace: The namespace in which the seed was derived.
        settings: The training's settings.
        steps: Joint steps of training up to this policy.
        self_play: Its return with itself.
        configuration: Name of the method's configuration that the settings came from; None in format 1.
        checkpoint: Share of its run's training at which it was saved, from 0 (untrained) to 1 (final); None in format
            1.
        profile: How it plays with itself; None in format 1.
        codebase: The project whose training code made it, such as "stable-baselines3"; None for this one.
    """

    method: str
    seed: int
    namespace: str
    settings: dict[str, Any]
    steps: int
    self_play: SelfPlay
    configuration: str | None = None
    checkpoint: float | None = None
    profile: Profile | None = None
    codebase: str | None = None

    @property
    def done(self) -> float:
        """Share of its run's training at which it was saved; policies of format 1 are final."""
        return 1.0 if self.checkpoint is None else self.checkpoint

    @property
    def stratum(self) -> str:
        """The stratum of a policy for which the manifest gives no other."""
        if self.method == "human-proxy":
            return "human"
        if self.done < 1:
            return "half-trained" if self.done > 0 else "untrained"
        return {"self-play": "self-play", "biased-self-play": "biased"}.get(self.method, "generalist")


class Bound(Record, frozen=True, kw_only=True):
    """The returns that can be reached with a partner from one side, both seats together.

    Attributes:
        side: Region that the other agent starts in; 0 if the floor is one region.
        floor: Points per episode of the better of `stay` and `random`.
        floor_agent: Which of the two it is.
        ceiling: Points per episode of the best known responder, in episodes that it was not chosen by.
        low: Lower end of the ceiling's 95 % interval over start states.
        high: Upper end.
        episodes: Number of these episodes.
        responder: Reference of the best known responder.
        responder_sha256: Its hash.
    """

    side: int
    floor: float
    floor_agent: Literal["stay", "random"]
    ceiling: float
    low: float
    high: float
    episodes: int
    responder: str
    responder_sha256: str


class Entry(Record, frozen=True, kw_only=True):
    """One partner on one layout.

    Attributes:
        name: Unique on its layout.
        layout: The shipped layout that it plays; for scripted partners also a grid's text.
        reference: The agent that plays; None only for `write_manifest`, which hashes the policy's files at
            `<layout>/<name>`.
        role: "partner" counts, "floor" is shown apart.
        stratum: Its origin: "self-play", "biased", "half-trained", "generalist", "scripted", "human", ...
        lineage: Equal for entries that are tied by initialisation, training partners, data or checkpoints.
        convention: What it does where agents have to agree, such as "onions=top, dishes=bottom"; None if it was not
            measured.
        bounds: The returns that can be reached with it, by side; None if they have not been measured.
        training: How it was trained; None for kinds other than policies.
        people: Whose recorded games it was made from, or its training partners were, such as "2019-07" for a pair of
            2019; None if no person's.
        weight: Its share of its stratum's weight on its layout, from 0 to 1; None if all partners weigh the same.
    """

    name: str
    layout: str
    reference: PolicyReference | ScriptedReference | BehaviourReference | None
    role: Role
    stratum: str
    lineage: str
    convention: str | None = None
    bounds: tuple[Bound, ...] | None = None
    training: Training | None = None
    people: tuple[str, ...] | None = None
    weight: float | None = None

    @property
    def sha256(self) -> str:
        """Hash of the agent that plays."""
        assert self.reference is not None
        return self.reference.sha256

    @property
    def trained(self) -> Training:
        """How the policy was trained; only for entries of policies."""
        assert self.training is not None
        return self.training


class Manifest(Record, frozen=True, kw_only=True):
    """The content of `manifest.json`.

    Attributes:
        format: Version of the file's format.
        name: The pool's name.
        cooking: Cooking mode of all its partners.
        mode: How its policies' actions are chosen.
        hash: SHA-256 of everything else, entries sorted by layout and name; of an older format that of the file.
        entries: The partners.
        frozen: False for a release candidate, which may still be mended; not part of the hash.
    """

    format: int
    name: str
    cooking: Literal["auto", "manual"]
    mode: Literal["sample", "greedy"]
    hash: str
    entries: tuple[Entry, ...]
    frozen: bool = True
