"""Explains why an agent failed an item, in words and pictures, with the command that replays the run."""

import os
import shlex
from pathlib import Path
from typing import Any, Final

from overcooked_bench.scenarios.items import shipped_folder
from overcooked_bench.scenarios.results import PASS_RATE, Failure, ItemResult
from overcooked_bench.scenarios.scenario import Situation

PROGRAM: Final = ("overcooked-bench", "scenarios", "run")


def headline(result: ItemResult) -> str:
    """Returns an item's result in one line."""
    if result.status == "not attempted":
        return f"not attempted: {result.reason}"
    if result.deterministic:
        return f"{'passes' if result.passed else 'fails'} every run, as the agent is deterministic"
    which = " in the worse half" if result.item.is_pair else ""
    return f"{result.passes} of {result.runs} runs passed{which}: {result.rate}; {PASS_RATE} is needed"


def explain(result: ItemResult, agent: str, *, colour: bool = False, width: int = 100, **settings: Any) -> str:
    """Explains a failure: the rate, what did not hold, the frames of the last steps, and how to replay it.

    Args:
        result: The item's result.
        agent: The agent's name on the command line.
        colour: Whether to use a terminal's colours.
        width: Characters per line of the frames.
        settings: Passed on to `replay_command`.
    """
    lines = [f"{result.item.id}: {headline(result)}"]
    failure = result.failure
    if failure is not None:
        run = failure.run()
        lines += [
            f"why: {failure.situation.scenario.why}",
            "",
            f"{failure.situation.id}, repeat {failure.repeat}, {run.why()}",
            "",
            run.film(colour=colour, width=width),
        ]
        if Path(failure.situation.scenario.source).is_file():
            lines += ["", f"replay it: {replay_command(failure, agent, **settings)}"]
    return "\n".join(lines)


def replay_command(
    failure: Failure, agent: str, *, mode: str = "sample", training_seed: int = 0, warmup: int = 0
) -> str:
    """Returns the command line that replays a failed run and shows its frames.

    Args:
        failure: The run.
        agent: The agent's name on the command line.
        mode: How frozen policies act.
        training_seed: Which of a submission's training runs.
        warmup: How often the first observation is shown before the start.
    """
    situation = failure.situation
    words = [*PROGRAM, selector(situation), "--agent", agent, "--seat", str(situation.seat)]
    words += ["--mirrored"] * situation.mirrored
    for name, value, default in (("mode", mode, "sample"), ("training-seed", training_seed, 0), ("warmup", warmup, 0)):
        words += [f"--{name}", str(value)] if value != default else []
    return shlex.join([*words, "--repeat", str(failure.repeat)])


def selector(situation: Situation) -> str:
    """Returns the text that selects a situation's scenario: its id if it ships, else its file."""
    scenario = situation.scenario
    file = Path(scenario.source).absolute()
    if file.parent == shipped_folder().absolute():
        return scenario.id
    return os.path.relpath(file) if file.is_relative_to(Path.cwd()) else str(file)
