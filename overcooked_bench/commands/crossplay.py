"""`overcooked-bench crossplay`: play every agent of a pool with every other one, or entrants as a protocol says."""

import argparse
from typing import Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_command,
    add_engine,
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
from overcooked_bench.commands.pool import chosen_layouts


def add_crossplay(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "crossplay",
        _crossplay,
        "play every agent of a pool with every other one: matrix, heat map, ratio; or entrants, for ordered curves",
        "overcooked-bench crossplay train-v1 dev-v1 --protocol thesis --output crossplay/thesis",
    )
    parser.add_argument(
        "pools",
        metavar="POOL",
        nargs="+",
        help="a shipped pool's name, or a folder; with --protocol everyone plays with the self-play agents of the "
        "first one, and its other agents, further pools, entries and scripted agents are entrants",
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="such as thesis: ordered curves of entrants with self-play agents and with one another, and its Table 7.3",
    )
    add_layouts(parser)
    parser.add_argument(
        "--agents", metavar="A,B", type=names, default=[], help="only agents of these names or patterns, such as 'sp-*'"
    )
    parser.add_argument(
        "--checkpoints",
        action="store_true",
        help="include every checkpoint of each training run, not only the last one",
    )
    parser.add_argument(
        "--episodes", metavar="N", type=whole(2), help="episodes per pair and seat (default: 20, or the protocol's)"
    )
    add_output(parser, "crossplay/<pool>, or crossplay/<protocol>")
    add_workers(parser)
    add_engine(parser)
    add_seed(parser, "seed of the start states and random streams")
    add_json(parser)


def _crossplay(options: argparse.Namespace) -> int:
    from overcooked_bench.errors import WrongUse

    if options.protocol is not None:
        if options.agents or options.checkpoints or options.episodes is not None:
            raise WrongUse(
                "--agents, --checkpoints and --episodes do not go with --protocol, which says what is played; leave "
                "them out, or write a protocol file of your own"
            )
        return _ordered(options)
    if len(options.pools) > 1:
        raise WrongUse(
            f"{len(options.pools)} pools given; the matrix is of one pool, and of several there are ordered curves: "
            "add --protocol thesis"
        )
    return _matrix(options)


def _matrix(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.pools.crossplay import EPISODES, choose, cross_play
    from overcooked_bench.evaluation.shown.heatmap import draw_heat_map
    from overcooked_bench.evaluation.shown.pool_tables import crossplay_tables

    pool = Pool.load(options.pools[0])
    folder = Path(options.output) if options.output else Path("crossplay") / pool.name
    chosen = {
        layout: choose(pool, layout, options.agents, options.checkpoints)
        for layout in chosen_layouts(pool, options.layouts)
    }
    found = []
    for layout, agents in chosen.items():
        with ProgressBar(layout) as tell:
            one = cross_play(
                pool,
                layout,
                agents,
                episodes=options.episodes or EPISODES,
                seed=options.seed,
                workers=options.workers or default_workers(),
                engine=options.engine,
                on_progress=lambda done, of, layout=layout: tell(layout, done, of),  # type: ignore[misc]
            )
        one.write(folder / layout)
        draw_heat_map(one, folder / f"{layout}.png")
        found.append(one)
    if options.json:
        print_json(found)
        return 0
    shown = console()
    shown.print(crossplay_tables(found))
    for layout in chosen:
        shown.print(f"{folder / layout}.png, .csv, .json", highlight=False, markup=False, style="dim")
    return 0


def _ordered(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.ordered.table import ordered_cross_play
    from overcooked_bench.evaluation.protocol import load_protocol
    from overcooked_bench.evaluation.shown.ordered_plot import draw_ordered
    from overcooked_bench.evaluation.shown.ordered_tables import curves_csv, ordered_tables

    protocol = load_protocol(options.protocol)
    with ProgressBar("compiling and loading") as tell:
        found = ordered_cross_play(
            options.pools,
            protocol,
            layouts=options.layouts,
            seed=options.seed,
            workers=options.workers or default_workers(),
            engine=options.engine,
            on_progress=tell,
        )
    folder = Path(options.output) if options.output else Path("crossplay") / protocol.name
    found.write(folder)
    (folder / "curves.csv").write_text(curves_csv(found), "utf-8", newline="")
    for figure in found.figures:
        draw_ordered(figure, found.rule, folder / f"{figure.layout}-{figure.partners.replace(' ', '-')}.png")
    if options.json:
        print_json(found)
        return 0
    shown = console()
    shown.print(ordered_tables(found))
    shown.print(f"{folder}: ordered.json, curves.csv, *.png", highlight=False, markup=False, style="dim")
    return 0
