"""IPPO in JaxMARL's own kitchen: an agent of another project's training code, as a frozen policy of ours.

The training is a program of its own, `elsewhere/jaxmarl_ippo.py`, which `uv run --script` installs JaxMARL for; where
that is not possible, the environment variable `OVERCOOKED_BENCH_JAXMARL` names a Python that has it. JaxMARL starts the
chefs on its own start cells (`start: standard`), or draws the cells, what the chefs hold and what is in the pots
(`start: random`, its `random_reset`); both chefs may then be on one side of a divided kitchen. Facings are random.

Source: Rutherford et al. 2024 (JaxMARL); the defaults are those of its `ippo_ff_overcooked`.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import msgspec
import numpy as np

from overcooked_bench.agents.policies.policy import Mlp, policy_files
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation

from .elsewhere.conversion import convert
from .elsewhere.program import run_program
from .learning.freeze import returns_with_itself
from .learning.settings import Settings, SettingsError
from .running.checkpoint import check_same
from .running.monitor import snapshot_name
from .running.place import CONFIG_FILE, CheckpointError, Place, read_record, write_record
from .running.run import POLICY, RESULT, SNAPSHOTS, Outcome, Snapshot, UnfitError, resolved_config

METHOD: Final = "jaxmarl-ippo"
CODEBASE: Final = "jaxmarl"
"""The project whose kitchen and training the agents come from."""
LAYOUTS: Final = {
    "cramped_room": "cramped_room",
    "asymmetric_advantages": "asymm_advantages",
    "coordination_ring": "coord_ring",
    "forced_coordination": "forced_coord",
    "counter_circuit": "counter_circuit",
}
"""Layout -> its name in JaxMARL; the tiles are the same, the start cells are not always."""
_ONLY: Final = {
    "observation": "jaxmarl",
    "network": "mlp",
    "cooking": "auto",
    "object_probability": 0.0,
    "check_share": 0.0,
    "device": "cpu",
}
_PASSED: Final = (
    *("steps", "num_kitchens", "rollout", "epochs", "minibatches", "learning_rate", "learning_rate_end", "gamma"),
    *("gae_lambda", "clip", "value_coefficient", "max_grad_norm", "entropy_start", "entropy_end", "entropy_share"),
    *("shaping_share", "hidden", "activation", "horizon", "snapshots"),
)
"""Settings that the program takes as they are."""


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy on both seats by IPPO in JaxMARL's kitchen, whose actor and critic share no layer."""

    steps: int = 5_000_000
    """Joint steps of training."""
    num_kitchens: int = 16
    """Number of kitchens that run in parallel."""
    rollout: int = 128
    """Steps of each kitchen between updates."""
    minibatches: int = 4
    """Minibatches per epoch."""
    learning_rate: float = 2.5e-4
    """Adam's initial learning rate, annealed linearly."""
    value_coefficient: float = 0.5
    """Value-loss coefficient."""
    entropy_start: float = 0.01
    """Initial entropy coefficient, annealed linearly."""
    shaping_share: float = 0.5
    """Share of the steps over which the weight of partial rewards is annealed linearly from 1 to 0."""
    observation: str = "jaxmarl"
    """Name of the policy's observation: jaxmarl."""
    start: Literal["random", "standard"] = "standard"
    """standard: JaxMARL's start cells; random: its random_reset."""
    activation: Literal["tanh", "relu"] = "tanh"
    """Activation function of the hidden layers."""

    def __post_init__(self) -> None:
        """Refuses what JaxMARL's kitchen does not have.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        super().__post_init__()
        for name, only in _ONLY.items():
            if getattr(self, name) != only:
                raise SettingsError(f"{name}={getattr(self, name)!r}; {METHOD} trains with {name}={only!r} alone")

    @property
    def architecture(self) -> Mlp:
        """The frozen policies' network."""
        layout = Layout.load(self.layout)
        return Mlp(
            observation=self.observation,
            observation_shape=find_observation(self.observation).shape(layout),
            layout=layout.name,
            cooking=self.cooking,
            hidden=self.hidden,
            activation=self.activation,
        )


class _Trained(msgspec.Struct):
    """The program's own record of a training."""

    steps: int
    seconds: float
    snapshots: dict[str, int]


class _Result(_Trained):
    """What `result.json` holds."""

    returns: list[float]


def train(config: Config, place: Place) -> Outcome | None:
    """Trains in JaxMARL, converts the policies, and evaluates the last one in a kitchen of ours.

    A run that was interrupted starts again from the beginning.

    Returns:
        The result, or None if the run was interrupted.

    Raises:
        CheckpointError: The folder holds another run, or something damaged.
        ProgramFailed: There is no JaxMARL, or the training failed.
        UnfitError: JaxMARL does not have the layout.
    """
    layout = Layout.load(config.layout).name
    if layout not in LAYOUTS:
        raise UnfitError(f"layout={config.layout!r}; JaxMARL's kitchen has {', '.join(LAYOUTS)}")
    folder, resolved = place.folder, resolved_config(config, METHOD, place.seed)
    held = read_record(folder / CONFIG_FILE, dict[str, Any]) if place.resume else None
    if held is not None:
        check_same(folder / CONFIG_FILE, held, resolved)
        if result := read_record(folder / RESULT, _Result):
            return _outcome(folder, result)
    folder.mkdir(parents=True, exist_ok=True)
    write_record(folder / CONFIG_FILE, resolved)
    passed = {name: getattr(config, name) for name in _PASSED}
    passed |= {"layout": LAYOUTS[layout], "seed": place.seed, "random_reset": config.start == "random"}
    theirs = folder / "jaxmarl"
    try:
        run_program(passed, theirs, config.threads)
        return _freeze(config, folder, theirs)
    except KeyboardInterrupt:
        return None


def _freeze(config: Config, folder: Path, theirs: Path) -> Outcome:
    """Converts what the program wrote, and measures the last policy with itself."""
    trained = read_record(theirs / RESULT, _Trained)
    if trained is None:
        raise CheckpointError(f"{theirs / RESULT}: missing, though the training ended; train it with another --output")
    for share in config.snapshots:
        convert(theirs / f"policy-{share}.npz", folder / SNAPSHOTS / snapshot_name(share), config.architecture)
    files = convert(theirs / "policy.npz", folder / POLICY, config.architecture)
    returns = returns_with_itself(files, config).tolist()
    result = _Result(trained.steps, trained.seconds, trained.snapshots, returns)
    write_record(folder / RESULT, msgspec.to_builtins(result))
    return _outcome(folder, result)


def _outcome(folder: Path, result: _Result) -> Outcome:
    snapshots = {
        share: Snapshot(policy_files(folder / SNAPSHOTS / snapshot_name(share)), steps)
        for share, steps in sorted((float(share), steps) for share, steps in result.snapshots.items())
    }
    returns = np.asarray(result.returns, np.float64)
    return Outcome(policy_files(folder / POLICY), returns, result.steps, result.seconds, snapshots)
