"""Writes a `Scenario` as YAML."""

import json
from typing import Any

import yaml

from overcooked_bench.kitchen.codes import PICTURE_NAMES
from overcooked_bench.kitchen.state import Chef, Soup
from overcooked_bench.scenarios.language.loading import FACING_NAMES
from overcooked_bench.scenarios.language.picture import CHEFS, draw_picture
from overcooked_bench.scenarios.language.terms import Condition, Either
from overcooked_bench.scenarios.scenario import Scenario


def scenario_text(scenario: Scenario) -> str:
    """Writes a scenario as YAML without comments; `read_scenario` reads the same scenario from it."""
    layout, state = scenario.layout, scenario.state
    lines = [f"id: {scenario.id}", f"category: {scenario.category}"]
    lines += [f"family: {scenario.family}"] * (scenario.family != scenario.id.partition("-")[0])
    lines += [f"tags: {_flow(list(scenario.tags))}"] * bool(scenario.tags)
    lines += _block("layout", layout.name) if "\n" in layout.name else [f"layout: {layout.name}"]
    lines += [f"cooking: {scenario.cooking}"] * (scenario.cooking != "auto")
    lines += _block("kitchen", draw_picture(layout, state, 0))
    lines += [f"A: {_flow(_chef(state.chefs[0]))}", f"B: {_flow({**_chef(state.chefs[1]), **scenario.drawn})}"]
    pots = {
        number: _pot(content)
        for number, cell in enumerate(layout.positions("P"), start=1)
        if isinstance(content := state.objects.get(cell), Soup)
    }
    lines += [f"pots: {_flow(pots)}"] * bool(pots)
    lines.append(f"accept: {_condition(scenario.accept)}")
    lines += [f"never: {_condition(scenario.never)}"] if scenario.never else []
    lines += [f"budget: {scenario.budget}"] if scenario.budget else []
    if scenario.before:
        played = {name: [PICTURE_NAMES[joint[k]] for joint in scenario.before] for k, name in enumerate(CHEFS)}
        lines.append(f"before: {_flow(played)}")
    lines += [f"pair: {scenario.pair}"] if scenario.pair else []
    return "\n".join([*lines, f"why: {_quoted(scenario.why)}"]) + "\n"


def behaviour_text(scenario: Scenario) -> str:
    """Writes B's behaviour as YAML."""
    return _flow(dict(scenario.drawn))


def _chef(chef: Chef) -> dict[str, Any]:
    named = {facing: name for name, facing in FACING_NAMES.items()}
    holds = "soup" if isinstance(chef.holding, Soup) else chef.holding
    return {"facing": named[chef.facing], **({"holds": holds} if holds else {})}


def _pot(soup: Soup) -> str:
    if soup.is_ready:
        return "ready"
    if soup.is_cooking:
        return f"cooking {soup.remaining} left"
    return f"{sum(soup.recipe)} onion" + "s" * (sum(soup.recipe) > 1)


def _condition(condition: Condition) -> str:
    if isinstance(condition, Either):
        return _flow([str(part) for part in condition.conditions])
    return _quoted(str(condition))


def _block(key: str, text: str) -> list[str]:
    return [f"{key}: |", *(f"  {row}" for row in text.split("\n"))]


def _flow(value: Any) -> str:
    text: str = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=10_000)
    return text.strip()


def _quoted(text: str) -> str:
    """Writes a text without quotes if YAML reads the same text back, else in quotes."""
    plain = "\n" not in text and _reads_back(text)
    return text if plain else json.dumps(text, ensure_ascii=False)


def _reads_back(text: str) -> bool:
    try:
        return bool(yaml.safe_load(f"key: {text}") == {"key": text})
    except yaml.YAMLError:
        return False
