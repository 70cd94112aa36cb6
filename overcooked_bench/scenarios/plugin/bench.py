"""Holds the agent that a pytest session tests, and its results so far."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest

from overcooked_bench.agents.agent import AgentFactory, UnknownLayout
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.isolation.settings import isolate
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.files import read_text
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import Item
from overcooked_bench.scenarios.results import ItemResult
from overcooked_bench.scenarios.runner import REPEATS, run_items
from overcooked_bench.scenarios.shown.comparing import MOST_BYTES, read_report

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.neural import Mode

ACT_TIMEOUT: Final = 60.0
"""Seconds that one call of an isolated agent's `act` may take."""
_FIRST_LAYOUT: Final = "cramped_room"


@dataclass
class Bench:
    """The tested agent, and the results of the items that were played.

    Attributes:
        agent: Its name on the command line.
        make_agent: Makes it.
        mode: How frozen policies act.
        repeats: Runs of each situation.
        training_seed: Which training run is tested.
        warmup: How often the first observation is shown before the start.
        known: Reasons for known failures, by item id or pattern.
        baseline: The items of an older report.
        report: Where to write one.
        isolated: How well the agent is isolated, or None.
    """

    agent: str
    make_agent: AgentFactory
    mode: "Mode"
    repeats: int
    training_seed: int
    warmup: int
    known: dict[str, str]
    baseline: list[dict[str, Any]] | None
    report: Path | None
    isolated: str | None = None
    _outcomes: dict[str, ItemResult | Exception] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """Describes the tested agent and the settings."""
        apart = "" if self.isolated is None else f", isolation {self.isolated}"
        return f"{self.agent}, mode {self.mode}, {self.repeats} repeats{apart}"

    @property
    def settings(self) -> dict[str, Any]:
        """The settings of the runs, as reports contain them."""
        played = {"mode": self.mode, "repeats": self.repeats, "training_seed": self.training_seed}
        return {"agent": self.agent, **played, "warmup": self.warmup, "sequential": False}

    @property
    def replay_settings(self) -> dict[str, Any]:
        """The options of the command that replays a run."""
        return {"mode": self.mode, "training_seed": self.training_seed, "warmup": self.warmup}

    def expected(self, item: str) -> str | None:
        """Returns why an item is known to fail, or None if it is not."""
        return next((reason for name, reason in self.known.items() if fnmatchcase(item, name)), None)

    def result(self, item: Item, others: Iterable[Item]) -> ItemResult:
        """Returns an item's result; the first request plays all items of its kitchen together.

        Raises:
            Exception: Any error of the run; an OvercookedBenchError or OSError needs no traceback.
        """
        if item.id not in self._outcomes:
            together = {other.id: other for other in others if other.kitchen == item.kitchen}
            self._play([other for name, other in sorted({**together, item.id: item}.items())])
        outcome = self._outcomes[item.id]
        if isinstance(outcome, Exception):
            raise outcome
        return outcome

    def play(self, items: list[Item]) -> list[ItemResult]:
        """Plays items at once."""
        return run_items(self.make_agent, items, self.repeats, training_seed=self.training_seed, warmup=self.warmup)

    def _play(self, items: list[Item]) -> None:
        """Plays items together; if that fails, one by one, so that each gets its own result."""
        try:
            for result in self.play(items):
                self._outcomes[result.item.id] = result
        except (OvercookedBenchError, OSError) as error:
            if len(items) == 1:
                self._outcomes[items[0].id] = error
                return
            for item in items:
                self._play([item])


def open_bench(config: pytest.Config) -> Bench:
    """Loads the agent and the files that the command line names.

    Raises:
        pytest.UsageError: One of them cannot be used; says what to write instead.
    """
    option = config.option
    repeats = REPEATS if option.ocb_repeats is None else option.ocb_repeats
    for name, value, least in (("--repeats", repeats, 1), ("--agent-warmup", option.ocb_agent_warmup, 0)):
        if value < least:
            raise pytest.UsageError(f"{name} {value}: give a whole number from {least}")
    if option.ocb_fuzz is not None:
        _check_fuzz(option.ocb_fuzz)
    try:
        isolation = isolate(option.ocb_isolate, ACT_TIMEOUT) if option.ocb_isolate else None
        make_agent = find(option.ocb_agent, mode=option.ocb_mode, isolation=isolation).make
        if not hasattr(config, "workerinput"):
            _try(make_agent, option.ocb_agent_training_seed)
        known = read_known(option.ocb_known_failures) if option.ocb_known_failures else {}
        baseline = read_report(option.ocb_scenario_baseline)["items"] if option.ocb_scenario_baseline else None
    except (OvercookedBenchError, OSError) as error:
        raise pytest.UsageError(str(error)) from None
    return Bench(
        agent=option.ocb_agent,
        make_agent=make_agent,
        mode=option.ocb_mode,
        repeats=repeats,
        training_seed=option.ocb_agent_training_seed,
        warmup=option.ocb_agent_warmup,
        known=known,
        baseline=baseline,
        report=Path(option.ocb_scenario_report) if option.ocb_scenario_report else None,
        isolated=isolation.short if isolation else None,
    )


def _check_fuzz(kitchens: int) -> None:
    if kitchens < 1:
        raise pytest.UsageError(f"--fuzz {kitchens}: give a whole number of kitchens from 1")
    if find_spec("hypothesis") is None:
        raise pytest.UsageError("--fuzz needs hypothesis: pip install 'overcooked-bench[fuzz]'")


def _try(make_agent: AgentFactory, training_seed: int) -> None:
    """Makes an agent once, so that an agent that cannot be made is reported before anything is played."""
    try:
        make_agent(_FIRST_LAYOUT, training_seed)
    except UnknownLayout:
        return


def read_known(path: str) -> dict[str, str]:
    """Reads the ids of known failures, one per line, with a reason after a #."""
    text = read_text(path, MOST_BYTES, raises=ScenarioError)
    found: dict[str, str] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        name, _, reason = (part.strip() for part in line.partition("#"))
        if len(name.split()) > 1:
            raise ScenarioError(f"{path}:{number}: {name!r}; write one item's id per line, and a reason after a #")
        if name:
            found[name] = reason or "known failure"
    return found
