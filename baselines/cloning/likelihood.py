"""How well a frozen policy foretells what people did, beside simple guesses."""

from typing import NamedTuple

import numpy as np
import torch

from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.kitchen.codes import NUM_ACTIONS, STAY
from overcooked_bench.kitchen.layout import Layout

from ..learning.inputs import spreader
from ..learning.pressure import member_logs
from .clone import nats_per_step
from .examples import Examples


class Foretold(NamedTuple):
    """How likely people's actions were under a guess; pairs of people weigh the same.

    Attributes:
        nats: Mean negative log-likelihood per step; ln 6 = 1.79 is uniform.
        accuracy: Share of steps on which the likeliest action was the one taken.
    """

    nats: float
    accuracy: float


def foretell(policy: Policy, rows: Examples) -> Foretold:
    """Judges a frozen policy on rows of its own observation and layout."""
    return _judged(policy_logs(policy, rows), rows)


def policy_logs(policy: Policy, rows: Examples) -> torch.Tensor:
    """Returns the (N, 6) log-probabilities of a frozen policy."""
    said = policy.architecture
    spread = spreader(Layout.load(said.layout), said.observation, said.observation_shape)
    return member_logs([policy], lambda begin, end: spread(rows.seen[begin:end]), len(rows))


def uniform(rows: Examples) -> Foretold:
    """Judges the guess that all actions are equally likely."""
    return _judged(torch.full((len(rows), NUM_ACTIONS), -float(np.log(NUM_ACTIONS))), rows)


def frequencies(known: Examples, rows: Examples) -> Foretold:
    """Judges the guess that the actions are as frequent as among other people.

    Args:
        known: Those people.
        rows: Whom to foretell.
    """
    counts = np.bincount(known.actions.numpy(), minlength=NUM_ACTIONS) + 1.0
    logs = np.log(counts / counts.sum())
    return _judged(torch.from_numpy(np.tile(logs, (len(rows), 1))), rows)


def last_action(known: Examples, rows: Examples) -> Foretold:
    """Judges the guess that looks at the chef's last action alone, with the transitions of other people.

    Args:
        known: Those people.
        rows: Whom to foretell; a game's first step counts as one after a stay.
    """
    counts = np.ones((NUM_ACTIONS, NUM_ACTIONS))
    np.add.at(counts, (_before(known), known.actions.numpy()), 1)
    logs = np.log(counts / counts.sum(axis=1, keepdims=True))
    return _judged(torch.from_numpy(logs[_before(rows)]), rows)


def _before(rows: Examples) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    before = np.roll(rows.actions.numpy(), 1)
    before[rows.firsts] = STAY
    return before


def _judged(logs: torch.Tensor, rows: Examples) -> Foretold:
    right = (logs.argmax(1) == rows.actions).numpy()
    accuracy = float(np.mean([right[rows.pairs == name].mean() for name in rows.people]))
    return Foretold(nats_per_step(logs, rows), accuracy)
