"""The settings of every PPO run, with the values of the `fast` configuration as defaults."""

from dataclasses import dataclass, fields
from math import inf, isfinite
from typing import Final, Literal

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation

from .people import people_behind

_COUNTS: Final = ("num_kitchens", "rollout", "epochs", "minibatches", "horizon", "filters", "previous", "threads")
_SHARES: Final = ("gamma", "gae_lambda", "entropy_share", "shaping_share", "check_share", "object_probability")
_FROM_0: Final = ("learning_rate_end", "value_coefficient", "entropy_start", "entropy_end", "restarts", "check_soups")
_RANGES: Final = (
    (_COUNTS, 1, inf, "a number from 1"),
    (_SHARES, 0, 1, "a share from 0 to 1"),
    (("learning_rate", "clip", "max_grad_norm"), 1e-12, 1e12, "a number above 0"),
    (_FROM_0, 0, 1e12, "a number from 0"),
)
"""Groups of settings with their bounds, and the bounds in words."""


class SettingsError(WrongUse):
    """A setting is out of range; the message names it and says what it may be."""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Trains a policy by PPO."""

    layout: str
    """Shipped layout, grid text or `.layout` file."""
    seed: int = 0
    """Training seed; the generator's seed is a hash of it, the layout and the method."""
    steps: int = 1_000_000
    """Joint steps of training."""
    num_kitchens: int = 64
    """Number of kitchens that run in parallel."""
    rollout: int = 200
    """Steps of each kitchen between updates."""
    epochs: int = 4
    """Epochs per rollout."""
    minibatches: int = 16
    """Minibatches per epoch."""
    learning_rate: float = 2e-3
    """Adam's initial learning rate, annealed linearly."""
    learning_rate_end: float = 0.0
    """Adam's final learning rate."""
    gamma: float = 0.99
    """Discount factor per step."""
    gae_lambda: float = 0.95
    """Lambda of generalised advantage estimation (GAE)."""
    clip: float = 0.2
    """PPO's clipping range."""
    value_coefficient: float = 0.05
    """Value-loss coefficient. At 0.5 the value gradient dominates the jointly clipped gradient and the policy barely
    learns."""
    max_grad_norm: float = 0.5
    """Gradient-norm clipping threshold."""
    entropy_start: float = 0.03
    """Initial entropy coefficient, annealed linearly."""
    entropy_end: float = 0.01
    """Final entropy coefficient."""
    entropy_share: float = 1.0
    """Share of the steps over which the entropy coefficient is annealed."""
    shaping_share: float = 2 / 3
    """Share of the steps over which the weight of partial rewards is annealed linearly from 1 to 0."""
    network: Literal["mlp", "cnn"] = "mlp"
    """mlp: fully connected layers; cnn: three convolutions, then fully connected layers."""
    hidden: tuple[int, ...] = (64, 64)
    """Widths of the fully connected layers that actor and critic share."""
    filters: int = 25
    """Filters of each convolution (network cnn)."""
    previous: int = 16
    """Width of the small layer on each older state (network cnn, observation stack_states)."""
    observation: str = "lossless"
    """Name of the policy's observation; `overcooked-bench list observations` shows all."""
    cooking: Literal["auto", "manual"] = "auto"
    """auto: a pot starts by itself at the third ingredient; manual: an empty-handed interact starts it."""
    start: Literal["random", "standard"] = "random"
    """random: random floor cells; standard: the layout's start cells."""
    object_probability: float = 0.0
    """Chance of each pot and each pair of hands to be filled at the start."""
    horizon: int = 400
    """Steps per episode."""
    check_share: float = 0.0
    """Share of the steps after which a run that delivers fewer than `check_soups` soups is restarted with a derived
    seed; 0 switches the check off."""
    check_soups: float = 3.0
    """Mean soups per episode below which the check restarts a run."""
    restarts: int = 3
    """Maximum number of restarts; the last attempt continues whatever the check finds."""
    snapshots: tuple[float, ...] = ()
    """Shares of the steps, such as 0.5, at which the policy is also saved."""
    threads: int = 1
    """Number of threads that torch uses."""
    device: Literal["cpu", "cuda"] = "cpu"
    """Device that torch trains on."""

    def __post_init__(self) -> None:
        """Refuses settings that PPO cannot run with.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        for names, least, most, wanted in _RANGES:
            for name in names:
                if not least <= getattr(self, name) <= most:
                    raise SettingsError(f"{name}={getattr(self, name)}; give {wanted}")
        for field in fields(self):
            value = getattr(self, field.name)
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, float) and not isfinite(number):
                    raise SettingsError(f"{field.name}={value}; give finite numbers")
        update = self.num_kitchens * self.rollout
        if self.steps < 2 * update:
            raise SettingsError(f"steps={self.steps}; give at least two updates, {2 * update} joint steps")
        rows = self.learning_seats * update
        if rows % self.minibatches or rows == self.minibatches:
            raise SettingsError(
                f"minibatches={self.minibatches}; give a divisor of the {rows} steps of {self.learners} in an update"
            )
        seen = find_observation(self.observation)
        known = isinstance(self.layout, str) and self.layout  # a blank template has no layout
        if self.network == "cnn" and known and len(seen.shape(Layout.load(self.layout))) < 3:
            raise SettingsError(f"observation={self.observation!r} is not a grid; give network='mlp', or a grid")
        if not self.hidden or min(self.hidden) < 1:
            raise SettingsError(f"hidden={self.hidden}; give the width of each layer, from 1")
        if any(not 0 <= share < 1 for share in self.snapshots):
            raise SettingsError(f"snapshots={self.snapshots}; give shares of the steps, from 0 and below 1")

    @property
    def learning_seats(self) -> int:
        """Number of chefs per kitchen whose experience trains the policy."""
        return 2

    @property
    def partner_references(self) -> tuple[str, ...]:
        """The partners and pools that the settings name."""
        return ()

    @property
    def people(self) -> tuple[str, ...]:
        """The people whose recorded games the policy, or a partner that it trains with, is made from.

        Raises:
            PoolError: A pool among the partners is damaged.
        """
        return people_behind(self.partner_references, self.layout)

    @property
    def learners(self) -> str:
        """The learning chefs in words, for messages."""
        return "both chefs" if self.learning_seats == 2 else "the learner"

    def shaping_at(self, done: int) -> float:
        """Returns the weight of partial rewards after `done` joint steps."""
        return 1 - self._passed(done, self.shaping_share)

    def event_share_at(self, done: int) -> float:
        """Returns the weight of the event rewards after `done` joint steps."""
        return 1.0

    def entropy_at(self, done: int) -> float:
        """Returns the coefficient of the entropy bonus after `done` joint steps."""
        return self.entropy_start + (self.entropy_end - self.entropy_start) * self._passed(done, self.entropy_share)

    def learning_rate_at(self, left: float) -> float:
        """Returns the learning rate when the share `left` of the steps remains, as stable-baselines3 counts them.

        The last rollout may end after `steps`, which makes `left` negative.
        """
        return self.learning_rate_end + (self.learning_rate - self.learning_rate_end) * max(0.0, left)

    def _passed(self, done: int, share: float) -> float:
        """Returns how much has passed, from 0 to 1, of a schedule that takes a share of the steps."""
        return min(1.0, done / (share * self.steps)) if share else 1.0


def check_draws(per_episode: int, num_kitchens: int, least: int = 1) -> None:
    """Refuses to draw more partners for an episode than there are kitchens to play in.

    Raises:
        SettingsError: Says how many can be drawn.
    """
    if not least <= per_episode <= num_kitchens:
        raise SettingsError(
            f"per_episode={per_episode}; give a number from {least}, and at most one partner for each of the "
            f"{num_kitchens} kitchens"
        )


@dataclass(frozen=True, kw_only=True)
class PartnerSettings(Settings):
    """Settings of a learner on one seat, with a partner of the environment on the other.

    A joint step gives one sample, half of what it gives in self-play, so training takes twice as many; a
    rollout is a whole episode.
    """

    steps: int = 2_000_000
    """Joint steps of training."""
    rollout: int = 400
    """Steps of each kitchen between updates."""

    @property
    def learning_seats(self) -> int:
        """One: a partner plays the other chef."""
        return 1
