"""The coefficient of human proxies, chosen on held-out pairs: `python -m overcooked_bench.baselines.cloning.sweep A`.

The rule: the largest return with itself that costs at most 0.03 nats per step on the run's held-out pairs, that is at
most 120 % of what the people of the set earn, with a share of stay within 10 points of theirs. The other set of pairs
has no part in it.
"""

import argparse
import json
from pathlib import Path
from typing import Any, Final

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.human.conduct import conduct
from overcooked_bench.human.games import read_games
from overcooked_bench.human.people import LAYOUTS_2019, SETS, chosen

from ..human_proxy import METHOD, Config, people_of, train
from ..presets import load_config
from ..running.place import CONFIG_FILE, Place, read_record, write_record
from ..running.seeds import derive_seed
from .likelihood import foretell
from .played import played

NAMESPACE: Final = "human-sweep"
COEFFICIENTS: Final = (1.0, 0.5, 0.3, 0.2, 0.1, 0.05)
"""In this order, until one breaks the rule."""
MOST_NATS: Final = 0.03
MOST_RETURN: Final = 1.2
"""Of what people earn."""
MOST_IDLE: Final = 0.1
"""Distance of the shares of stay."""
FOUND: Final = "found.json"


def tried(pairs: str, layout: str, coefficient: float, folder: Path, configuration: str) -> dict[str, Any] | None:
    """Trains a proxy with a coefficient, or reads what came of it; None if it was interrupted."""
    own = folder / f"{pairs}-{layout}-{coefficient}"
    if known := read_record(own / FOUND, dict[str, Any]):
        return known
    config = load_config(METHOD, configuration, layout=layout, pairs=pairs, coefficient=coefficient)
    assert isinstance(config, Config)
    seed = derive_seed(NAMESPACE, layout, METHOD, sorted(SETS).index(pairs))
    outcome = train(config, Place(own, seed, resume=(own / CONFIG_FILE).exists()))
    if outcome is None:
        return None
    record = read_record(own / CONFIG_FILE, dict[str, Any]) or {}
    held_out = people_of(config).of(record["held_out"])
    games = [game for game in chosen(read_games(config.games), pairs) if game.layout == layout]
    people = conduct(games)
    stages = (("clone", outcome.snapshots[0.0].files), ("regularised", outcome.files))
    found: dict[str, Any] = {"pairs": pairs, "layout": layout, "coefficient": coefficient}
    for name, files in stages:
        policy = load_policy(files.weights)
        does = conduct(played((policy, policy)))
        found[name] = {
            "nats": foretell(policy, held_out).nats,
            "soups": does.soups.value,
            "idle": does.idle.value,
        }
    found["people"] = {"soups": people.soups.value, "idle": people.idle.value}
    write_record(own / FOUND, found)
    return found


def cost(found: dict[str, Any]) -> float:
    """Returns what the second stage costs, in nats per step of the held-out pairs."""
    return float(found["regularised"]["nats"] - found["clone"]["nats"])


def obeys(found: dict[str, Any]) -> bool:
    """Returns whether a proxy is within the bounds of the rule."""
    proxy, people = found["regularised"], found["people"]
    return (
        cost(found) <= MOST_NATS
        and bool(proxy["soups"] <= MOST_RETURN * people["soups"])
        and bool(abs(proxy["idle"] - people["idle"]) <= MOST_IDLE)
    )


def choose(results: list[dict[str, Any]]) -> dict[str, Any]:
    """Applies the rule to what was tried on one layout; the cheapest one where none obeys it."""
    fit = [one for one in results if obeys(one)]
    return max(fit, key=lambda one: one["regularised"]["soups"]) if fit else min(results, key=cost)


def main() -> int:
    """Trains, prints a line for each try, and the choice for each layout as a pool's configuration has it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("pairs", choices=sorted(SETS))
    parser.add_argument("--layouts", default=",".join(LAYOUTS_2019))
    parser.add_argument("--config", default="lossless")
    parser.add_argument("--output", type=Path, default=Path("runs/human/sweep"))
    options = parser.parse_args()
    for layout in options.layouts.split(","):
        results: list[dict[str, Any]] = []
        for coefficient in COEFFICIENTS:
            found = tried(options.pairs, layout, coefficient, options.output, options.config)
            if found is None:
                return 130
            results.append(found)
            print(json.dumps(found | {"cost": round(cost(found), 4)}), flush=True)
            if not obeys(found):
                break
        print(f"{options.pairs} {layout}: {{coefficient: {choose(results)['coefficient']}}}", flush=True)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
