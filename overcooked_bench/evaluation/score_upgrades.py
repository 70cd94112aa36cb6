"""Turns the score.json of older versions into the present form."""

from collections.abc import Iterator
from typing import Any

from overcooked_bench.evaluation.protocol import upgrade

_METRICS = (
    {"name": "mean", "label": "mean [95 %]"},
    {"name": "threshold", "label": "≥{soups:g}", "unit": "share", "digits": 0, "interval": False,
     "note": "≥n: share of partners with a mean return of at least n soups."},
    {"name": "undecided", "label": "near {soups:g}", "unit": "partners", "digits": 0, "tables": []},
    {"name": "tail_mean", "label": "worst 15 %", "tables": ["report"]},
    {"name": "tail_quantile", "label": "q0.15", "tables": []},
    {"name": "curve", "label": "rank {rank:g}", "tables": []},
    {"name": "curve_quantile", "label": "q0.15 of rank {rank:g}", "tables": []},
    {"name": "ego_soups", "label": "own soups", "unit": "soups", "digits": 2, "tables": []},
    {"name": "partner_soups", "label": "partner's soups", "unit": "soups", "digits": 2, "tables": []},
)  # fmt: skip


def from_1(old: dict[str, Any]) -> dict[str, Any]:
    """Reads schema 1, which had one entry per metric and layout, and a mean over the layouts that were not declined."""
    settings = upgrade(old["settings"])
    missing = list(old["not_attempted"])
    overall = None if missing or len(old["layouts"]) < len(settings["play"]["layouts"]) else old["overall"]
    left = [name for name in settings["play"]["layouts"] if name not in {one["layout"] for one in old["layouts"]}]
    rows = [row for layout in old["layouts"] for row in _rows(layout, settings["play"]["seats"])]
    if overall:
        rows.append({"metric": "mean", **overall})
    kept = ("protocol", "agent", "pool", "seed", "training_seeds", "interval", "run")
    return {
        **{key: old[key] for key in kept},
        "schema": 2,
        "settings": settings,
        "salt": old.get("salt", settings["play"]["salt"]),
        "overall": overall,
        "unranked": None if overall else f"not played: {', '.join(left)}",
        "layouts": [_layout(layout) for layout in old["layouts"]],
        "declined": [{"layout": name, "reason": "the agent does not play it"} for name in missing],
        "faults": [],
        "metrics": list(_METRICS),
        "rows": rows,
        "scenarios": old.get("scenarios"),
    }


def from_2(old: dict[str, Any]) -> dict[str, Any]:
    """Reads schema 2, which counted each situation of a scenario, and those that were not attempted as failed."""
    scenarios = old["scenarios"]
    if scenarios is not None:
        scenarios = {
            **scenarios,
            "categories": [_category(one) for one in scenarios["categories"]],
            "total": _category(scenarios["total"]),
            "counted": "situations",
        }
    return {**old, "schema": 3, "scenarios": scenarios}


def _category(old: dict[str, Any]) -> dict[str, Any]:
    kept = ("category", "passed", "not_attempted", "share")
    return {**{key: old[key] for key in kept}, "attempted": old["items"] - old["not_attempted"]}


def _layout(old: dict[str, Any]) -> dict[str, Any]:
    cells = sorted(old["cells"], key=lambda cell: str(cell["partner"]))
    return {
        "layout": old["layout"],
        "adapted": old["adapted"],
        "soup_points": old.get("soup_points", 20.0),
        "partners": [
            {
                "name": cell["partner"],
                "kind": cell["kind"],
                "sha256": cell["sha256"],
                "stratum": cell["kind"],
                "is_ego": cell["is_ego"],
            }
            for cell in (*cells, *old["floors"])
        ],
        "remark": old["low_quantile"],
    }


def _rows(old: dict[str, Any], seats: list[int]) -> Iterator[dict[str, Any]]:
    where = {"layout": old["layout"]}
    yield {"metric": "mean", **where, **old["mean"]}
    for seat, mean in zip(seats, old["seats"], strict=True):
        yield {"metric": "mean", **where, "seat": seat, **mean}
    for threshold in old["thresholds"]:
        params = {"params": {"soups": threshold["soups"]}}
        ends = {key: value if value is None else value / old["partners"] for key, value in threshold["reached"].items()}
        yield {"metric": "threshold", **params, **where, **ends, "value": threshold["share"]}
        if threshold["undecided"] is not None:
            yield {"metric": "undecided", **params, **where, "value": threshold["undecided"]}
    yield {"metric": "tail_mean", **where, **old["tail_mean"]}
    yield {"metric": "tail_quantile", **where, **old["tail_quantile"]}
    for point in old["curve"]:
        params = {"params": {"rank": point["rank"]}}
        yield {"metric": "curve", **params, **where, **point["mean"]}
        if point["low_quantile"] is not None:
            yield {"metric": "curve_quantile", **params, **where, "value": point["low_quantile"]}
    for cell in (*old["cells"], *old["floors"]):
        who = {**where, "partner": cell["partner"]}
        yield {"metric": "mean", **who, **cell["mean"]}
        for seat, mean in zip(seats, cell["seats"], strict=True):
            yield {"metric": "mean", **who, "seat": seat, **mean}
        for metric in ("ego_soups", "partner_soups"):
            yield {"metric": metric, **who, "value": cell[metric]}
