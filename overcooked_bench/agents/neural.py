"""Neural agents: any number of frozen policies of one architecture, all rows of a batch in one stacked forward.

Axes: B rows (episodes), K policies, R rows of each policy.
"""

from collections.abc import Sequence
from typing import Any, Final, Literal

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import UnknownLayout, sample_actions
from overcooked_bench.agents.policy import (
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
        architecture: The one they share.
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
        self._weights = {name: torch.from_numpy(np.stack([p.weights[name] for p in policies])) for name in names}

    def __len__(self) -> int:
        """K."""
        return self._size

    def assign(self, index: ArrayLike) -> "Assignment":
        """Says which policy plays which row.

        Args:
            index: (B,) int, from 0 to K - 1, in any order. The forward costs least where all policies that occur have
                equally many rows.

        Raises:
            ValueError: Not whole numbers, or one out of range.
        """
        rows = np.asarray(index)
        if rows.ndim != 1 or not len(rows) or rows.dtype.kind not in "iu":
            raise ValueError(f"index is {rows.dtype} of the shape {rows.shape}; give one whole number a row")
        if rows.min() < 0 or rows.max() >= len(self):
            raise ValueError(f"index names the policy {rows.max()}; this stack has policies 0 to {len(self) - 1}")
        used, position = np.unique(rows, return_inverse=True)
        if len(used) == len(self):
            return Assignment(self.architecture, self._weights, position)
        chosen = torch.from_numpy(used.astype(np.int64))
        return Assignment(self.architecture, {name: w[chosen] for name, w in self._weights.items()}, position)


class Assignment:
    """A stack with the rows dealt out; `PolicyStack.assign` makes it, once for many steps."""

    def __init__(
        self, architecture: Architecture, weights: dict[str, torch.Tensor], position: NDArray[np.int64]
    ) -> None:
        self._architecture, self._weights = architecture, weights
        counts = np.bincount(position)
        order = np.argsort(position, kind="stable")
        starts = np.cumsum(counts) - counts
        rank = np.empty(len(position), np.int64)
        rank[order] = np.arange(len(position)) - np.repeat(starts, counts)
        self._slots = position * counts.max() + rank  # row -> place in (K, R), flattened
        self._shape = len(counts), int(counts.max())
        self._dense = bool((self._slots == np.arange(len(position))).all()) and counts.min() == counts.max()

    def probabilities(self, observations: NDArray[Any]) -> NDArray[np.float32]:
        """Computes each row's policy in one forward.

        A row's result depends on its own observation and policy; it may differ in the last bits between batches of
        different numbers of rows.

        Args:
            observations: (B, *observation_shape).

        Returns:
            (B, 6) float32.
        """
        expected = (len(self._slots), *self._architecture.observation_shape)
        if observations.shape != expected:
            raise ValueError(f"observations have the shape {observations.shape}; these policies need {expected}")
        policies, rows = self._shape
        if self._dense:
            dealt = np.ascontiguousarray(observations)
        else:
            dealt = np.zeros((policies * rows, *expected[1:]), observations.dtype)
            dealt[self._slots] = observations
        with torch.inference_mode():
            inputs = torch.tensor(dealt, dtype=torch.float32).view(policies, rows, *expected[1:])
            logits = self._architecture.forward(self._weights, inputs)
            chances: NDArray[np.float32] = torch.softmax(logits, -1).view(policies * rows, -1).numpy()
        return chances if self._dense else chances[self._slots]


class NeuralAgent:
    """Frozen policies on a seat.

    Args:
        policies: One policy, or several of one architecture.
        mode: "sample" draws from the policy's distribution, "greedy" takes its likeliest action, the lowest of equals.
        index: (B,) int, which policy plays which row; needed with several policies. `assign` changes it later.

    Attributes:
        observation: What the policies see.
        layout: The layout they were trained on, the only one they play.
    """

    def __init__(
        self, policies: Policy | Sequence[Policy], mode: Mode = "sample", index: ArrayLike | None = None
    ) -> None:
        if mode not in MODES:
            raise ValueError(f"mode is {mode!r}; choose 'sample' or 'greedy'")
        self._stack = PolicyStack([policies] if isinstance(policies, Policy) else policies)
        self.observation: str = self._stack.architecture.observation
        self.layout = self._stack.architecture.layout
        self.mode = mode
        self._index = None if index is None else np.asarray(index)
        self._assignment: Assignment | None = None
        self._seeds = np.zeros(0, np.uint64)
        self._step = 0

    def assign(self, index: ArrayLike) -> None:
        """Says which policy plays which row from the next reset on; `PolicyStack.assign` tells the form."""
        self._index = np.asarray(index)

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts B new episodes.

        Raises:
            UnknownLayout: Another layout than the policies were trained on.
            ValueError: Several policies and no index of this many rows.
        """
        if layout != self.layout:
            raise UnknownLayout(f"this policy was trained on {self.layout!r} and cannot play {layout!r}")
        index = self._index
        if index is None:
            if len(self._stack) > 1:
                raise ValueError("several policies share this agent; say which plays which row: assign(index)")
            index = np.zeros(len(seeds), np.int64)
        if len(index) != len(seeds):
            raise ValueError(f"{len(seeds)} episodes, but assign() dealt out {len(index)} rows")
        self._assignment = self._stack.assign(index)
        self._seeds, self._step = np.asarray(seeds, np.uint64), 0

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action a row.

        Args:
            observations: (B, *observation_shape).

        Returns:
            (B,) int64.
        """
        if self._assignment is None:
            raise ValueError("act() came before reset()")
        chances = self._assignment.probabilities(np.asarray(observations))
        step, self._step = self._step, self._step + 1
        if self.mode == "sample":
            return sample_actions(chances, self._seeds, step)
        actions: NDArray[np.int64] = chances.argmax(axis=1)
        return actions
