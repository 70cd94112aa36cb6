"""Turns pytest-benchmark's JSON into the tables of RESULTS.md.

python -m pytest tests/benchmarks -m benchmark -n0 --benchmark-json=speed.json
python -m tests.benchmarks.results speed.json
"""

import argparse
import json
import re
import statistics
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).with_name("RESULTS.md")
SECTIONS = ("speed", "scores", "peers", "return")
LIBRARIES = ("numpy", "numba", "gymnasium", "stable-baselines3", "torch")

KITCHEN_TARGETS = {  # grid: ratio to a plain copy at 256 and 4096 kitchens, the same hoped for, joint steps per second
    "5x4": (0.18, 0.25, 15e6),
    "9x5": (0.25, 0.35, None),
}
CALL_TARGETS = {"gymnasium.make_vec": (6e-6, "at most 6 us per call"), "gymnasium.make": (1 / 300e3, "300,000 steps/s")}
START_TARGETS = {"`import overcooked_bench`": 1.0, "`overcooked-bench --help`": 1.0}
FIRST_CALL_TARGETS = {"warm": 1.0, "cold": 5.0}
PARTNER_TARGET = 1.6
TRAINING_TARGETS = {("fast", "5x5", 1): 15e3, ("thesis", "5x5", 2): 2.5e3}  # configuration, grid, threads: steps/s
MEMORY_TARGET = 150e6 / 2**20

INTRODUCTION = """\
# Speed and memory

Measured on the machine named below, with nothing else running where it does not say otherwise; absolute figures vary
from machine to machine, ratios within one table much less. Medians of many rounds; the best round in brackets.

The commands below rewrite the tables between the markers:

```
python -m pytest tests/benchmarks -m benchmark -n0 --benchmark-json=speed.json
python -m tests.benchmarks.results speed.json
python -m tests.benchmarks.score_tables speed.json
python -m tests.benchmarks.peers --overcooked-ai-python PATH --jaxmarl-python PATH
python -m tests.benchmarks.time_to_return --jaxmarl-python PATH --config checked --seeds 3
```

"""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Writes a Markdown table; all columns but the first are numbers."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def write_section(name: str, text: str, path: Path = RESULTS) -> None:
    """Puts a text between the markers of its section, which the file gets where it has none."""
    before = path.read_text() if path.exists() else INTRODUCTION + "\n".join(map(_between, SECTIONS))
    marked = re.compile(rf"<!-- {name}: begin -->\n.*?<!-- {name}: end -->\n", re.DOTALL)
    if not marked.search(before):
        raise ValueError(f"{path.name} has no markers '<!-- {name}: begin -->' and '<!-- {name}: end -->'")
    path.write_text(marked.sub(lambda _: _between(name, text), before))


def _between(name: str, text: str = "Not measured yet.\n") -> str:
    return f"<!-- {name}: begin -->\n{text}<!-- {name}: end -->\n"


def libraries() -> dict[str, str]:
    """Returns the versions of the libraries that a step goes through."""
    return {name: version(name) for name in LIBRARIES}


def circumstances(info: Mapping[str, Any], commit: Mapping[str, Any], date: str) -> str:
    """Says on what and when it was measured, without the machine's name."""
    cpu = info["cpu"]
    versions = ", ".join(f"{name} {found}" for name, found in info["libraries"].items())
    changed = " with changes that are not in it" if commit["dirty"] else ""
    return (
        f"{cpu.get('brand_raw', info['machine'])}, {cpu.get('count', '?')} cores, {info['system']}; "
        f"Python {info['python_version']}, {versions}. {date[:10]}, commit {commit['id'][:12]}{changed}."
    )


def seconds(bench: Mapping[str, Any]) -> tuple[float, float]:
    """Returns the median and the best time of a call."""
    return bench["stats"]["median"], bench["stats"]["min"]


def millions(rate: float) -> str:
    """Writes a rate as 12.3 M or, below 0.1 M, as 12.3 k."""
    return f"{rate / 1e6:.1f} M" if rate >= 1e6 else f"{rate / 1e6:.2f} M" if rate >= 1e5 else f"{rate / 1e3:.1f} k"


def verdict(reached: bool) -> str:
    """Says how a target was met."""
    return "met" if reached else "**missed**"


def kitchen_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Steps with both chefs' observations, and how they compare with a plain copy of as many bytes."""
    places: dict[tuple[str, int], dict[str, tuple[float, float]]] = {}
    for bench in benches:
        extra = bench["extra_info"]
        places.setdefault((extra["layout"], extra["kitchens"]), {})[extra["what"]] = seconds(bench)
    rows = []
    for (layout, n), timed in sorted(places.items(), key=lambda place: (place[0][0].split()[-1], place[0][1])):
        ours, copy, by_numpy = (timed[what] for what in ("step and observe", "compiled copy", "copy by numpy"))
        ratio, best_ratio = copy[0] / ours[0], copy[1] / ours[1]
        least, hoped, rate = KITCHEN_TARGETS[layout.split()[-1]]
        targets = "-"
        if n >= 256:
            targets = f"{least} {verdict(ratio >= least)}, {hoped} {verdict(ratio >= hoped)}"
            targets += f"; {millions(rate)}/s {verdict(n / ours[0] >= rate)}" if rate else ""
        rows.append(
            [
                f"{layout}, {n}",
                f"{millions(n / ours[0])} ({millions(n / ours[1])})",
                f"{ours[0] * 1e6:.1f} us",
                f"{millions(n / copy[0])} ({millions(n / copy[1])})",
                f"{ratio:.2f} ({best_ratio:.2f})",
                f"{by_numpy[0] / ours[0]:.2f} ({by_numpy[1] / ours[1]:.2f})",
                targets,
            ]
        )
    return table(
        [
            *("layout, kitchens", "joint steps/s", "per call"),
            *("plain copies/s", "ratio", "ratio to numpy's copy", "targets"),
        ],
        rows,
    )


def environment_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Steps through Gymnasium and stable-baselines3."""
    rows = []
    for bench in benches:
        extra, (median, best) = bench["extra_info"], seconds(bench)
        target = CALL_TARGETS.get(extra["what"])
        rows.append(
            [
                f"{bench['group']}: {extra['what']}",
                f"{median * 1e6:.2f} us ({best * 1e6:.2f})",
                f"{millions(extra['joint_steps'] / median)} ({millions(extra['joint_steps'] / best)})",
                f"{target[1]}: {verdict(median <= target[0])}" if target else "-",
            ]
        )
    return table(["", "per call", "joint steps/s", "target"], rows)


def partner_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """What partners cost in a step, and in an update of a learner, there beside the same against `stay`."""
    rows = []
    for bench in benches:
        extra, (median, best) = bench["extra_info"], seconds(bench)
        named, target = f"{bench['group']}: {extra['what']}", "-"
        if "ratio_to_stay" in extra:
            ratio, stay = extra["ratio_to_stay"], (extra["stay_median"], extra["stay_min"])
            rows.append([f"{bench['group']}: against stay", *_times(*stay, extra["joint_steps"]), "-"])
            target = f"{ratio:.2f} times stay, at most {PARTNER_TARGET}: {verdict(ratio <= PARTNER_TARGET)}"
        rows.append([named, *_times(median, best, extra["joint_steps"]), target])
    return table(["", "per call", "joint steps/s", "target"], rows)


def training_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Joint steps per second of self-play with its updates, and of the networks' passes alone."""
    rows = []
    for bench in benches:
        extra, (median, best) = bench["extra_info"], seconds(bench)
        steps = extra["joint_steps"]
        target = TRAINING_TARGETS.get((extra["configuration"], extra["grid"], extra["threads"]))
        rows.append(
            [
                extra["what"],
                f"{millions(steps / median)} ({millions(steps / best)})",
                f"{millions(steps / extra['bound_median'])} ({millions(steps / extra['bound_min'])})",
                f"{extra['ratio_to_bound']:.2f}",
                f"{millions(target)}/s: {verdict(steps / median >= target)}" if target else "-",
            ]
        )
    return table(["", "joint steps/s", "the networks alone", "times as long as they", "target"], rows)


def shares_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Where the time of learning goes, in hundredths of all of it."""
    rows = []
    for bench in benches:
        parts = bench["extra_info"]["parts"]
        in_updates = min(parts["update, networks alone"], parts["update"])
        shares = (
            parts["network"],
            parts["kitchens"],
            parts["rollout"] - parts["network"] - parts["kitchens"],
            in_updates,
            parts["update"] - in_updates,
            parts["all"] - parts["rollout"] - parts["update"],
        )
        rows.append([bench["extra_info"]["what"], *(f"{max(0, share) / parts['all']:.0%}" for share in shares)])
    return table(
        ["", "rollout: network", "its kitchens", "its rest", "update: network alone", "its rest", "between them"], rows
    )


def _times(median: float, best: float, joint_steps: int) -> tuple[str, str]:
    unit, name = (1e6, "us") if median < 1e-3 else (1e3, "ms")
    told = f"{median * unit:.2f} {name} ({best * unit:.2f})"
    return told, f"{millions(joint_steps / median)} ({millions(joint_steps / best)})"


def start_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """What a fresh process takes, from its start to its end, and the first calls within."""
    rows = []
    for bench in benches:
        extra, (median, best) = bench["extra_info"], seconds(bench)
        target, within, judged = START_TARGETS.get(extra["what"]), "-", median
        if "first_call" in extra:
            judged = statistics.median(extra["first_call"])
            within = f"{judged:.2f} s ({min(extra['first_call']):.2f})"
            target = next(limit for cache, limit in FIRST_CALL_TARGETS.items() if cache in extra["what"])
        told = f"under {target:g} s: {verdict(judged < target)}" if target else "-"
        rows.append([extra["what"], f"{median:.2f} s ({best:.2f})", within, told])
    return table(["a fresh process", "all of it", "from the end of the import on", "target"], rows)


def memory_table(bench: Mapping[str, Any]) -> str:
    """What 4096 kitchens keep resident."""
    told = bench["extra_info"]["mebibytes"]
    words = {"python": "Python", "numba": "importing numba and numpy", "kitchens": "the kitchens", "all": "all of it"}
    rows = []
    for key, name in words.items():
        target = f"under 150 MB: {verdict(told[key] < MEMORY_TARGET)}" if key in ("kitchens", "all") else "-"
        rows.append([name, f"{told[key] * 2**20 / 1e6:.0f} MB", target])
    return table([f"{bench['extra_info']['what']}", "resident", "target"], rows)


def speed_section(data: Mapping[str, Any]) -> str:
    """Writes the section from pytest-benchmark's JSON.

    Raises:
        ValueError: It holds other benchmarks, or none.
    """
    kinds: dict[str, list[Mapping[str, Any]]] = {
        kind: [] for kind in ("kitchens", "environment", "partners", "training", "start-up", "memory")
    }
    for bench in data["benchmarks"]:
        kinds.get(bench["extra_info"]["kind"], []).append(bench)  # scores have a section of their own
    if not all(kinds.values()):
        raise ValueError(
            f"no {', '.join(kind for kind, found in kinds.items() if not found)} in this file; run them all"
        )
    return f"""\
## The kitchen, its environments, and a fresh process

{circumstances(data["machine_info"], data["commit_info"], data["datetime"])}

`Kitchens.step` with random actions and automatic reset, then `observe("lossless26", out=buffer)`, both chefs' views;
one thread. Beside it the plain copy: a compiled loop that copies one kitchen's observations into every kitchen's place
in such a buffer; ratio = the time it takes for as many bytes, by the time of the call. Numpy's own broadcast copy is
slower.

{kitchen_table(kinds["kitchens"])}
One call of an environment's `step`, partner `stay`, random actions, resets at the horizon included.

{environment_table(kinds["environment"])}
Partners: a step of stable-baselines3's environment with each kind, and an update of a learner (rollout and four passes)
against four frozen policies, each timed right after one against `stay`; the ratio is the median of these pairs.

{partner_table(kinds["partners"])}
Learning in self-play, both seats: an update is a rollout and all passes over it. The networks alone: as many forward
passes of as many rows, and as many forward and backward passes with Adam of as many samples, on random numbers, timed
right before each update; the ratio is the median of these pairs. Below, where the time goes; what the update's passes
take within it is what they take alone, the rest is loss, shuffling, and clipping.

{training_table(kinds["training"])}
{shares_table(kinds["training"])}
From the start of the process to its end. Kernels are cached on disk (warm) or compiled (cold); importing
numba is part of the first call.

{start_table(kinds["start-up"])}
Resident memory of a fresh process that imports, plays one step, and keeps both chefs' observations; "the kitchens"
include their compiled kernels.

{memory_table(kinds["memory"][0])}"""


def main() -> None:
    """Reads the file named on the command line."""
    parser = argparse.ArgumentParser(description="Turns pytest-benchmark's JSON into the tables of RESULTS.md.")
    parser.add_argument("file", type=Path, help="what --benchmark-json wrote")
    parser.add_argument("--into", type=Path, default=RESULTS, help="the Markdown file, RESULTS.md by default")
    arguments = parser.parse_args()
    write_section("speed", speed_section(json.loads(arguments.file.read_text())), arguments.into)


if __name__ == "__main__":
    main()
