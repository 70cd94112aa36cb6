"""Turns scenarios into pytest items: one for each scenario, seat and mirror image, or for each pair.

Without an agent they are only collected and skipped; the modules that play are imported when there is one.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import Item, Select, items, load_items, read_files
from overcooked_bench.scenarios.language.writing import scenario_text
from overcooked_bench.scenarios.plugin.stash import BENCH, MARKER, NO_AGENT
from overcooked_bench.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from overcooked_bench.scenarios.plugin.bench import Bench
    from overcooked_bench.scenarios.results import ItemResult

WIDTH: Final = 100
"""Characters per line of the frames of a failure."""


class ScenarioFailure(Exception):
    """The agent failed an item.

    Attributes:
        explanation: The reason, in many lines.
    """

    def __init__(self, head: str, explanation: str) -> None:
        super().__init__(head)
        self.explanation = explanation


class _Tested(pytest.Item):
    """A pytest item that an agent passes or fails; `category` and `words` select it.

    Args:
        category: One of `CATEGORIES`.
        words: Further words for `-k`.
    """

    def __init__(self, *, category: str, words: Iterable[str], **settings: Any) -> None:
        super().__init__(**settings)
        self.category = category
        self.add_marker(MARKER + category)
        self.extra_keyword_matches.update((category, *words))

    @property
    def bench(self) -> "Bench":
        """The tested agent and its results."""
        bench = self.config.stash[BENCH]
        assert bench is not None
        return bench

    def setup(self) -> None:
        """Skips the item if there is no agent to test."""
        if self.config.stash[BENCH] is None:
            pytest.skip(NO_AGENT)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Returns why the agent failed it, without a traceback."""
        error = excinfo.value
        if not isinstance(error, (ScenarioFailure, OvercookedBenchError, OSError)):
            return super().repr_failure(excinfo)
        return _plainly(excinfo, error.explanation if isinstance(error, ScenarioFailure) else str(error))


class ScenarioItem(_Tested):
    """An item of the suite.

    Args:
        entry: The item.

    Attributes:
        scenario_record: Its result, for the summary and the report.
    """

    def __init__(self, *, entry: Item, **settings: Any) -> None:
        super().__init__(category=entry.category, words=(entry.family, *entry.tags), **settings)
        self.entry = entry
        self.scenario_record: dict[str, Any] | None = None

    def runtest(self) -> None:
        """Plays it together with the items that share its kitchen, unless that has been done."""
        from overcooked_bench.scenarios.results import faulty
        from overcooked_bench.scenarios.shown.explaining import explain, headline

        others = [item.entry for item in self.session.items if isinstance(item, ScenarioItem)]
        try:
            result = self.bench.result(self.entry, others)
        except (OvercookedBenchError, OSError) as error:
            self.scenario_record = faulty(self.entry, str(error)).to_dict()
            raise
        self.scenario_record = result.to_dict()
        self.user_properties += _properties(result)
        if not result.passed:
            explanation = explain(result, self.bench.agent, width=WIDTH, **self.bench.replay_settings)
            raise ScenarioFailure(headline(result), explanation)

    def reportinfo(self) -> tuple[Path, None, str]:
        """Returns the scenario's file."""
        return Path(self.entry.scenarios[0].source), None, self.entry.id


class FuzzItem(_Tested):
    """Random kitchens of a family.

    Args:
        scenarios: The scenarios whose kitchens are varied.
    """

    def __init__(self, *, scenarios: list[Scenario], **settings: Any) -> None:
        first = scenarios[0]
        super().__init__(category=first.category, words=(first.family, "fuzz"), **settings)
        self._scenarios = scenarios

    def runtest(self) -> None:
        """Searches for a kitchen in which the agent fails."""
        from overcooked_bench.scenarios.shown.explaining import explain, headline
        from overcooked_bench.scenarios.solving.fuzzing import search_failure

        found = search_failure(self._scenarios, self.bench.play, self.config.option.ocb_fuzz)
        self.user_properties.append(("kitchens", found.tried))
        if found.failure is not None:
            explanation = explain(found.failure, self.bench.agent, width=WIDTH)
            text = scenario_text(found.failure.item.scenarios[0])
            raise ScenarioFailure(
                headline(found.failure), f"{explanation}\n\nthe smallest kitchen, as a scenario:\n\n{text}"
            )

    def reportinfo(self) -> tuple[Path, None, str]:
        """Returns the family's file."""
        return Path(self._scenarios[0].source), None, self.name


class ScenarioFile(pytest.File):
    """A scenario that a user wrote."""

    def collect(self) -> Iterator[pytest.Item]:
        """Yields its items; a pair belongs to the first of its two files."""
        try:
            found = items(read_files([self.path]))
        except ScenarioError as error:
            raise self.CollectError(str(error)) from None
        here = self.path.resolve()
        yield from _collect(self, [e for e in found if Path(e.scenarios[0].source).resolve() == here])


def make_items(parent: pytest.Collector, select: Select) -> list[pytest.Item]:
    """Returns the items of a module's `Scenarios`."""
    try:
        found = load_items(select)
    except ScenarioError as error:
        raise parent.CollectError(str(error)) from None
    return list(_collect(parent, found))


def _collect(parent: pytest.Collector, found: list[Item]) -> Iterator[pytest.Item]:
    for entry in found:
        yield ScenarioItem.from_parent(parent, name=entry.id, entry=entry)
    if parent.config.option.ocb_fuzz is not None:
        families: dict[str, dict[str, Scenario]] = {}
        for scenario in (scenario for entry in found for scenario in entry.scenarios if not scenario.before):
            families.setdefault(scenario.family, {})[scenario.id] = scenario
        for family, scenarios in sorted(families.items()):
            drawn_from = [scenarios[name] for name in sorted(scenarios)]
            yield FuzzItem.from_parent(parent, name=f"{family}-fuzz", scenarios=drawn_from)


def arrange(config: pytest.Config, collected: list[pytest.Item]) -> None:
    """Deselects what is not asked for, marks known failures, and prepares the rest for xdist.

    Args:
        config: The session's configuration.
        collected: All items, changed in place.

    Raises:
        pytest.UsageError: An id occurs in two files, or there is no such category.
    """
    known: dict[str, ScenarioItem] = {}
    for item in collected:
        if isinstance(item, ScenarioItem) and known.setdefault(item.entry.id, item) is not item:
            where = [each.entry.scenarios[0].source for each in (known[item.entry.id], item)]
            raise pytest.UsageError(f"the scenario {item.entry.id} is in {where[0]} and in {where[1]}; rename one")
    wanted = _categories(config)
    left_out = [item for item in collected if isinstance(item, _Tested) and item.category not in wanted]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        gone = set(left_out)
        collected[:] = [item for item in collected if item not in gone]
    bench, workers = config.stash[BENCH], config.pluginmanager.hasplugin("xdist")
    for item in known.values():
        if workers:  # --dist loadgroup plays a kitchen's items in one worker
            item.add_marker(pytest.mark.xdist_group("-".join(map(str, item.entry.kitchen))))
        reason = bench.expected(item.entry.id) if bench else None
        if reason is not None:
            item.add_marker(pytest.mark.xfail(reason=reason, strict=True))
    if hasattr(config, "workerinput"):  # a worker is dealt neighbours
        places = [index for index, item in enumerate(collected) if isinstance(item, ScenarioItem)]
        ours = [item for item in collected if isinstance(item, ScenarioItem)]
        for place, item in zip(places, sorted(ours, key=lambda i: (i.entry.kitchen, i.entry.id)), strict=True):
            collected[place] = item


def _categories(config: pytest.Config) -> set[str]:
    given = config.option.ocb_category
    if not given:
        return set(CATEGORIES)
    wanted = {name.strip() for names in given for name in names.split(",") if name.strip()}
    strange = sorted(wanted - set(CATEGORIES))
    if strange or not wanted:
        raise pytest.UsageError(f"--category {', '.join(strange)}: choose among {', '.join(CATEGORIES)}")
    return wanted


def _plainly(excinfo: pytest.ExceptionInfo[BaseException], text: str) -> Any:
    """Makes pytest show a text for a failure, with the error's message as its line in the short summary."""
    shown = excinfo.getrepr(style="native")
    shown.reprtraceback.reprentries = shown.reprtraceback.reprentries[:1]
    shown.reprtraceback.reprentries[0].lines = [text + "\n"]
    if shown.reprcrash is not None:
        shown.reprcrash.message = str(excinfo.value).splitlines()[0]
    if hasattr(shown, "chain"):
        shown.chain = shown.chain[-1:]
    return shown


def _properties(result: "ItemResult") -> list[tuple[str, object]]:
    rate, facts = result.rate, {"category": result.item.category}
    low = rate.value if rate.low is None else rate.low
    figures = {"rate": round(rate.value, 4), "wilson_low": round(low, 4), "T*": result.steps, "K": result.budget}
    return [*facts.items(), *figures.items()]
