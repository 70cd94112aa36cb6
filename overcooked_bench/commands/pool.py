"""`overcooked-bench pool`: build, show and verify sets of frozen agents."""

import argparse
from typing import Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_command,
    add_engine,
    add_group,
    add_json,
    add_layouts,
    add_output,
    add_seed,
    add_workers,
    console,
    names,
    print_json,
    whole,
)


def add_pool(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands, "pool", "build, show and verify sets of frozen agents", "overcooked-bench pool show dev-v0"
    )
    for add in (_add_build, _add_show, _add_verify, _add_oracle):
        add(inner)


def _add_build(commands: Any) -> None:
    parser = add_command(
        commands,
        "build",
        _build,
        "train every agent that a pool's configuration names; to resume after a stop, run the same command again",
        "overcooked-bench pool build train-v1 --workers 2 --layouts cramped_room --limit 2",
    )
    parser.add_argument("config", metavar="CONFIG", help="a shipped configuration's name, or a YAML file")
    add_workers(parser)
    add_engine(parser, "where candidates are measured; training runs stay on this machine")
    parser.add_argument("--runs", metavar="DIR", help="folder of the training runs (default: runs/<pool>)")
    add_output(parser, "pools/<pool>")
    add_layouts(parser)
    parser.add_argument(
        "--groups", metavar="A,B", type=names, help="only these groups of the configuration, by their key `prefix`"
    )
    parser.add_argument("--limit", metavar="N", type=whole(1), help="stop after N training runs")
    parser.add_argument(
        "--salt", metavar="TEXT", default="", help="enters all seeds: another pool of the same recipe; see v1-twin"
    )


def _build(options: argparse.Namespace) -> int:
    from overcooked_bench.baselines.building.command import main
    from overcooked_bench.evaluation.games.engines import default_workers

    code: int = main(
        options.config,
        runs=options.runs,
        output=options.output,
        workers=options.workers or default_workers(),
        layouts=options.layouts,
        groups=options.groups,
        limit=options.limit,
        salt=options.salt,
        engine=options.engine,
    )
    return code


def _add_show(commands: Any) -> None:
    parser = add_command(
        commands,
        "show",
        _show,
        "show the agents of a pool: how they were trained, and their return and behaviour in self-play",
        "overcooked-bench pool show dev-v0 --layouts cramped_room",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
    add_layouts(parser)
    add_json(parser)


def _show(options: argparse.Namespace) -> int:
    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.evaluation.shown.pool_tables import pool_tables

    pool = Pool.load(options.pool)
    layouts = chosen_layouts(pool, options.layouts)
    if options.json:
        print_json([agent for layout in layouts for agent in pool.partners(layout)])
    else:
        console().print(pool_tables(pool, layouts))
    return 0


def _add_verify(commands: Any) -> None:
    parser = add_command(
        commands,
        "verify",
        _verify,
        "check a pool: hashes, lineages, people, duplicates, and one episode per agent; exits with 1 if a check fails",
        "overcooked-bench pool verify dev-v0",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
    parser.add_argument(
        "--against",
        metavar="OTHER",
        nargs="+",
        default=[],
        help="pools that it must share nothing with, besides the shipped ones of other names",
    )
    add_json(parser)


def _verify(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.pools.verify import verify_pool

    with ProgressBar("loading") as tell:
        verdict = verify_pool(options.pool, options.against, on_progress=tell)
    if options.json:
        findings = [finding._asdict() for finding in verdict.findings]
        print_json(
            {
                "sound": verdict.sound,
                "agents": verdict.agents,
                "findings": findings,
                "shares_no_person_with": verdict.strangers,
            }
        )
    else:
        for finding in verdict.findings:
            print(f"{'wrong' if finding.grave else 'warning'}: {finding.text}")
        for other in verdict.strangers:
            print(f"shares no person with {other}")
        which = f"{verdict.pool.name} ({verdict.pool.hash[:8]})" if verdict.pool else options.pool
        state = "" if verdict.pool is None or verdict.pool.frozen else "; a release candidate, which may still change"
        print(f"{which}: {'sound' if verdict.sound else 'not sound'}, {verdict.agents} agents played{state}")
    return 0 if verdict.sound else 1


def _add_oracle(commands: Any) -> None:
    parser = add_command(
        commands,
        "oracle",
        _oracle,
        "play the best known responder of each partner and side with it, as an agent would that knows whom it meets",
        "overcooked-bench pool oracle v1 --layouts cramped_room",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder; its bounds were measured")
    add_layouts(parser)
    parser.add_argument(
        "--episodes", metavar="N", type=whole(2), default=100, help="episodes per partner and seat (default: 100)"
    )
    add_workers(parser)
    add_seed(parser, "seed of the start states and random streams")
    add_json(parser)


def _oracle(options: argparse.Namespace) -> int:
    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.pools.oracle import oracle_score, play_oracle
    from overcooked_bench.evaluation.shown.pool_tables import oracle_table

    pool = Pool.load(options.pool)
    found = {}
    for layout in chosen_layouts(pool, options.layouts):
        with ProgressBar(layout) as tell:
            found[layout] = play_oracle(
                *(pool, layout, options.episodes, options.seed, options.workers or default_workers()),
                on_progress=lambda done, of, layout=layout: tell(layout, done, of),  # type: ignore[misc]
            )
    if options.json:
        print_json(
            {
                layout: {"normalised": oracle_score(rows), "partners": [row._asdict() for row in rows]}
                for layout, rows in found.items()
            }
        )
    else:
        console().print(oracle_table(found).terminal())
        print(
            f"{pool.name} ({pool.hash[:8]}): about 1 by construction; how far from 1 is noise of episodes and ceilings"
        )
    return 0


def chosen_layouts(pool: Any, wanted: list[str] | None) -> tuple[str, ...]:
    """Returns the layouts to look at, in the pool's order.

    Raises:
        PoolError: The pool has no agents for one of them.
    """
    from overcooked_bench.agents.pools.manifest import PoolError

    strange = sorted(set(wanted or ()) - set(pool.layouts))
    if strange:
        raise PoolError(f"pool {pool.name!r} has no agents for {', '.join(strange)}; it has {', '.join(pool.layouts)}")
    return tuple(layout for layout in pool.layouts if wanted is None or layout in wanted)
