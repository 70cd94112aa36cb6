"""`overcooked-bench scenarios`: run, compare, list, show, check and create cooperation unit tests."""

import argparse
import os
import sys
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_act_timeout,
    add_command,
    add_group,
    add_json,
    add_output,
    console,
    names,
    whole,
)
from overcooked_bench.scenarios import CATEGORIES

if TYPE_CHECKING:
    from pathlib import Path

    from overcooked_bench.commands.apart import Call
    from overcooked_bench.scenarios.items import Item
    from overcooked_bench.scenarios.results import ItemResult, SuiteResult
    from overcooked_bench.scenarios.scenario import Scenario
    from overcooked_bench.scenarios.solving.gates import GateReport

_SELECT = "ids or their beginnings, categories, families, tags, patterns, files or folders"


def add_scenarios(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands,
        "scenarios",
        "run, compare, list, show, check and create cooperation unit tests",
        "overcooked-bench scenarios run convention --agent greedy",
    )
    for add in (_add_run, _add_compare, _add_list, _add_show, _add_check, _add_new):
        add(inner)


def _add_run(commands: Any) -> None:
    parser = add_command(
        commands,
        "run",
        _run,
        "play an agent through scenarios; exit code 1 where it fails one",
        "overcooked-bench scenarios run C04 --agent my_agent.py --seat 1 --mirrored --repeat 7",
    )
    _add_select(parser, "*")
    parser.add_argument(
        "--agent",
        metavar="AGENT",
        required=True,
        help="my_agent.py[:function], a folder with agent.py, or an agent's name; {layout} in a name is the layout",
    )
    parser.add_argument("--category", metavar="A,B", type=names, help="only these categories")
    parser.add_argument("--repeats", metavar="N", type=whole(1), default=20, help="runs of each (default: 20)")
    parser.add_argument("--mode", choices=("sample", "greedy"), default="sample", help="how frozen policies act")
    parser.add_argument("--training-seed", metavar="N", type=whole(0), default=0, help="which training run")
    parser.add_argument("--warmup", metavar="N", type=whole(0), default=0, help="first views shown before the start")
    _add_seat(parser)
    parser.add_argument("--repeat", metavar="K", type=whole(0), help="play this run alone (from 0) and show its film")
    parser.add_argument("--film", action="store_true", help="show the last steps of every item that is failed")
    parser.add_argument("--report", metavar="FILE", help="write the result of every item as JSON")
    add_act_timeout(parser)
    add_json(parser)


def _run(options: argparse.Namespace) -> int:
    import json
    from pathlib import Path

    from overcooked_bench.commands.apart import agent_apart
    from overcooked_bench.scenarios.results import SuiteResult

    chosen = _items(options)
    settings = {"training_seed": options.training_seed, "warmup": options.warmup}
    with agent_apart(options.agent, options.mode, options.act_timeout) as call:
        if options.repeat is not None:
            return _run_once(options, chosen, call)
        with ProgressBar("compiling and loading") as tell:
            played = _play(call, chosen, partial(tell, "kitchens"), options.repeats, **settings)
    result = SuiteResult(
        options.agent, options.mode, options.repeats, options.training_seed, options.warmup, False, tuple(played)
    )
    text = json.dumps(result.to_dict(), indent=2) + "\n"
    if options.report:
        Path(options.report).write_text(text, "utf-8")
    if options.json:
        print(text, end="")
    else:
        _print_result(result, options)
    return 0 if result.passed == result.n else 1


def _play(
    call: "Call", items: "list[Item]", on_progress: Callable[[int, int], None], repeats: int, **settings: int
) -> "list[ItemResult]":
    """Plays items kitchen by kitchen; returns the results in the order of the items."""
    from overcooked_bench.scenarios.runner import run_items

    kitchens: dict[Any, list[Item]] = {}
    for item in items:
        kitchens.setdefault(item.kitchen, []).append(item)
    found: dict[str, ItemResult] = {}
    for done, (_, some) in enumerate(sorted(kitchens.items())):
        on_progress(done, len(kitchens))
        found |= {result.item.id: result for result in call(run_items, some, repeats, **settings)}
    on_progress(len(kitchens), len(kitchens))
    return [found[item.id] for item in items]


def _print_result(result: "SuiteResult", options: argparse.Namespace) -> None:
    from overcooked_bench.scenarios.shown.comparing import category_table
    from overcooked_bench.scenarios.shown.explaining import explain, headline

    failed = [one for one in result.items if not one.passed]
    settings = {"mode": options.mode, "training_seed": options.training_seed, "warmup": options.warmup}
    for one in failed:
        if options.film:
            print(explain(one, options.agent, colour=_colour(), width=_width(), **settings), end="\n\n")
        else:
            print(f"failed  {one.item.id}: {headline(one)}")
    print("\n".join(["", *category_table([one.to_dict() for one in result.items]).text()]))
    if failed and not options.film:
        print("\n--film shows the last steps of what was failed")


def _run_once(options: argparse.Namespace, chosen: "list[Item]", call: "Call") -> int:
    from overcooked_bench.agents.agent import UnknownLayout
    from overcooked_bench.scenarios.runner import play_once

    wanted = (options.seat or 0, options.mirrored)
    situations = {
        situation.id: situation
        for item in chosen
        for situation in item.situations
        if (situation.seat, situation.mirrored) == wanted or situation.id in options.select
    }
    passed = []
    for situation in situations.values():
        try:
            run = call(
                *(play_once, situation, options.repeat), training_seed=options.training_seed, warmup=options.warmup
            )
        except UnknownLayout as error:
            print(f"{situation.id} not attempted: {error}")
            passed.append(False)
            continue
        print(f"{situation.id}, repeat {options.repeat}: {situation.scenario.why}", end="\n\n")
        print(run.film(len(run.actions), colour=_colour(), width=_width()), end="\n\n")
        print(run.why())
        passed.append(run.passed)
    if not passed:
        print("overcooked-bench: no scenario is played from this seat in this mirror", file=sys.stderr)
        return 2
    return 0 if all(passed) else 1


def _add_compare(commands: Any) -> None:
    parser = add_command(
        commands,
        "compare",
        _compare,
        "play several agents through scenarios, and count the items that discriminate",
        "overcooked-bench scenarios compare greedy stay random 'dev-v0/{layout}/sp-0'",
    )
    parser.add_argument("agents", metavar="AGENT", nargs="+", help="as for `scenarios run --agent`")
    parser.add_argument("--select", metavar="A,B", type=names, help=_SELECT)
    parser.add_argument("--repeats", metavar="N", type=whole(1), default=20, help="runs of each (default: 20)")
    parser.add_argument("--mode", choices=("sample", "greedy"), default="sample", help="how frozen policies act")
    add_act_timeout(parser)
    add_json(parser)


def _compare(options: argparse.Namespace) -> int:
    import json

    from overcooked_bench.commands.apart import agent_apart
    from overcooked_bench.scenarios.items import load_items
    from overcooked_bench.scenarios.shown.comparing import agents_table

    chosen, played = load_items(options.select), {}
    with ProgressBar("compiling and loading") as tell:
        for agent in options.agents:
            with agent_apart(agent, options.mode, options.act_timeout) as call:
                results = _play(call, chosen, partial(tell, agent), options.repeats)
            played[agent] = [result.to_dict() for result in results]
    print(json.dumps(played, indent=2) if options.json else agents_table(played).markdown())
    return 0


def _add_list(commands: Any) -> None:
    parser = add_command(commands, "list", _list, "list scenarios", "overcooked-bench scenarios list partner --json")
    _add_select(parser, "*")
    add_json(parser)


def _list(options: argparse.Namespace) -> int:
    import json

    from overcooked_bench.scenarios.items import load_scenarios
    from overcooked_bench.scenarios.solving.lock import known_entry

    rows: list[dict[str, Any]] = []
    for scenario in load_scenarios(options.select or None):
        entry = known_entry(scenario)
        rows.append(
            {
                "id": scenario.id,
                "category": scenario.category,
                "family": scenario.family,
                "layout": "own" if "\n" in scenario.layout.name else scenario.layout.name,
                "shortest": entry.steps if entry else None,
                "budget": scenario.budget or (entry.budget if entry else None),
                "pair": scenario.pair,
                "tags": list(scenario.tags),
                "why": scenario.why,
            }
        )
    if options.json:
        print(json.dumps(rows, indent=2))
        return 0
    from overcooked_bench.rendering.table import Column, Table

    shown = []
    for row in rows:
        names = [str(row[key]) for key in ("id", "category", "family", "layout")]
        figures = ["-" if row[key] is None else str(row[key]) for key in ("shortest", "budget")]
        shown.append([*names, *figures, ", ".join(row["tags"])])
    heads = [Column(name, left=True, wrap=False) for name in ("scenario", "category", "family", "layout")]
    console().print(Table([*heads, "T*", "K", Column("tags", left=True)], shown).terminal())
    console().print(f"{len(rows)} scenarios; T* steps of the shortest solution, K steps that an agent has", style="dim")
    return 0


def _add_show(commands: Any) -> None:
    parser = add_command(
        commands, "show", _show, "draw scenarios and say what is asked", "overcooked-bench scenarios show C04 --film"
    )
    _add_select(parser, "+")
    _add_seat(parser)
    parser.add_argument("--film", action="store_true", help="show a shortest solution, too")


def _show(options: argparse.Namespace) -> int:
    from overcooked_bench.scenarios.items import load_scenarios
    from overcooked_bench.scenarios.shown.showing import show, show_solution

    for number, scenario in enumerate(load_scenarios(options.select)):
        situation = scenario.seated(options.seat or 0, options.mirrored)
        print("\n" * bool(number) + show(situation, colour=_colour()))
        if options.film:
            print("\n" + show_solution(situation, colour=_colour(), width=_width()))
    return 0


def _add_check(commands: Any) -> None:
    parser = add_command(
        commands,
        "check",
        _check,
        "solve scenarios and put them to the gates of the suite; exit code 1 where one does not stand them",
        "overcooked-bench scenarios check X01-mine.scenario.yaml --film",
    )
    _add_select(parser, "+")
    parser.add_argument("--film", action="store_true", help="show a shortest solution, too")
    parser.add_argument("--lock", action="store_true", help="write the solutions beside the files: no search next time")
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
        print(f"  doing nothing {report.stay}, {players}, a planner who knows B's past alone {report.honest}")
        if options.film:
            print(f"\n{show_solution(scenario.seated(0), colour=_colour(), width=_width())}\n")
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


def _add_new(commands: Any) -> None:
    parser = add_command(
        commands,
        "new",
        _new,
        "begin a scenario: write a file that works, with every key explained",
        "overcooked-bench scenarios new X01-mine --layout coordination_ring",
    )
    parser.add_argument("id", metavar="ID", help="its name, and the file's")
    parser.add_argument("--layout", metavar="NAME", default="cramped_room", help="default: cramped_room")
    parser.add_argument("--category", choices=CATEGORIES, default="state", help="default: state")
    add_output(parser, "here")


def _new(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.scenarios import SUFFIX
    from overcooked_bench.scenarios.language.loading import read_scenario
    from overcooked_bench.scenarios.language.template import template

    file = Path(options.output or "") / f"{options.id}{SUFFIX}"
    text = template(options.id, options.layout, options.category)
    read_scenario(text, str(file), options.id)
    if file.exists():
        print(f"overcooked-bench: {file} is there already; give another id, or --output DIR", file=sys.stderr)
        return 2
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, "utf-8")
    print(f"{file}  edit it, then: overcooked-bench scenarios check {file}")
    return 0


def _add_select(parser: argparse.ArgumentParser, nargs: str) -> None:
    parser.add_argument(
        "select", metavar="SELECT", nargs=nargs, help=_SELECT + " (default: all that ship)" * (nargs == "*")
    )


def _add_seat(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seat", type=int, choices=(0, 1), help="only with the agent on this seat")
    parser.add_argument("--mirrored", action="store_true", help="only in the mirrored kitchen")


def _items(options: argparse.Namespace) -> "list[Item]":
    from overcooked_bench.scenarios.errors import ScenarioError
    from overcooked_bench.scenarios.items import load_items

    strange = sorted(set(options.category or ()) - set(CATEGORIES))
    if strange:
        raise ScenarioError(f"no category {', '.join(strange)}; choose among {', '.join(CATEGORIES)}")
    chosen = [
        item
        for item in load_items(options.select or None)
        if (options.category is None or item.category in options.category)
        and (item.is_pair or options.seat in (None, item.seat))
        and (item.is_pair or item.mirrored or not options.mirrored or options.repeat is not None)
    ]
    if not chosen:
        raise ScenarioError("nothing is left to play; choose more categories, seats or mirrors")
    return chosen


def _colour() -> bool:
    return sys.stdout.isatty() and not os.environ.get("NO_COLOR")


def _width() -> int:
    from shutil import get_terminal_size

    return get_terminal_size((100, 24)).columns
