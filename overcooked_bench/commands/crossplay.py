"""`overcooked-bench crossplay`: play every agent of a pool with every other one."""

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
        "play every agent of a pool with every other one, from both seats: matrix, heat map, ratio to self-play",
        "overcooked-bench crossplay dev-v0 --layouts forced_coordination --output crossplay/dev-v0",
    )
    parser.add_argument("pool", metavar="POOL", help="a shipped pool's name, or a folder")
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
        "--episodes", metavar="N", type=whole(2), default=20, help="episodes per pair and seat (default: 20)"
    )
    add_output(parser, "crossplay/<pool>")
    add_workers(parser)
    add_engine(parser)
    add_seed(parser, "seed of the start states and random streams")
    add_json(parser)


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
                episodes=options.episodes,
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
