"""`overcooked-bench scenarios`: run, compare, list, show, check and create cooperation unit tests."""

import argparse
import sys
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_act_timeout,
    add_command,
    add_group,
    add_isolate,
    add_json,
    console,
    names,
    whole,
)
from overcooked_bench.commands.scenario_files import (
    SELECT,
    add_check,
    add_new,
    add_seat,
    add_select,
    add_show,
    colour,
    width,
)
from overcooked_bench.scenarios import CATEGORIES

if TYPE_CHECKING:
    from overcooked_bench.commands.apart import Call
    from overcooked_bench.scenarios.items import Item
    from overcooked_bench.scenarios.results import ItemResult, SuiteResult


def add_scenarios(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands,
        "scenarios",
        "run, compare, list, show, check and create cooperation unit tests",
        "overcooked-bench scenarios run convention --agent greedy",
    )
    for add in (_add_run, _add_compare, _add_list, add_show, add_check, add_new):
        add(inner)


def _add_run(commands: Any) -> None:
    parser = add_command(
        commands,
        "run",
        _run,
        "run an agent through scenarios; exits with 1 if the agent fails any",
        "overcooked-bench scenarios run C04 --agent my_agent.py --seat 1 --mirrored --repeat 7",
    )
    add_select(parser, "*")
    parser.add_argument(
        "--agent",
        metavar="AGENT",
        required=True,
        help="my_agent.py[:function], a folder, or a name, in which {layout} is replaced by the layout's name",
    )
    parser.add_argument("--category", metavar="A,B", type=names, help="only these categories")
    _add_playing(parser)
    parser.add_argument(
        "--training-seed",
        metavar="N",
        type=whole(0),
        default=0,
        help="training seed that make_agent is given (default: 0)",
    )
    parser.add_argument(
        "--warmup",
        metavar="N",
        type=whole(0),
        default=0,
        help="times that the first observation is shown, actions ignored, before the run starts (default: 0)",
    )
    add_seat(parser)
    parser.add_argument("--repeat", metavar="K", type=whole(0), help="play only this run (from 0) and show its frames")
    parser.add_argument("--film", action="store_true", help="show the last steps of every failed item")
    parser.add_argument("--report", metavar="FILE", help="write the result of every item as JSON")
    add_act_timeout(parser)
    add_isolate(parser)
    add_json(parser)


def _run(options: argparse.Namespace) -> int:
    import json
    from pathlib import Path

    from overcooked_bench.commands.apart import agent_apart
    from overcooked_bench.scenarios.results import SuiteResult

    chosen = _items(options)
    settings = {"training_seed": options.training_seed, "warmup": options.warmup}
    with agent_apart(options.agent, options.mode, options.act_timeout, options.isolate) as call:
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
            print(explain(one, options.agent, colour=colour(), width=width(), **settings), end="\n\n")
        else:
            print(f"failed  {one.item.id}: {headline(one)}")
    print("\n".join(["", *category_table([one.to_dict() for one in result.items]).text()]))
    if failed and not options.film:
        print("\n--film shows the last steps of failed items")


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
        print(run.film(len(run.actions), colour=colour(), width=width()), end="\n\n")
        print(run.why())
        passed.append(run.passed)
    if not passed:
        print("overcooked-bench: no scenario is left for this seat and mirror image", file=sys.stderr)
        return 2
    return 0 if all(passed) else 1


def _add_compare(commands: Any) -> None:
    parser = add_command(
        commands,
        "compare",
        _compare,
        "run several agents through scenarios, and count the items that one agent passes and another fails",
        "overcooked-bench scenarios compare greedy stay random 'dev-v0/{layout}/sp-0'",
    )
    parser.add_argument("agents", metavar="AGENT", nargs="+", help="as for `scenarios run --agent`")
    parser.add_argument("--select", metavar="A,B", type=names, help=SELECT)
    _add_playing(parser)
    add_act_timeout(parser)
    add_isolate(parser)
    add_json(parser)


def _compare(options: argparse.Namespace) -> int:
    import json

    from overcooked_bench.commands.apart import agent_apart
    from overcooked_bench.scenarios.items import load_items
    from overcooked_bench.scenarios.shown.comparing import agents_table

    chosen, played = load_items(options.select), {}
    with ProgressBar("compiling and loading") as tell:
        for agent in options.agents:
            with agent_apart(agent, options.mode, options.act_timeout, options.isolate) as call:
                results = _play(call, chosen, partial(tell, agent), options.repeats)
            played[agent] = [result.to_dict() for result in results]
    print(json.dumps(played, indent=2) if options.json else agents_table(played).markdown())
    return 0


def _add_list(commands: Any) -> None:
    parser = add_command(commands, "list", _list, "list scenarios", "overcooked-bench scenarios list partner --json")
    add_select(parser, "*")
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
    console().print(
        f"{len(rows)} scenarios; T* = steps of the shortest solution, K = steps that an agent has", style="dim"
    )
    return 0


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
        raise ScenarioError("nothing is left to play; choose more categories or seats, or leave --mirrored out")
    return chosen


def _add_playing(parser: argparse.ArgumentParser) -> None:
    """Declares how agents are played, the same for all commands that play scenarios."""
    parser.add_argument(
        "--repeats",
        metavar="N",
        type=whole(1),
        default=20,
        help="runs of each scenario, for agents that sample (default: 20)",
    )
    parser.add_argument(
        "--mode",
        choices=("sample", "greedy"),
        default="sample",
        help="whether frozen policies sample actions or take the likeliest (default: sample)",
    )
