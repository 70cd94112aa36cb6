"""What `overcooked-bench train METHOD` does for every method: options, a named configuration, exit codes."""

import argparse
import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

import tyro

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.policies.policy import PolicyError
from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.estimate import t_interval
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import Layout

from ..presets import PresetError, checked, config_names, named_settings
from .checkpoint import CheckpointError
from .freeze import Returns
from .run import SUMMARY, Outcome, UnfitError, label, write_json
from .seeds import USER, derive_seed
from .settings import Settings

_STOPPED: Final = 130
AnySettings = TypeVar("AnySettings", bound=Settings)


def main_of(method: str, kind: type[AnySettings], train: Callable[..., Outcome | None], arguments: list[str]) -> int:
    """Runs `overcooked-bench train METHOD ...`.

    Args:
        method: The method's name.
        kind: Its settings.
        train: Its function, called with (settings, output, seed, resume=, every=).
        arguments: The command line's, without program and method.

    Returns:
        The exit code: 0, 2 for wrong use, 130 after Ctrl-C.
    """
    try:
        name, rest = _config_name(arguments)
        named = named_settings(method, name, _layout(rest))
        chosen = checked(kind, {"layout": "", **named}, f"{method}, configuration {name!r}")
    except PresetError as error:
        print(f"overcooked-bench train: {error}", file=sys.stderr)
        return 2
    options_kind = _options(kind, config_names(method))
    given = tyro.cli(
        options_kind,
        default=options_kind(**{**chosen, "layout": tyro.MISSING}),
        args=rest,
        prog=f"overcooked-bench train {method}",
        description=_help(method, kind),
    )
    options = {field.name: getattr(given, field.name) for field in dataclasses.fields(given)}
    output, resume, every = (options.pop(name) for name in ("output", "resume", "checkpoint_every"))
    options.pop("config")
    try:
        settings = kind(**options)
        layout = Layout.load(settings.layout).name
        chosen_name = f"-{name.replace(',', '-')}" if name else ""
        output = output or Path("runs") / f"{method}{chosen_name}-{label(settings.layout)}-{settings.seed}"
        held = output.is_dir() and any(output.iterdir())
        if held and not resume:
            raise CheckpointError(
                f"{output} holds a run already; go on with it by --resume, or choose another --output"
            )
        if resume and not held:
            raise CheckpointError(f"{output}: no checkpoint to resume from; start without --resume")
        outcome = train(settings, output, derive_seed(USER, layout, method, settings.seed), resume=resume, every=every)
    except (
        LayoutError,
        UnknownLayout,
        AgentError,
        CheckpointError,
        UnfitError,
        PresetError,
        PolicyError,
        PoolError,
    ) as error:
        print(f"overcooked-bench train: {error}", file=sys.stderr)
        return 2
    if outcome is None:
        print(f"stopped, and saved in {output}; the same command with --resume goes on from there", file=sys.stderr)
        return _STOPPED
    summary = _summary(method, name, settings, layout, outcome)
    write_json(output / SUMMARY, summary)
    own = summary["with_itself"]
    print(
        f"{outcome.files.weights}: return with itself {own['mean']:.1f} [{own['low']:.1f}, {own['high']:.1f}] points "
        f"over {own['episodes']} episodes, after {outcome.total_steps:,} joint steps in {outcome.total_seconds:.0f} s"
        + (f", {outcome.total_restarts} restarts" if outcome.total_restarts else "")
    )
    if theirs := summary["with_partners"]:
        print(
            f"with its partners {theirs['mean']:.1f} [{theirs['low']:.1f}, {theirs['high']:.1f}] points over "
            f"{theirs['episodes']} episodes"
        )
    return 0


def _summary(method: str, name: str, settings: Settings, layout: str, outcome: Outcome) -> dict[str, Any]:
    def told(returns: Returns | None) -> dict[str, float | None] | None:
        if returns is None:
            return None
        mean, low, high = t_interval(returns)
        return {"mean": mean, "low": low, "high": high, "episodes": len(returns)}

    return {
        "method": method,
        "configuration": name or config_names(method)[0],
        "layout": layout,
        "seed": settings.seed,
        "with_itself": told(outcome.returns),
        "with_partners": told(outcome.with_partners),
        "steps": outcome.total_steps,
        "seconds": round(outcome.total_seconds, 1),
        "restarts": outcome.total_restarts,
    }


def _config_name(arguments: list[str]) -> tuple[str, list[str]]:
    """Takes --config out of the arguments, since it decides the defaults of all others."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--config", default="")
    found, rest = parser.parse_known_args(arguments)
    return found.config, rest


def _layout(arguments: list[str]) -> str:
    """Finds --layout among the arguments, since defaults may depend on it; it stays there, to be judged with them."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    parser.add_argument("--layout", default="")
    try:
        return str(parser.parse_known_args(arguments)[0].layout)
    except argparse.ArgumentError:
        return ""


def _options(kind: type[Settings], names: tuple[str, ...]) -> Any:
    """Gives the settings class with what belongs to a run alone."""
    run: list[tuple[str, Any, Any]] = [
        ("config", _option(str, f"Named settings: {', '.join(names)}; several are joined by commas."), names[0]),
        (
            "output",
            _option(Path | None, "Folder for everything; runs/<method>-<layout>-<seed> by default.", "-o"),
            None,
        ),
        ("resume", _option(bool, "Go on from the folder's checkpoint."), False),
        ("checkpoint_every", _option(int, "Joint steps between checkpoints."), 250_000),
    ]
    own = [(name, hint, dataclasses.field(default=default)) for name, hint, default in run]
    return dataclasses.make_dataclass("Options", own, bases=(kind,), frozen=True, kw_only=True)


def _option(kind: Any, text: str, *aliases: str) -> Any:
    return Annotated[kind, tyro.conf.arg(help=text, aliases=aliases or None)]


def _help(method: str, kind: type[Settings]) -> str:
    first = (kind.__doc__ or "").partition("\n")[0]
    return f"{first}\n\nExample: overcooked-bench train {method} --layout forced_coordination --seed 1\n"
