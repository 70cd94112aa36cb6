"""Agents that consist of many frozen policies of several architectures, fixed or sampled for each episode.

Axes: B rows (episodes), P policies.
"""

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.draws import uniforms
from overcooked_bench.agents.policies.architecture import Architecture
from overcooked_bench.agents.policies.neural import Mode, NeuralAgent, checked_index, checked_mode, dealt_rows
from overcooked_bench.agents.policies.policy import Policy


class Ensemble:
    """Frozen policies of one observation and layout, each of which plays its own rows.

    All rows of one architecture are computed in one stacked forward pass. A row plays as its policy's `NeuralAgent`
    does, up to rounding.

    Args:
        policies: One or more.
        mode: "sample" draws from a policy's distribution, "greedy" takes its likeliest action, the first one in a tie.

    Attributes:
        policies: The policies, in the order of the index.
        mode: How actions are chosen.
        observation: The policies' observation.
        layout: The layout they were trained on, the only one they play.

    Raises:
        ValueError: No policy, or two that see different observations or play different layouts.
    """

    def __init__(self, policies: Sequence[Policy], mode: Mode = "sample") -> None:
        self.policies = tuple(policies)
        if not self.policies:
            raise ValueError(f"{type(self).__name__} needs at least one policy")
        first = self.policies[0]
        self.mode = checked_mode(mode)
        self.observation: str = first.architecture.observation
        self.layout = first.architecture.layout
        for policy in self.policies:
            said = policy.architecture
            if (said.observation, said.layout) != (self.observation, self.layout):
                raise ValueError(
                    f"the policy {first.name!r} sees {self.observation!r} on {self.layout!r}, and {policy.name!r} sees "
                    f"{said.observation!r} on {said.layout!r}; put together policies of one observation and layout"
                )
        kinds: dict[Architecture, list[int]] = {}
        for i, policy in enumerate(self.policies):
            kinds.setdefault(policy.architecture, []).append(i)
        self._kind = np.empty(len(self.policies), np.int64)  # policy -> architecture
        self._place = np.empty(len(self.policies), np.int64)  # policy -> place in its architecture's stack
        for kind, members in enumerate(kinds.values()):
            self._kind[members], self._place[members] = kind, np.arange(len(members))
        self._stacks = [NeuralAgent([self.policies[i] for i in members], mode) for members in kinds.values()]
        self._playing: list[tuple[NeuralAgent, NDArray[np.int64]]] = []
        self._index: NDArray[np.int64] | None = None
        self._members = np.zeros(0, np.int64)

    @property
    def members_of_rows(self) -> NDArray[np.int64]:
        """Which policy plays each row of the running episodes, (B,)."""
        return self._members.copy()

    def assign(self, index: ArrayLike) -> None:
        """Sets which policy plays which row from the next reset on.

        Args:
            index: (B,) whole numbers from 0 to P - 1, in any order. The forward pass costs least if all policies that
                occur have equally many rows, in neighbouring groups.

        Raises:
            ValueError: Not whole numbers, or one out of range.
        """
        self._index = checked_index(index, len(self.policies))

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts B new episodes.

        Raises:
            UnknownLayout: The policies were trained on another layout.
            ValueError: `assign` gave another number of rows; with a single policy it need not be called.
        """
        if layout != self.layout:
            raise UnknownLayout(f"these policies were trained on {self.layout!r} and cannot play {layout!r}")
        self._members = self._dealt(np.asarray(seeds, np.uint64))
        self._playing = []
        for kind, agent in enumerate(self._stacks):
            rows = np.flatnonzero(self._kind[self._members] == kind)
            if len(rows):
                agent.assign(self._place[self._members[rows]])
                agent.reset(layout, seats[rows], seeds[rows])
                self._playing.append((agent, rows))

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action per row.

        Args:
            observations: (B, *observation_shape).

        Returns:
            (B,) int64.
        """
        seen = np.asarray(observations)
        if not self._playing:
            raise ValueError("act() came before reset()")
        if len(seen) != len(self._members):
            raise ValueError(f"{len(seen)} observations for {len(self._members)} episodes")
        if len(self._playing) == 1:
            return self._playing[0][0].act(seen)
        actions = np.empty(len(seen), np.int64)
        for agent, rows in self._playing:
            actions[rows] = agent.act(seen[rows])
        return actions

    def _dealt(self, seeds: NDArray[np.uint64]) -> NDArray[np.int64]:
        """Returns the policy of each row that is about to start."""
        return dealt_rows(self._index, len(self.policies), len(seeds))


class JoinedAgents(Ensemble):
    """Several neural agents as one, each with a block of adjacent rows.

    Args:
        agents: Agents of one observation, layout and mode; each keeps its own index, read at every reset.
        rows: Number of rows of each agent.

    Raises:
        ValueError: Agents of different modes, or what `Ensemble` refuses.
    """

    def __init__(self, agents: Sequence[NeuralAgent], rows: Sequence[int]) -> None:
        super().__init__([policy for agent in agents for policy in agent.policies], agents[0].mode)
        if len({agent.mode for agent in agents}) > 1:
            raise ValueError("some agents sample and others are greedy; join agents of one mode")
        self._agents, self._rows = tuple(agents), tuple(rows)

    def _dealt(self, seeds: NDArray[np.uint64]) -> NDArray[np.int64]:
        firsts = np.cumsum([0, *(len(agent.policies) for agent in self._agents)])
        parts = zip(firsts, self._agents, self._rows, strict=False)
        return np.concatenate([first + agent.index_for(rows) for first, agent, rows in parts])


class SampledPartners(Ensemble):
    """Frozen policies of which a few, sampled at each reset, share the rows.

    The sample depends on the seeds of the reset alone, so no state has to be saved to resume.

    Args:
        policies: The policies to sample from, uniformly and without replacement.
        per_episode: How many play at a time, in equal groups of adjacent rows (sizes differ by one at most).
        mode: As in `Ensemble`.

    Raises:
        ValueError: Fewer policies than are to be drawn, or what `Ensemble` refuses.
    """

    def __init__(self, policies: Sequence[Policy], per_episode: int = 3, mode: Mode = "sample") -> None:
        super().__init__(policies, mode)
        if not 1 <= per_episode <= len(self.policies):
            raise ValueError(
                f"per_episode={per_episode} with {len(self.policies)} policies; give a number from 1 up to theirs"
            )
        self.per_episode = per_episode

    def assign(self, index: ArrayLike) -> None:
        """Refuses: the seeds of `reset` determine who plays.

        Raises:
            ValueError: Always.
        """
        raise ValueError("SampledPartners samples who plays at each reset; to assign rows yourself use Ensemble")

    def _dealt(self, seeds: NDArray[np.uint64]) -> NDArray[np.int64]:
        """Draws the members by a hash of all seeds.

        Raises:
            ValueError: Fewer rows than members.
        """
        if len(seeds) < self.per_episode:
            raise ValueError(f"{self.per_episode} members for {len(seeds)} episodes; each needs at least one episode")
        digest = hashlib.sha256(seeds.astype("<u8").tobytes()).digest()
        own = np.arange(len(self.policies), dtype=np.uint64) ^ np.uint64(int.from_bytes(digest[:8], "little"))
        lots = uniforms(own, 0)
        drawn = np.argsort(lots, kind="stable")[: self.per_episode]
        sizes = [len(part) for part in np.array_split(seeds, self.per_episode)]
        return np.repeat(drawn, sizes)
