"""Notes on what the tables of a score do not show: short ones, and long ones. Terminal and report share them."""

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.tables import count_text
from overcooked_bench.kitchen.menu import DEFAULT_SOUP_REWARD


def short_notes(scores: Scores, around: Beside) -> list[str]:
    """Returns what has to be known to read the one table of a score.

    Args:
        scores: The score.
        around: What it is shown beside.
    """
    headlines = scores.settings.report.headlines
    shown = [one for one in scores.metrics if (one.name in headlines if headlines else "terminal" in one.tables)]
    said = [_kind(scores), *(facts.note for facts in shown if facts.note)]
    if around.reference is not None:
        name = around.reference.agent.name
        said.append(f"{name}: the same games with {name} instead, for comparison.")
    if around.criterion is not None and around.criterion.pool is not None:
        pool = around.criterion.pool.name
        said.append(
            f"{pool}: points with this pool, under the protocol {around.criterion.protocol.name}; never ranked."
        )
    if scores.scenarios:
        total = scores.scenarios.total
        missing = f", {count_text(total.not_attempted)} not attempted" if total.not_attempted else ""
        counted = scores.scenarios.counted
        said.append(
            f"Cooperation {counted}: {count_text(total.passed)} of {count_text(total.attempted)} passed{missing}."
        )
    return [" ".join(said), *_of_this_run(scores), "--explain shows more tables, and what the numbers mean."]


def notes(scores: Scores) -> list[str]:
    """Returns notes on what the tables do not show: intervals, undecided partners, what was not played."""
    said = [f"{_kind(scores)} Points per episode ({_worth(scores)}). {scores.interval}"]
    said += [facts.note for facts in scores.metrics if facts.note and any(scores.select(facts.name))]
    if any(not label.counts for layout in scores.layouts for label in layout.partners):
        said.append("Floors are played and shown but do not count in any score.")
    near: dict[str, list[str]] = {}
    for row in scores.select("undecided"):
        if row.value and row.layout is not None:
            near.setdefault(row.layout, []).append(f"{row.value:.0f} at {row.params['soups']:g}")
    if near:
        where = "; ".join(f"{layout} {', '.join(counts)}" for layout, counts in near.items())
        said.append(f"Partners within two standard errors of a number of soups: {where}.")
    if any(scores.select("pots")):
        said.append(
            "Chefs: per episode the soups that they deliver, the ingredients that they put into pots, and the objects "
            "that they hand over a counter; shares of steps in which the other chef keeps them out of a cell "
            "(blocked), and in which they choose to stay (idle)."
        )
    said += _seeds(scores)
    said += [f"{layout.layout}: {layout.remark}" for layout in scores.layouts if layout.remark]
    said += _of_this_run(scores)
    if scores.scenarios:
        once = (
            " A scenario counts once, by the share of its situations that was passed, from each seat and in the mirror "
            "image."
        )
        counted = scores.scenarios.counted
        said.append(f"Cooperation {counted} are a profile, not a part of the score.{once * (counted == 'scenarios')}")
    if any(label.is_ego for layout in scores.layouts for label in layout.partners):
        said.append("* The scored agent itself is among the partners.")
    return said


def _kind(scores: Scores) -> str:
    runs = scores.training_seeds
    if scores.kind == "agent":
        repaired = scores.settings.report.estimators == "repaired"
        return f"One agent: intervals over {'partners and start states' if repaired else 'episode blocks'}."
    over = "intervals over them" if any(row.low is not None for row in scores.rows) else "no intervals"
    return f"{'A method of ' * (scores.kind == 'method')}{runs} training runs: {over}."


def _of_this_run(scores: Scores) -> list[str]:
    """Returns what is particular to this run: its salt, what was not played, and why it is not ranked."""
    said = []
    if scores.salt != scores.settings.play.salt:
        said.append(f"Salt {scores.salt}: compare with scores of this salt only; --salt repeats it.")
    apart = scores.run.get("isolation")
    if isinstance(apart, dict):
        said.append(str(apart.get("said")))
    adapted = [layout.layout for layout in scores.layouts if layout.adapted]
    if adapted:
        said.append(f"Adapted (played by its mirror image): {', '.join(adapted)}.")
    said += [f"Declined: {one.layout} ({one.reason})." for one in scores.declined]
    if scores.unranked and scores.overall is None:
        said.append(f"No overall score, which is the mean over all layouts of the protocol: {scores.unranked}.")
    elif scores.unranked:
        said.append(f"Not ranked: {scores.unranked}.")
    suite, meant = scores.scenarios and scores.scenarios.suite.sha256, scores.settings.report.scenarios
    if suite and meant and suite != meant.sha256:
        said.append(f"The scenarios are not those that the protocol means ({suite[:8]}, not {meant.sha256[:8]}).")
    return said


def _seeds(scores: Scores) -> list[str]:
    """Returns the range of the headline over training seeds: no interval can see a failure that is not among them."""
    facts = next((facts for facts in scores.metrics if facts.name == scores.headline), None)
    if scores.training_seeds < 2 or facts is None:
        return []
    found = [scores.find(scores.headline, layout=layout.layout) for layout in scores.layouts]
    ranges = [
        f"{row.layout} {min(row.per_repetition):.{facts.digits}f} to {max(row.per_repetition):.{facts.digits}f}"
        for row in found
        if row is not None and row.per_repetition
    ]
    what = facts.label.partition(" ")[0]
    said = f"{what} of single training seeds: {', '.join(ranges)}. No interval sees a failure that is not among them."
    return [said] if ranges else []


def _worth(scores: Scores) -> str:
    """Says what a soup is worth: the same on all layouts as a rule, else layout by layout."""
    points = {layout.layout: layout.soup_points for layout in scores.layouts}
    if len(set(points.values())) <= 1:
        return f"one soup = {next(iter(points.values()), DEFAULT_SOUP_REWARD):g}"
    return "one soup = " + ", ".join(f"{worth:g} on {layout}" for layout, worth in points.items())
