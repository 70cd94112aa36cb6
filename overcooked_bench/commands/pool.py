"""`overcooked-bench pool`: build, show, verify and cross-play sets of frozen agents."""

import argparse
from importlib import import_module
from typing import Any

from overcooked_bench.commands.common import ProgressBar, add_command, console, names, whole


def add_pool(commands: Any) -> None:
    """Declares the group."""
    parser = commands.add_parser(
        "pool",
        help="build, show, verify and cross-play sets of frozen agents",
        description="Build, show, verify and cross-play sets of frozen agents.",
        epilog="example:\n  overcooked-bench pool show dev-v0",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    inner = parser.add_subparsers(metavar="COMMAND", required=True)
    for add in (_add_build, _add_show, _add_verify, _add_crossplay):
        add(inner)


def _add_build(commands: Any) -> None:
    parser = add_command(
        commands,
        "build",
        _build,
        "train every agent that a pool's configuration names; the same command goes on where it was stopped",
        "overcooked-bench pool build train-v1 --processes 2 --layouts cramped_room --limit 2",
    )
    parser.add_argument("config", metavar="CONFIG", help="a shipped configuration's name, or a YAML file")
    parser.add_argument("--processes", metavar="N", type=whole(1), default=1, help="runs side by side, one core each")
    parser.add_argument("--runs", metavar="DIR", help="where the training runs lie (default: runs/<pool>)")
    parser.add_argument("--output", metavar="DIR", help="the pool's folder (default: pools/<pool>)")
    parser.add_argument("--layouts", metavar="A,B", type=names, help="only these layouts")
    parser.add_argument("--groups", metavar="A,B", type=names, help="only these groups, by prefix")
    parser.add_argument("--limit", metavar="N", type=whole(1), help="stop after so many training runs")


def _build(options: argparse.Namespace) -> int:
    build = import_module("overcooked_bench.baselines.pool_queue").main
    code: int = build(
        options.config,
        runs=options.runs,
        output=options.output,
        processes=options.processes,
        layouts=options.layouts,
        groups=options.groups,
        limit=options.limit,
    )
    return code


def _add_show(commands: Any) -> None:
    parser = add_command(
        commands,
        "show",
        _show,
        "show the agents of a pool: how they were trained, what they reach and do with themselves",
        "overcooked-bench pool show dev-v0 --layouts cramped_room",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
    parser.add_argument("--layouts", metavar="A,B", type=names, help="only these layouts")
    parser.add_argument("--json", action="store_true", help="print the entries of the manifest in place of the table")


def _show(options: argparse.Namespace) -> int:
    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.evaluation.shown.pool_tables import pool_tables

    pool = Pool.load(options.pool)
    layouts = _layouts(pool, options.layouts)
    if options.json:
        _print_json([agent for layout in layouts for agent in pool.partners(layout)])
    else:
        console().print(pool_tables(pool, layouts))
    return 0


def _add_verify(commands: Any) -> None:
    parser = add_command(
        commands,
        "verify",
        _verify,
        "check a pool: hashes, lineages, duplicates, and one episode of every agent; exit code 1 where it is not sound",
        "overcooked-bench pool verify dev-v0",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _verify(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.pools.verify import verify_pool

    with ProgressBar("loading") as tell:
        verdict = verify_pool(options.pool, on_progress=tell)
    if options.json:
        findings = [finding._asdict() for finding in verdict.findings]
        _print_json({"sound": verdict.sound, "agents": verdict.agents, "findings": findings})
    else:
        for finding in verdict.findings:
            print(f"{'wrong' if finding.grave else 'warning'}: {finding.text}")
        which = f"{verdict.pool.name} ({verdict.pool.hash[:8]})" if verdict.pool else options.pool
        print(f"{which}: {'sound' if verdict.sound else 'not sound'}, {verdict.agents} agents played")
    return 0 if verdict.sound else 1


def _add_crossplay(commands: Any) -> None:
    parser = add_command(
        commands,
        "crossplay",
        _crossplay,
        "play every agent of a pool with every other one, from both seats: matrix, heat map, ratio to self-play",
        "overcooked-bench pool crossplay dev-v0 --layout forced_coordination --output crossplay/dev-v0",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
    parser.add_argument("--layout", metavar="A,B", type=names, help="only these layouts")
    parser.add_argument("--agents", metavar="A,B", type=names, default=[], help="only these agents, such as 'sp-*'")
    parser.add_argument("--checkpoints", action="store_true", help="checkpoints of a run too, not its last one alone")
    parser.add_argument("--episodes", metavar="N", type=whole(2), default=20, help="episodes of each pair and seat")
    parser.add_argument("--output", metavar="DIR", help="where to write (default: crossplay/<pool>)")
    parser.add_argument(
        "--workers", metavar="N", type=whole(1), help="processes (default: the usable cores, four at most)"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="other start states")
    parser.add_argument("--json", action="store_true", help="print JSON in place of the table")


def _crossplay(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.pools.crossplay import choose, cross_play
    from overcooked_bench.evaluation.shown.heatmap import draw_heat_map
    from overcooked_bench.evaluation.shown.pool_tables import crossplay_tables

    pool = Pool.load(options.pool)
    folder = Path(options.output) if options.output else Path("crossplay") / pool.name
    chosen = {
        layout: choose(pool, layout, options.agents, options.checkpoints) for layout in _layouts(pool, options.layout)
    }
    found = []
    for layout, agents in chosen.items():
        with ProgressBar(layout) as tell:
            one = cross_play(
                pool,
                layout,
                agents,
                episodes=options.episodes,
                seed=options.seed,
                workers=default_workers() if options.workers is None else options.workers,
                on_progress=lambda done, of, layout=layout: tell(layout, done, of),  # type: ignore[misc]
            )
        one.write(folder / layout)
        draw_heat_map(one, folder / f"{layout}.png")
        found.append(one)
    if options.json:
        _print_json(found)
        return 0
    shown = console()
    shown.print(crossplay_tables(found))
    for layout in chosen:
        shown.print(f"{folder / layout}.png, .csv, .json", highlight=False, style="dim")
    return 0


def _layouts(pool: Any, wanted: list[str] | None) -> tuple[str, ...]:
    """Gives the layouts to look at, in the pool's order.

    Raises:
        PoolError: The pool has no agents for one of them.
    """
    from overcooked_bench.agents.pools.manifest import PoolError

    strange = sorted(set(wanted or ()) - set(pool.layouts))
    if strange:
        raise PoolError(f"pool {pool.name!r} has no agents for {', '.join(strange)}; it has {', '.join(pool.layouts)}")
    return tuple(layout for layout in pool.layouts if wanted is None or layout in wanted)


def _print_json(content: Any) -> None:
    import msgspec

    print(msgspec.json.format(msgspec.json.encode(content), indent=2).decode())
