"""`submission.yaml`: who submits what, how it was trained, and with which data.

All mistakes of a file are listed at once, each with its line and what to write instead.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.agents.pools.pool import shipped_pools
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.agents.submissions.loading import MOST_TRAINING_SEEDS
from overcooked_bench.documents import LONGEST, Document, DocumentError, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import NAME, read_text, shown
from overcooked_bench.leaderboard.submission.names import path_problem
from overcooked_bench.shelf import guess

MANIFEST: Final = "submission.yaml"
SCHEMA: Final = 1
_MOST_STEPS: Final = 10**15
_MOST_RUNS: Final = 10**6


class SubmissionError(WrongUse):
    """A submission cannot be read, packed or unpacked; the message says what to do about it."""


class Manifest(msgspec.Struct, frozen=True, kw_only=True):
    """What a submission says of itself.

    Attributes:
        schema: Version of this format.
        name: The submission's name in tables.
        contact: An e-mail address or a link.
        licence: SPDX identifier of the licence of code and weights.
        link: A page about it; None if there is none.
        commit: Full hash of the commit of the training code; None if the code is not public.
        method: How the agents were trained, one line.
        joint_steps: Environment steps of one training run (one training seed) over all layouts; both chefs acting once
            are one step.
        partner_runs: Number of training runs that produced its training partners; 0 if there were none.
        human_data: Whether recorded games of people were used, for the agents or for their training partners.
        training_pools: Public pools whose agents it trained with.
        selection_pools: Public pools that runs, checkpoints or settings were chosen with.
        observation: What its agents observe.
        training_seeds: Number of independent training runs; equal to `TRAINING_SEEDS` in agent.py.
        pledge: That all this is true, and that no other pool that scores it was used.
    """

    schema: int
    name: str
    contact: str
    licence: str
    link: str | None
    commit: str | None
    method: str
    joint_steps: int
    partner_runs: int
    human_data: bool
    training_pools: tuple[str, ...]
    selection_pools: tuple[str, ...]
    observation: str
    training_seeds: int
    pledge: bool

    def used(self, pool: str) -> bool:
        """Returns whether agents were trained or selected with a pool."""
        return pool in self.training_pools or pool in self.selection_pools


def load_manifest(file: str | Path) -> Manifest:
    """Reads a submission.yaml.

    Raises:
        SubmissionError: It cannot be read, or something in it is wrong; one line for each mistake.
    """
    manifest, problems = parse_manifest(read_text(file, LONGEST, raises=SubmissionError), str(file))
    if manifest is None:
        raise SubmissionError("\n".join(problems))
    return manifest


def parse_manifest(text: str, where: str = MANIFEST) -> tuple[Manifest | None, list[str]]:
    """Parses a submission.yaml.

    Args:
        text: Its content.
        where: The file's name, for messages.

    Returns:
        The manifest, None if anything is wrong; and every mistake with its line and what to write instead.
    """
    try:
        document = parse_yaml(text, where)
    except DocumentError as error:
        return None, [str(error)]
    schema = document.data.get("schema")
    if type(schema) is int and schema > SCHEMA:
        newer = f"`schema` is {schema}; this version of overcooked-bench reads {SCHEMA}, so update it"
        return None, [str(document.error(("schema",), newer))]
    problems = [_unknown(document, key) for key in document.data if key not in _KEYS]
    problems += [problem for key in _KEYS if (problem := _problem(document, key))]
    if problems:
        return None, sorted(problems, key=_line)
    return msgspec.convert(document.data, Manifest), []


class _Key(NamedTuple):
    """What a key may hold.

    Attributes:
        kind: Its type.
        fits: Whether a value of that type is possible.
        write: What to write.
    """

    kind: Any
    fits: Callable[[Any], bool]
    write: str


def _is_name(text: str) -> bool:
    taken = {name.lower() for name in (*SCRIPTED, *shipped_entries())}
    return re.fullmatch(NAME, text) is not None and not path_problem(text) and text.lower() not in taken


def _is_line(text: str) -> bool:
    return 3 <= len(text.strip()) <= 200 and text.isprintable()


def _is_contact(text: str) -> bool:
    return _is_line(text) and (re.fullmatch(r"[^\s@]+@[^\s@]+", text) is not None or _is_link(text))


def _is_link(text: str | None) -> bool:
    return text is None or (re.fullmatch(r"https?://[^\s\"'<>\\]{1,300}", text) is not None and text.isprintable())


def _is_commit(text: str | None) -> bool:
    return text is None or re.fullmatch("[0-9a-f]{40}|[0-9a-f]{64}", text) is not None


def _are_pools(names: tuple[str, ...]) -> bool:
    return len(set(names)) == len(names) and set(names) <= set(shipped_pools())


def _is_observation(name: str) -> bool:
    from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

    return name in (*OBSERVATIONS, "state")


def _is_from(least: int, most: int) -> Callable[[int], bool]:
    return lambda number: least <= number <= most


_KEYS: Final[dict[str, _Key]] = {
    "schema": _Key(int, lambda number: number == SCHEMA, f"`schema: {SCHEMA}`"),
    "name": _Key(
        str,
        _is_name,
        "a name of at most 100 letters, digits and . _ -, beginning with a letter or digit, that no shipped agent has, "
        "such as `name: my-agent`",
    ),
    "contact": _Key(str, _is_contact, "an e-mail address or a link by which you can be reached"),
    "licence": _Key(
        str,
        lambda text: re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9.+() -]{1,99}", text) is not None,
        "the SPDX identifier of the licence of your code and weights, such as `licence: MIT`",
    ),
    "link": _Key(str | None, _is_link, "the address of a page about it, beginning with https://, or null"),
    "commit": _Key(
        str | None,
        _is_commit,
        "the full hash of the training code's commit, 40 or 64 hexadecimal digits in quotes, or null",
    ),
    "method": _Key(str, _is_line, "in one line of 3 to 200 characters how the agents were trained"),
    "joint_steps": _Key(
        int,
        _is_from(0, _MOST_STEPS),
        "how many environment steps one training seed took over all layouts, such as `joint_steps: 5000000`; 0 if "
        "nothing was trained",
    ),
    "partner_runs": _Key(
        int, _is_from(0, _MOST_RUNS), "how many training runs produced its training partners; 0 if there were none"
    ),
    "human_data": _Key(bool, lambda _: True, "true if recorded games of people were used anywhere, else false"),
    "training_pools": _Key(
        tuple[str, ...], _are_pools, "the shipped pools whose agents it trained with, such as [train-v1]; [] for none"
    ),
    "selection_pools": _Key(
        tuple[str, ...],
        _are_pools,
        "the shipped pools that runs, checkpoints or settings were chosen with, such as [dev-v1]; [] for none",
    ),
    "observation": _Key(str, _is_observation, "the observation of your agents"),
    "training_seeds": _Key(
        int,
        _is_from(1, MOST_TRAINING_SEEDS),
        f"the number of independent training runs, from 1 to {MOST_TRAINING_SEEDS}; agent.py says it as TRAINING_SEEDS",
    ),
    "pledge": _Key(
        bool,
        lambda given: given is True,
        "`pledge: true` if all of this file is true and no other pool that scores it was trained or selected with",
    ),
}


def _problem(document: Document, key: str) -> str:
    """Returns what is wrong with a key; an empty text if nothing is."""
    expected = _KEYS[key]
    if key not in document.data:
        return str(document.error((), f"missing key `{key}`; write {expected.write}"))
    given = document.data[key]
    try:
        if expected.fits(msgspec.convert(given, expected.kind)):
            return ""
    except msgspec.ValidationError:
        pass
    as_written = {True: "true", False: "false", None: "null"}.get(given) if type(given) in (bool, type(None)) else None
    what = as_written or shown(repr(given))
    return str(document.error((key,), f"`{key}` is {what}; write {expected.write}{_choices(key, given)}"))


def _choices(key: str, given: object) -> str:
    """Returns which names there are, where a key wants one of them, with a guess."""
    if key == "observation":
        from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

        known: tuple[str, ...] = (*OBSERVATIONS, "state")
    elif key in ("training_pools", "selection_pools"):
        known = shipped_pools()
    else:
        return ""
    wrong = [name for name in given if name not in known] if isinstance(given, list) else [given]
    near = guess(wrong[0], known) if wrong else ""
    return f"; {near}choose from {', '.join(known)}"


def _unknown(document: Document, key: object) -> str:
    near = guess(key, _KEYS)
    return str(document.error((str(key),), f"unknown key `{shown(key)}`; {near}remove it, keys are {', '.join(_KEYS)}"))


def _line(problem: str) -> int:
    found = re.search(r":(\d+): ", problem)
    return int(found[1]) if found else 0
