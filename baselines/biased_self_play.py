"""Biased self-play: each chef is also rewarded for its own events, with weights drawn for each run.

The agents come out with habits: they like or avoid onions, dishes, counters. They make partners, not scores. Event
rewards grow while partial rewards are annealed, so that an agent that is to avoid dishes still learns to serve; a run
that still delivers hardly any soups is restarted with a new seed and new weights.

Source: Yu et al. 2023, hidden-utility self-play (HSP), whose biased policies are self-play agents under event-weighted
rewards. Events, weights and their growth are our own: a liked event pays less than a soup brings in the time it takes.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from .learning.algorithms import make_learner
from .learning.learner import Learner
from .learning.settings import Settings, SettingsError
from .running.place import Place
from .running.run import Outcome, UnfitError, make_env, run
from .running.seeds import part_of, restarted

METHOD: Final = "biased-self-play"


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy on both seats under rewards that are weighted by events."""

    biased_events: tuple[str, ...] = (
        *("onion_pickup", "onion_drop", "potting_onion"),
        *("dish_pickup", "dish_drop", "soup_pickup", "soup_delivery"),
    )
    """Events that a chef may be paid for, by the names of the reference kitchen."""
    bias_weights: tuple[float, ...] = (-1.0, 0.0, 0.5)
    """What an event may pay, in points; each event's weight is drawn from these, uniformly, by the attempt's seed."""
    check_share: float = 0.7
    """Share of the steps after which a run that delivers too little is restarted with a derived seed; 0 never."""
    check_soups: float = 1.0
    """Soups of an episode, on average, that the check asks for."""
    restarts: int = 8
    """Restarts at most; the last attempt goes on whatever the check says."""

    def __post_init__(self) -> None:
        """Checks the bias too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        Settings.__post_init__(self)
        if not self.biased_events or not self.bias_weights:
            raise SettingsError(
                "biased_events and bias_weights need at least one entry each; without bias use self-play"
            )

    def event_share_at(self, done: int) -> float:
        """Returns the share of what events pay besides, after `done` joint steps.

        It is 0 until half of the partial rewards has faded, and grows to 1 while the other half fades.
        """
        return max(0.0, 1 - 2 * self.shaping_at(done))


def event_weights(config: Config, seed: int) -> dict[str, float]:
    """Draws the points that each event pays from the seed of an attempt; never none at all."""
    rng = np.random.default_rng(part_of(seed, "event weights"))
    for _ in range(1000):
        drawn = rng.choice(config.bias_weights, len(config.biased_events))
        if drawn.any():
            return {event: float(weight) for event, weight in zip(config.biased_events, drawn, strict=True)}
    raise UnfitError(f"bias_weights={config.bias_weights}; give at least one weight that is not 0")


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""
    attempts = 1 + (config.restarts if config.check_share else 0)
    weights = {own: event_weights(config, own) for own in (restarted(place.seed, k) for k in range(attempts))}

    def make(seed: int) -> Learner:
        return make_learner(config, make_env(config, self_play=True, event_rewards=weights[seed]), seed)

    known = {"event_rewards": list(weights.values())}  # of each attempt
    return run(config, METHOD, place, make, known=known)
