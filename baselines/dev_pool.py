"""Builds the pool `dev-v0`: four self-play agents for each classic layout, to develop and to try things against.

`python -m overcooked_bench.baselines.dev_pool --runs runs/dev-v0` trains what is missing, one run after the other, and
goes on where it was stopped; several may run side by side with different `--layouts`. `--write` then makes the pool.
"""

import json
import shutil
import sys
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import tyro

from overcooked_bench.agents.manifest import AgentRecord
from overcooked_bench.agents.manifest import SelfPlay as SelfPlayReturn
from overcooked_bench.agents.policy import policy_files
from overcooked_bench.agents.pool import write_manifest
from overcooked_bench.evaluation.statistics import t_interval

from .seeds import derive_seed
from .self_play import CONFIG_FILE, METHOD, SelfPlay, train

POOL = "dev-v0"
AGENTS = 4
CONFIGS = {
    "cramped_room": SelfPlay("cramped_room"),
    "asymmetric_advantages": SelfPlay("asymmetric_advantages"),
    "coordination_ring": SelfPlay("coordination_ring"),
    "forced_coordination": SelfPlay("forced_coordination"),
    "counter_circuit": SelfPlay("counter_circuit", steps=2_800_000),
}
_TOLD_ELSEWHERE = ("layout", "seed", "steps", "method", "training_seed")  # in the manifest's entry itself


@dataclass(frozen=True)
class Arguments:
    """Trains the agents of the pool dev-v0, and writes the pool."""

    runs: Path = Path("runs") / POOL
    """Where the training runs lie."""
    layouts: tuple[str, ...] = tuple(CONFIGS)
    """Which layouts to train."""
    agents: tuple[int, ...] = tuple(range(AGENTS))
    """Which agents of each layout to train."""
    write: bool = False
    """Write the pool from the finished runs instead of training."""


def build(runs: Path, layouts: tuple[str, ...], agents: tuple[int, ...]) -> bool:
    """Trains the agents that are not finished yet, going on from their checkpoints; tells whether all are finished."""
    for index in agents:
        for layout in layouts:
            run, config = runs / layout / f"sp-{index}", CONFIGS[layout]
            if (run / "record.json").exists():
                continue
            seed = derive_seed(POOL, layout, METHOD, index)
            outcome = train(config, run, seed, resume=(run / "checkpoint.pt").exists())
            if outcome is None:
                return False
            mean, low, high = t_interval(outcome.returns)
            returns = {"mean": mean, "low": low, "high": high, "episodes": len(outcome.returns)}
            record = {"seed": seed, "steps": outcome.steps, "self_play": returns, "seconds": outcome.seconds}
            (run / "record.json").write_text(json.dumps(record, indent=2) + "\n")
            print(f"{layout} sp-{index}: {mean:.1f} points in {outcome.seconds:.0f} s", flush=True)
    return True


def write(runs: Path, pool: Path) -> None:
    """Copies the finished runs' policies into the pool's folder and writes its manifest."""
    records = []
    for layout in CONFIGS:
        for index in range(AGENTS):
            run, name = runs / layout / f"sp-{index}", f"sp-{index}"
            if not (run / "record.json").exists():
                continue
            record = json.loads((run / "record.json").read_text())
            (pool / layout).mkdir(parents=True, exist_ok=True)
            for source, target in zip(policy_files(run / "policy"), policy_files(pool / layout / name), strict=True):
                shutil.copyfile(source, target)
            training = json.loads((run / CONFIG_FILE).read_text())
            records.append(
                AgentRecord(
                    name=name,
                    layout=layout,
                    method=METHOD,
                    seed=record["seed"],
                    namespace=POOL,
                    lineage=f"{POOL}/{layout}/{name}",
                    training={key: value for key, value in training.items() if key not in _TOLD_ELSEWHERE},
                    steps=record["steps"],
                    cooking=training["cooking"],
                    mode="sample",
                    self_play=SelfPlayReturn(**record["self_play"]),
                )
            )
    write_manifest(pool, POOL, records, cooking="auto", mode="sample")


def main(arguments: list[str]) -> int:
    """Runs the module's command; gives the exit code."""
    given = tyro.cli(Arguments, args=arguments)
    if unknown := sorted({*given.layouts} - {*CONFIGS}):
        print(f"{POOL} has no agents for {', '.join(unknown)}; its layouts are {', '.join(CONFIGS)}", file=sys.stderr)
        return 2
    if given.write:
        write(given.runs, Path(str(files("overcooked_bench.baselines").joinpath("pools", POOL))))
        return 0
    return 0 if build(given.runs, given.layouts, given.agents) else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
