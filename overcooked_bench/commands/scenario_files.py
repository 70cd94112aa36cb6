"""Commands about scenario files: `overcooked-bench scenarios show`, `check` and `new`."""

import argparse
import os
import sys
from typing import TYPE_CHECKING, Any, Final

from overcooked_bench.commands.common import ProgressBar, add_command, add_json, add_output
from overcooked_bench.scenarios import CATEGORIES

if TYPE_CHECKING:
    from pathlib import Path

    from overcooked_bench.scenarios.scenario import Scenario
    from overcooked_bench.scenarios.solving.gates import GateReport

SELECT: Final = "ids or their beginnings, categories, families, tags, patterns with *, files or folders"
"""Help of an argument that selects scenarios."""


def add_show(commands: Any) -> None:
    """Declares `scenarios show`."""
    parser = add_command(
        commands,
        "show",
        _show,
        "draw scenarios and state their conditions",
        "overcooked-bench scenarios show C04 --film",
    )
    add_select(parser, "+")
    add_seat(parser)
    parser.add_argument("--film", action="store_true", help="also show a shortest solution, step by step")


def _show(options: argparse.Namespace) -> int:
    from overcooked_bench.scenarios.items import load_scenarios
    from overcooked_bench.scenarios.shown.showing import show, show_solution

    for number, scenario in enumerate(load_scenarios(options.select)):
        situation = scenario.seated(options.seat or 0, options.mirrored)
        print("\n" * bool(number) + show(situation, colour=colour()))
        if options.film:
            print("\n" + show_solution(situation, colour=colour(), width=width()))
    return 0


def add_check(commands: Any) -> None:
    """Declares `scenarios check`."""
    parser = add_command(
        commands,
        "check",
        _check,
        "solve scenarios and run the acceptance checks; exits with 1 if any check fails",
        "overcooked-bench scenarios check X01-mine.scenario.yaml --film",
    )
    add_select(parser, "+")
    parser.add_argument("--film", action="store_true", help="also show a shortest solution, step by step")
    parser.add_argument(
        "--lock",
        action="store_true",
        help="write the solutions to the lock file in the scenarios' folder, so that they are not searched again",
    )
    add_json(parser)


def _check(options: argparse.Namespace) -> int:
    import json

    from overcooked_bench.scenarios.items import load_scenarios
    from overcooked_bench.scenarios.shown.showing import show_solution
    from overcooked_bench.scenarios.solving.gates import check_all

    chosen = load_scenarios(options.select)
    with ProgressBar("compiling and loading") as tell:
        reports = check_all(chosen, on_progress=lambda done, of: tell("scenarios", done, of))
    if options.json:
        print(json.dumps([_report_json(report) for report in reports], indent=2))
    for report in reports if not options.json else ():
        scenario = report.scenario
        print(f"{scenario.id}: mergeable: {'yes' if report.mergeable else 'no'}")
        for word, texts in (("wrong", report.faults), ("note", report.notes)):
            for text in texts:
                print(f"  {word}: {text}")
        if report.entry is None:
            continue
        players = ", ".join(f"{name} {passed}" for name, passed in report.players.items())
        print(f"  the shortest solution takes {report.steps} steps, an agent has {report.budget}")
        print(f"  random play passes {report.random:.1%} of its runs at most")
        print("  of the 4 situations (both seats, plain and mirrored) are passed by")
        print(f"  doing nothing {report.stay}, {players}, a planner that sees only B's past actions {report.honest}")
        if options.film:
            print(f"\n{show_solution(scenario.seated(0), colour=colour(), width=width())}\n")
    if options.lock:
        for file in _write_locks([report.scenario for report in reports if report.entry]):
            print(f"{file}  the solutions", file=sys.stderr)
    return 0 if all(report.mergeable for report in reports) else 1


def _report_json(report: "GateReport") -> dict[str, Any]:
    return {
        "id": report.scenario.id,
        "mergeable": report.mergeable,
        "faults": list(report.faults),
        "notes": list(report.notes),
        "shortest": report.steps,
        "budget": report.budget,
        "random": report.random,
        "stay": report.stay,
        "players": dict(report.players),
        "honest": report.honest,
    }


def _write_locks(scenarios: "list[Scenario]") -> "list[Path]":
    from overcooked_bench.scenarios.items import read_files
    from overcooked_bench.scenarios.solving.lock import lock_path, write_lock

    written = sorted({lock_path(scenario) for scenario in scenarios})
    for file in written:
        write_lock(file, read_files([file.parent]))
    return written


def add_new(commands: Any) -> None:
    """Declares `scenarios new`."""
    parser = add_command(
        commands,
        "new",
        _new,
        "create a scenario: write a file that works, with every key explained",
        "overcooked-bench scenarios new X01-mine --layout coordination_ring",
    )
    parser.add_argument("id", metavar="ID", help="its id, which is also the file's name")
    parser.add_argument(
        "--layout", metavar="NAME", default="cramped_room", help="layout of the picture (default: cramped_room)"
    )
    parser.add_argument(
        "--category", choices=CATEGORIES, default="state", help="category of the scenario (default: state)"
    )
    add_output(parser, "the working directory")


def _new(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.scenarios import SUFFIX
    from overcooked_bench.scenarios.language.loading import read_scenario
    from overcooked_bench.scenarios.language.template import template

    file = Path(options.output or "") / f"{options.id}{SUFFIX}"
    text = template(options.id, options.layout, options.category)
    read_scenario(text, str(file), options.id)
    if file.exists():
        print(f"overcooked-bench: {file} exists already; give another id, or --output DIR", file=sys.stderr)
        return 2
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    print(f"{file}  edit it, then: overcooked-bench scenarios check {file}")
    return 0


def add_select(parser: argparse.ArgumentParser, nargs: str) -> None:
    """Declares the argument that selects scenarios."""
    parser.add_argument(
        "select", metavar="SELECT", nargs=nargs, help=SELECT + " (default: all that ship)" * (nargs == "*")
    )


def add_seat(parser: argparse.ArgumentParser) -> None:
    """Declares `--seat` and `--mirrored`."""
    parser.add_argument("--seat", type=int, choices=(0, 1), help="only with the agent on this seat")
    parser.add_argument("--mirrored", action="store_true", help="only in the mirrored kitchen")


def colour() -> bool:
    """Returns whether standard output is a terminal that shows colours."""
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def width() -> int:
    """Returns the width of the terminal, characters."""
    from shutil import get_terminal_size

    return get_terminal_size((100, 24)).columns
