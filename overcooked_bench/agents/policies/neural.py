"""Neural agents: any number of frozen policies of one architecture, all rows of a batch in one stacked forward pass.

Axes: B rows (episodes), K policies, R rows of each policy.
"""

from collections.abc import Sequence
from typing import Any, Final, Literal

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.draws import ActionSampler
from overcooked_bench.agents.policies.policy import (
    ARCHITECTURES,
    Architecture,
    Cnn,
    Mlp,
    Policy,
    PolicyError,
    PolicyFiles,
    load_policy,
    save_policy,
)

__all__ = [
    "ARCHITECTURES",
    "MODES",
    "Architecture",
    "Cnn",
    "Mlp",
    "Mode",
    "NeuralAgent",
    "Policy",
    "PolicyError",
    "PolicyFiles",
    "PolicyStack",
    "load_policy",
    "save_policy",
]

Mode = Literal["sample", "greedy"]
MODES: Final = ("sample", "greedy")


class PolicyStack:
    """K policies of one architecture, computed together.

    Args:
        policies: One or more; their architectures must be equal.

    Attributes:
        architecture: The architecture that they share.
    """

    def __init__(self, policies: Sequence[Policy]) -> None:
        if not policies:
            raise ValueError("a PolicyStack needs at least one policy")
        self.architecture = policies[0].architecture
        for policy in policies:
            if policy.architecture != self.architecture:
                raise ValueError(
                    f"the policies {policies[0].name!r} and {policy.name!r} have different architectures "
                    f"({self.architecture} and {policy.architecture}); make one stack of each architecture"
                )
        self._size = len(policies)
        names = self.architecture.tensor_shapes()
        weights, self._live = self.architecture.narrowed({n: np.stack([p.weights[n] for p in policies]) for n in names})
        self._weights = {name: torch.tensor(array) for name, array in weights.items()}

    def __len__(self) -> int:
        """K."""
        return self._size

    def assign(self, index: ArrayLike) -> "Assignment":
        """Assigns rows to policies.

        Args:
            index: (B,) int, from 0 to K - 1, in any order. The forward pass costs least if all policies that occur have
                equally many rows.

        Raises:
            ValueError: Not whole numbers, or one out of range.
        """
        rows = checked_index(index, len(self))
        used, position = np.unique(rows, return_inverse=True)
        if len(used) == len(self):
            return Assignment(self.architecture, self._weights, self._live, position)
        chosen = torch.from_numpy(used.astype(np.int64))
        weights = {name: w[chosen] for name, w in self._weights.items()}
        return Assignment(self.architecture, weights, self._live, position)


class Assignment:
    """A stack with its rows assigned; `PolicyStack.assign` makes it, once for many steps.

    Rows of policies with memory start an episode when they are assigned, and each `probabilities` is a step of it.
    """

    def __init__(
        self,
        architecture: Architecture,
        weights: dict[str, torch.Tensor],
        live: NDArray[np.int64] | None,
        position: NDArray[np.int64],
    ) -> None:
        self._architecture, self._weights, self._live = architecture, weights, live
        counts = np.bincount(position)
        order = np.argsort(position, kind="stable")
        starts = np.cumsum(counts) - counts
        rank = np.empty(len(position), np.int64)
        rank[order] = np.arange(len(position)) - np.repeat(starts, counts)
        self._slots = position * counts.max() + rank  # row -> place in (K, R), flattened
        self._shape = len(counts), int(counts.max())
        self._dense = bool((self._slots == np.arange(len(position))).all()) and counts.min() == counts.max()
        seen = architecture.observation_shape if live is None else (len(live),)
        self._inputs = torch.zeros(*self._shape, *seen)  # places without a row stay 0
        self._memory = torch.zeros(*self._shape, architecture.remembered) if architecture.remembered else None

    def probabilities(self, observations: NDArray[Any]) -> NDArray[np.float32]:
        """Computes each row's policy in one forward pass.

        A row's result depends on its own observation and policy, and on its earlier observations where the policy has
        memory; it may differ in the last bits between batches of different numbers of rows.

        Args:
            observations: (B, *observation_shape).

        Returns:
            (B, 6) float32.
        """
        expected = (len(self._slots), *self._architecture.observation_shape)
        if observations.shape != expected:
            raise ValueError(f"observations have the shape {observations.shape}; these policies need {expected}")
        seen = observations if self._live is None else observations.reshape(len(observations), -1).take(self._live, 1)
        places = self._inputs.numpy().reshape(-1, *seen.shape[1:])
        places[slice(None) if self._dense else self._slots] = seen
        with torch.inference_mode():
            if self._memory is None:
                logits = self._architecture.forward(self._weights, self._inputs)
            else:
                logits, self._memory = self._architecture.advance(self._weights, self._inputs, self._memory)
            chances: NDArray[np.float32] = torch.softmax(logits, -1).flatten(0, 1).numpy()
        return chances if self._dense else chances[self._slots]


class NeuralAgent:
    """Frozen policies as an agent.

    Args:
        policies: One policy, or several of one architecture.
        mode: "sample" draws from the policy's distribution, "greedy" takes its likeliest action, the first one in a
            tie.
        index: (B,) int, which policy plays which row; needed with several policies. `assign` changes it later.

    Attributes:
        policies: The policies, in the order of the index.
        mode: How actions are chosen.
        observation: The policies' observation.
        layout: The layout they were trained on, the only one they play.
    """

    def __init__(
        self, policies: Policy | Sequence[Policy], mode: Mode = "sample", index: ArrayLike | None = None
    ) -> None:
        self.policies = (policies,) if isinstance(policies, Policy) else tuple(policies)
        self._stack = PolicyStack(self.policies)
        self.observation: str = self._stack.architecture.observation
        self.layout = self._stack.architecture.layout
        self.mode = checked_mode(mode)
        self._index = None if index is None else np.asarray(index)
        self._assignment: Assignment | None = None
        self._sampler = ActionSampler(np.zeros(0, np.uint64))

    def assign(self, index: ArrayLike) -> None:
        """Sets which policy plays which row from the next reset on; the index is that of `PolicyStack.assign`."""
        self._index = np.asarray(index)

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts B new episodes.

        Raises:
            UnknownLayout: The policies were trained on another layout.
            ValueError: Several policies and no index of this many rows.
        """
        if layout != self.layout:
            raise UnknownLayout(f"this policy was trained on {self.layout!r} and cannot play {layout!r}")
        self._assignment = self._stack.assign(self.index_for(len(seeds)))
        self._sampler = ActionSampler(seeds)

    def index_for(self, rows: int) -> NDArray[np.int64]:
        """Returns which policy plays each of so many rows.

        Raises:
            ValueError: Several policies and no index of this many rows.
        """
        return dealt_rows(self._index, len(self._stack), rows)

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action per row.

        Args:
            observations: (B, *observation_shape).

        Returns:
            (B,) int64.
        """
        if self._assignment is None:
            raise ValueError("act() came before reset()")
        chances = self._assignment.probabilities(np.asarray(observations))
        if self.mode == "sample":
            return self._sampler.draw(chances)
        actions: NDArray[np.int64] = chances.argmax(axis=1)
        return actions


def checked_mode(mode: Mode) -> Mode:
    """Checks and returns a mode.

    Raises:
        ValueError: There is no such mode.
    """
    if mode not in MODES:
        raise ValueError(f"mode is {mode!r}; choose 'sample' or 'greedy'")
    return mode


def checked_index(index: ArrayLike, policies: int) -> NDArray[np.int64]:
    """Checks and returns an index, which says which of so many policies plays which row.

    Raises:
        ValueError: Not whole numbers, or one out of range.
    """
    rows = np.asarray(index)
    if rows.ndim != 1 or not len(rows) or rows.dtype.kind not in "iu":
        raise ValueError(f"index is {rows.dtype} of the shape {rows.shape}; give one whole number per row")
    strange = rows[(rows < 0) | (rows >= policies)]
    if len(strange):
        raise ValueError(f"index names the policy {strange[0]}; there are policies 0 to {policies - 1}")
    return rows.astype(np.int64)


def dealt_rows(index: NDArray[np.int64] | None, policies: int, rows: int) -> NDArray[np.int64]:
    """Returns which of so many policies plays each of so many rows: by the index, or the only policy everywhere.

    Raises:
        ValueError: Several policies and no index of this many rows.
    """
    if index is None:
        if policies > 1:
            raise ValueError("several policies share this agent; say which plays which row: assign(index)")
        return np.zeros(rows, np.int64)
    if len(index) != rows:
        raise ValueError(f"{rows} episodes, but assign() was given {len(index)} rows")
    return index
