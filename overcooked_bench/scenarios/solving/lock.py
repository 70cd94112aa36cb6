"""`scenarios.lock`: shortest solutions and budgets, found by search and kept in the scenarios' folder."""

import json
from collections.abc import Callable, Iterable
from functools import lru_cache
from hashlib import sha256
from math import ceil
from pathlib import Path
from typing import Annotated, Final

import msgspec

from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.codes import ACTION_LETTERS
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import read_files, shipped_folder
from overcooked_bench.scenarios.language.loading import MOST_STEPS
from overcooked_bench.scenarios.scenario import SEATS, Scenario, Situation

LOCK_FILE: Final = "scenarios.lock"
VERSION: Final = 1
MOST_BYTES: Final = 4 << 20
"""Of a lock file; one scenario takes about 400."""

Steps = Annotated[int, msgspec.Meta(ge=0, le=MOST_STEPS)]
"""A number of steps that a scenario can have."""

_SOLVED: Final[dict[str, "Entry"]] = {}  # by definition: what was searched in this process


class Witness(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A shortest solution from one seat in one mirror.

    Attributes:
        steps: Its length, T*.
        actions: A's actions, one letter of `ACTION_LETTERS` each.
    """

    steps: Steps
    actions: Annotated[str, msgspec.Meta(pattern=rf"\A[{ACTION_LETTERS}]*\Z", max_length=MOST_STEPS)]

    @property
    def own(self) -> tuple[int, ...]:
        """A's actions."""
        return tuple(ACTION_LETTERS.index(letter) for letter in self.actions)


class Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A scenario's solutions and budget.

    Attributes:
        definition: Hash of what the solutions depend on.
        steps: T*, the greatest over seats and mirrors.
        budget: Steps that A has.
        witnesses: By "seat0", "seat0-mirrored", "seat1", "seat1-mirrored".
    """

    definition: str
    steps: Steps
    budget: Steps
    witnesses: dict[str, Witness]


class Lock(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A lock file.

    Attributes:
        version: Version of the file format.
        scenarios: Entries by id.
    """

    version: int = VERSION
    scenarios: dict[str, Entry] = {}

    def entry(self, scenario: Scenario) -> Entry | None:
        """Returns a scenario's entry; None if there is none, or if no search could have written it."""
        found = self.scenarios.get(scenario.id)
        return found if found and found.definition == definition(scenario) and _consistent(found, scenario) else None


def budget_for(category: str, steps: int) -> int:
    """Returns the budget of a scenario whose shortest solution takes this many steps."""
    return steps + 1 if category == "horizon" else ceil(1.5 * steps) + 4


def definition(scenario: Scenario) -> str:
    """Returns a hash of all that a scenario's solutions and budget depend on."""
    return _definition(scenario)


@lru_cache(1024)
def _definition(scenario: Scenario) -> str:
    layout = scenario.layout
    told = [
        *(layout.rows, layout.orders, layout.cook_times, layout.soup_rewards, scenario.cooking, scenario.category),
        *(scenario.state.to_dict(), scenario.drawn, str(scenario.accept), str(scenario.never), scenario.budget),
        scenario.before,
    ]
    return sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:16]


def situations(scenario: Scenario) -> dict[str, Situation]:
    """Returns a scenario from both seats, plain and mirrored, by the names that the lock file uses."""
    return {
        f"seat{seat}" + "-mirrored" * mirrored: scenario.seated(seat, mirrored)
        for seat in SEATS
        for mirrored in (False, True)
    }


def lock_path(scenario: Scenario) -> Path:
    """Returns a scenario's lock file, which is in the same folder."""
    return Path(scenario.source).parent / LOCK_FILE


def read_lock(path: str | Path) -> Lock:
    """Reads a lock file; returns an empty lock if there is no file.

    Raises:
        ScenarioError: The file is damaged.
    """
    file = Path(path)
    if not file.is_file():
        return Lock()
    return _read(file, file.stat().st_mtime_ns)


@lru_cache(8)
def _read(file: Path, changed: int) -> Lock:
    try:
        lock = read_json(file, MOST_BYTES, Lock)
    except WrongUse as error:
        raise ScenarioError(f"{error}; the lock file is damaged: delete it, and it is written again") from None
    if lock.version != VERSION:
        raise ScenarioError(f"{file}: written in version {lock.version} of its form, and this is {VERSION}; delete it")
    return lock


def _consistent(entry: Entry, scenario: Scenario) -> bool:
    """Returns whether the numbers of an entry fit each other and the scenario."""
    lengths = [witness.steps for witness in entry.witnesses.values()]
    return (
        entry.witnesses.keys() == situations(scenario).keys()
        and lengths == [len(witness.actions) for witness in entry.witnesses.values()]
        and entry.steps == max(lengths)
        and entry.budget == (scenario.budget or budget_for(scenario.category, entry.steps))
    )


@lru_cache(1024)
def _proved(scenario: Scenario, actions: tuple[tuple[int, ...], ...]) -> bool:
    """Returns whether each solution of an entry reaches the goal at its last step; plays them."""
    from overcooked_bench.scenarios.judge import judge

    each = zip(situations(scenario).values(), actions, strict=True)
    return all(judge(situation, len(own), own).reached == len(own) for situation, own in each)


def write_lock(
    path: str | Path,
    scenarios: Iterable[Scenario],
    on_entry: Callable[[Scenario, Entry], None] = lambda *_: None,
    *,
    afresh: bool = False,
) -> Lock:
    """Updates a lock file: solves new and changed scenarios, drops removed ones, and keeps the rest.

    Args:
        path: The file.
        scenarios: All scenarios that belong in it.
        on_entry: Called with each scenario and its entry.
        afresh: Whether to solve everything again.

    Raises:
        ScenarioError: A scenario cannot be solved from some seat or in some mirror; nothing is written then.
    """
    file = Path(path)
    old = Lock() if afresh else read_lock(file)
    entries: dict[str, Entry] = {}
    for scenario in sorted(scenarios, key=lambda s: s.id):
        entries[scenario.id] = old.entry(scenario) or solve_scenario(scenario)
        on_entry(scenario, entries[scenario.id])
    lock = Lock(VERSION, entries)
    write_whole(file, lock_text(lock))
    return lock


def lock_text(lock: Lock) -> str:
    """Writes a lock as JSON, sorted, one witness per line, so that diffs are easy to read."""
    blocks = []
    for name, entry in sorted(lock.scenarios.items()):
        witnesses = ",\n".join(
            f"        {json.dumps(key)}: {json.dumps(msgspec.to_builtins(witness))}"
            for key, witness in sorted(entry.witnesses.items())
        )
        facts = f'"definition": "{entry.definition}", "steps": {entry.steps}, "budget": {entry.budget}'
        blocks.append(f'    {json.dumps(name)}: {{\n      {facts}, "witnesses": {{\n{witnesses}\n      }}\n    }}')
    inside = ",\n".join(blocks)
    return f'{{\n  "version": {lock.version},\n  "scenarios": {{\n{inside}\n  }}\n}}\n'


def solve_scenario(scenario: Scenario) -> Entry:
    """Searches the shortest solutions of a scenario.

    Raises:
        ScenarioError: There is none within `LONGEST` steps, or within the budget that the file gives.
    """
    from overcooked_bench.scenarios.solving.search import TooManyStates
    from overcooked_bench.scenarios.solving.solver import LONGEST, solve

    limit = scenario.budget or LONGEST
    witnesses: dict[str, Witness] = {}
    for key, situation in situations(scenario).items():
        try:
            found = solve(situation, limit)
        except TooManyStates as error:
            raise ScenarioError(f"{scenario.source}: {scenario.id} cannot be solved: {error}") from None
        if found is None:
            raise ScenarioError(
                f"{scenario.source}: {scenario.id} cannot be solved from {key.replace('-', ', ')} in {limit} steps; "
                "change the kitchen, B's behaviour, or the condition"
            )
        witnesses[key] = Witness(found.steps, "".join(ACTION_LETTERS[action] for action in found.actions))
    steps = max(witness.steps for witness in witnesses.values())
    return Entry(definition(scenario), steps, scenario.budget or budget_for(scenario.category, steps), witnesses)


def entry_of(scenario: Scenario) -> Entry:
    """Returns a scenario's entry: from the lock file in its folder, or else by a search, which takes seconds.

    Raises:
        ScenarioError: The lock file is damaged, or the scenario cannot be solved.
    """
    return known_entry(scenario) or _solved(scenario)


def known_entry(scenario: Scenario) -> Entry | None:
    """Returns a scenario's entry if the lock file has it, or it was searched before; else None.

    The solutions of a lock file that does not ship with the package are played once before they are trusted.

    Raises:
        ScenarioError: The lock file is damaged.
    """
    path = lock_path(scenario)
    found = read_lock(path).entry(scenario)
    if found and path.parent != shipped_folder():
        own = tuple(found.witnesses[key].own for key in situations(scenario))
        found = found if _proved(scenario, own) else None
    return found or _SOLVED.get(definition(scenario))


def budget_of(scenario: Scenario) -> int:
    """Returns the steps that A has: the file's number, or else that of `entry_of`."""
    return scenario.budget or entry_of(scenario).budget


def _solved(scenario: Scenario) -> Entry:
    return _SOLVED.setdefault(definition(scenario), solve_scenario(scenario))


def unused(lock: Lock, scenarios: Iterable[Scenario]) -> list[str]:
    """Lists the ids of a lock that no scenario has any more."""
    return sorted(set(lock.scenarios) - {scenario.id for scenario in scenarios})


def stale(lock: Lock, scenarios: Iterable[Scenario]) -> list[str]:
    """Lists the ids of scenarios that a lock does not contain, or contains with another definition."""
    return sorted(scenario.id for scenario in scenarios if lock.entry(scenario) is None)


def main() -> None:
    """Updates the lock file of the scenarios that ship."""
    folder = shipped_folder()
    write_lock(folder / LOCK_FILE, read_files([folder]), lambda s, entry: print(s.id, entry.steps, entry.budget))


if __name__ == "__main__":
    main()
