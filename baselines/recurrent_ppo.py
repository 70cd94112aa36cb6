"""Self-play by another trainer: RecurrentPPO of sb3-contrib, whose own loops train an actor with memory (LSTM).

Source: sb3-contrib; Pleines et al. 2022, "Generalization, mayhems and limits in recurrent proximal policy
optimization". The kitchens, the schedules and the files of a run are those of `self_play`.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from .learning.settings import Settings, SettingsError
from .running.place import Place
from .running.run import Outcome, UnfitError, make_env, run

if TYPE_CHECKING:
    from sb3_contrib import RecurrentPPO

METHOD: Final = "recurrent-ppo"
CODEBASE: Final = "sb3-contrib"
"""Whose loops train, as the records of pools name it."""


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy with an LSTM on both seats of a kitchen by RecurrentPPO of sb3-contrib."""

    network: Literal["mlp"] = "mlp"
    """Fully connected layers before the LSTM."""
    hidden: tuple[int, ...] = (64,)
    """Widths of the fully connected layers before the LSTM, which actor and critic share."""
    units: int = 64
    """Units of the actor's LSTM; the critic has none."""
    head: tuple[int, ...] = ()
    """Widths of the fully connected layers after the LSTM."""
    rollout: int = 50
    """Steps of each kitchen between updates; gradients go back through time as far as that."""
    minibatches: int = 4
    """Minibatches per epoch."""
    start: Literal["random", "standard"] = "standard"
    """random: random floor cells; standard: the layout's start cells."""

    def __post_init__(self) -> None:
        """Checks the LSTM too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        Settings.__post_init__(self)
        if self.units < 1:
            raise SettingsError(f"units={self.units}; give a number from 1")
        if self.head and min(self.head) < 1:
            raise SettingsError(f"head={self.head}; give the width of each layer, from 1, or none")


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors.

    Raises:
        UnfitError: sb3-contrib is not installed.
    """
    try:
        from .learning.recurrent import make_recurrent
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "sb3_contrib":
            raise
        raise UnfitError(f"{METHOD} needs sb3-contrib: pip install 'overcooked-bench[recurrent]'") from None

    def make(seed: int) -> "RecurrentPPO":
        return make_recurrent(config, make_env(config, self_play=True), seed, config.units, config.head)

    return run(config, METHOD, place, make)
