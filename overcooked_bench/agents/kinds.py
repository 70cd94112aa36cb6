"""The kinds of reference to an agent, one row each: how it is written, recognised and found.

Nothing else parses references. A new kind is a function here and a row in `KINDS`.
"""

import hashlib
import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from overcooked_bench.agents.agent import Agent, AgentFactory, Reference, UnknownLayout
from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.pools.lineage import Origin, origin_of
from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, is_pool
from overcooked_bench.agents.scripted import SCRIPTED, scripted_sha256
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.content import ENTRY, hash_submission
from overcooked_bench.agents.submissions.loading import MAKE_AGENT, entry_file, load_submission

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.neural import Mode
    from overcooked_bench.agents.policies.policy import Policy

SCRIPT: Final = "script:"
"""Prefix of the name of a scenario's partner; its behaviour follows, as scenarios write it (`parsing.py`)."""

ANY_LAYOUT: Final = "{layout}"
"""Replaced by the layout's name: `dev-v0/{layout}/sp-0` is another agent on each layout."""

RUNS_CODE: Final = ("submission", "function")
"""Kinds whose agents are somebody's code, which may end or block the process that it runs in."""

_NOBODY: Final = Origin("")
_POLICY_SUFFIXES: Final = (".safetensors", ".json")


@dataclass(frozen=True)
class Entrant:
    """An agent that was found.

    Attributes:
        reference: Finds the same agent from any working directory: a name, or an absolute path.
        name: What tables and folders call it.
        kind: A key of `KINDS`.
        sha256: Hash of what it is, hexadecimal: of a policy's weights, a submission's files, or a scripted agent's name
            and version.
        make: `make(layout, training_seed)` makes the agent; raises UnknownLayout if it cannot play the layout.
        training_seeds: Independent training runs, S; `make` takes 0 to S - 1. Kinds other than submissions and entries
            have one and take any.
        layout: The only layout that it plays, or None.
        origin: Where it comes from; None if nobody says, as a submission without `CODEBASE` and `PEOPLE`.
        policies: Layout -> hashes of the policies that it plays there, where it is made of several.
    """

    reference: str
    name: str
    kind: str
    sha256: str
    make: AgentFactory
    training_seeds: int = 1
    layout: str | None = None
    origin: Origin | None = None
    policies: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class Kind(NamedTuple):
    """A kind of reference.

    Attributes:
        written: An example, for messages and lists.
        fits: Whether a reference is of this kind; the first row that fits counts.
        find: Finds the agent; `mode` is how frozen policies act.
    """

    written: str
    fits: Callable[[Reference], bool]
    find: Callable[[Reference, "Mode"], Entrant]


def _scripted(reference: Reference, mode: "Mode") -> Entrant:
    name = str(reference)
    agent = SCRIPTED[name]
    sha256 = scripted_sha256(name, agent.version)
    return Entrant(name, name, "scripted", sha256, lambda layout, _: agent.factory(layout), origin=_NOBODY)


def _script(reference: Reference, mode: "Mode") -> Entrant:
    from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
    from overcooked_bench.agents.behaviours.parsing import VERSION, behaviour_from_text

    name = str(reference)
    try:
        behaviour = behaviour_from_text(name.removeprefix(SCRIPT))
    except ValueError as error:
        raise AgentError(f"{name}: {error}") from None
    sha256 = scripted_sha256(f"{name}/{VERSION}", 1)
    return Entrant(name, _plain(name), "script", sha256, lambda *_: ScriptAgent(behaviour), origin=_NOBODY)


def _behaviour(reference: Reference, mode: "Mode") -> Entrant:
    """Finds the script that a mapping, or its text in braces, stands for."""
    if not isinstance(reference, Mapping):
        return _script(f"{SCRIPT}{reference}", mode)
    try:
        text = json.dumps(dict(reference), sort_keys=True)
    except (TypeError, ValueError) as error:
        raise AgentError(f"{reference!r} is no behaviour ({error}); write one such as {{'does': 'carry'}}") from None
    return _script(SCRIPT + text, mode)


class Identity(NamedTuple):
    """What a submission is, known without running it.

    Attributes:
        path: Its file or folder.
        function: The function in it that makes agents.
        reference: `Entrant.reference`.
        name: `Entrant.name`.
        sha256: `Entrant.sha256`.
    """

    path: Path
    function: str
    reference: str
    name: str
    sha256: str


def identity_of(reference: Reference, kind: str, sha256: str | None = None) -> Identity:
    """Identifies a submission.

    Args:
        reference: The reference.
        kind: One of `RUNS_CODE`.
        sha256: Hash of its files, if it is known.

    Raises:
        AgentError: There is no such file.
    """
    file, function = _parts(reference, kind)
    entry_file(file, function)
    path = Path(file).absolute()
    name, sha256 = path.name if path.is_dir() else path.stem, sha256 or hash_submission(path)
    if kind == "function" and function != MAKE_AGENT:
        name, sha256 = f"{name}-{function}", hashlib.sha256(f"{sha256}:{function}".encode()).hexdigest()
    return Identity(path, function, f"{path}:{function}" if kind == "function" else str(path), name, sha256)


def _submission(reference: Reference, mode: "Mode") -> Entrant:
    return _loaded(reference, "submission")


def _function(reference: Reference, mode: "Mode") -> Entrant:
    return _loaded(reference, "function")


def _parts(reference: Reference, kind: str) -> tuple[str, str]:
    """Splits a reference into the path and the function."""
    file, _, function = str(reference).rpartition(":")
    return (file, function) if kind == "function" else (str(reference), MAKE_AGENT)


def _loaded(reference: Reference, kind: str) -> Entrant:
    """Finds a submission by running its code in this process."""
    submission = load_submission(*_parts(reference, kind))
    identity = identity_of(reference, kind, submission.sha256)
    return Entrant(
        *(identity.reference, identity.name, kind, identity.sha256, submission.make_agent),
        training_seeds=submission.training_seeds,
        origin=submission.origin,
    )


def _policy(reference: Reference, mode: "Mode") -> Entrant:
    from overcooked_bench.agents.policies.policy import load_policy

    name, policy = str(reference), load_policy(str(reference))
    make = _frozen(policy, name, mode)
    return Entrant(
        *(str(Path(name).absolute()), _plain(name), "policy", policy.sha256, make), layout=policy.architecture.layout
    )


def _pool_agent(reference: Reference, mode: "Mode") -> Entrant:
    name = str(reference)
    pool, layout, agent = _in_pool(name)
    policy = pool.policy(layout, agent)  # verifies this agent's files alone
    return Entrant(
        *(_anywhere(name, pool), f"{pool.name}-{layout}-{agent}", "pool agent", policy.sha256),
        make=_frozen(policy, name, mode),
        layout=policy.architecture.layout,
        origin=origin_of([pool.agent(layout, agent)]),
    )


def _pool_agents(reference: Reference, mode: "Mode") -> Entrant:
    """Finds the agents of one name, one for each layout of their pool that has it."""
    name = str(reference)
    pool, _, agent = _in_pool(name)
    found = {one.layout: one for layout in pool.layouts for one in pool.agents(layout) if one.name == agent}
    if not found:
        pool.agent(pool.layouts[0], agent)  # says which names there are
    whole = "".join(f"{layout} {found[layout].sha256}\n" for layout in sorted(found))

    def make(layout: str, training_seed: int) -> Agent:
        if layout not in found:
            raise UnknownLayout(f"the pool {pool.name} has no agent {agent!r} for {layout!r}")
        return _frozen(pool.policy(layout, agent), name, mode)(layout, training_seed)

    sha256 = hashlib.sha256(whole.encode()).hexdigest()
    origin = origin_of(found.values())
    policies = {layout: (one.sha256,) for layout, one in found.items()}
    return Entrant(
        *(_anywhere(name, pool), f"{pool.name}-{agent}", "pool agents", sha256, make), origin=origin, policies=policies
    )


def _entry(reference: Reference, mode: "Mode") -> Entrant:
    """Finds a shipped entry, whose training runs are its training seeds."""
    name, entry = str(reference), load_entry(str(reference))
    seeds = entry.training_seeds
    whole = "".join(f"{layout} {run.sha256}\n" for layout in sorted(entry.runs) for run in entry.runs[layout])

    def make(layout: str, training_seed: int) -> Agent:
        if not 0 <= training_seed < seeds:
            raise AgentError(f"{name}: no training seed {training_seed}; its {seeds} runs are 0 to {seeds - 1}")
        if layout not in entry.runs:
            raise UnknownLayout(f"the entry {name} was not trained on {layout!r}; it was on {', '.join(entry.runs)}")
        policy = entry.pool.policy(layout, entry.runs[layout][training_seed].name)
        return _frozen(policy, name, mode)(layout, training_seed)

    sha256 = hashlib.sha256(whole.encode()).hexdigest()
    origin = origin_of(run for runs in entry.runs.values() for run in runs)
    policies = {layout: tuple(run.sha256 for run in runs) for layout, runs in entry.runs.items()}
    return Entrant(name, name, "entry", sha256, make, training_seeds=seeds, origin=origin, policies=policies)


def _frozen(policy: "Policy", name: str, mode: "Mode") -> AgentFactory:
    trained_on = policy.architecture.layout

    def make(layout: str, training_seed: int) -> Agent:
        if layout != trained_on:
            raise UnknownLayout(f"{name} was trained on {trained_on!r} and cannot play {layout!r}")
        from overcooked_bench.agents.policies.neural import NeuralAgent

        return NeuralAgent(policy, mode)

    return make


def _in_pool(name: str) -> tuple[Pool, str, str]:
    """Reads the pool of a name without verifying its agents; returns layout and agent too."""
    where, layout, agent = name.rsplit("/", 2)
    folder = find_pool(where)
    return Pool(folder, read_manifest(folder)), layout, agent


def _anywhere(name: str, pool: Pool) -> str:
    where, layout, agent = name.rsplit("/", 2)
    return f"{pool.folder.absolute()}/{layout}/{agent}" if Path(where).is_dir() else name


def _plain(name: str) -> str:
    """Makes a name for tables and folders from a path or a script."""
    return re.sub(r"[^A-Za-z0-9_.]+", "-", name).strip("-.")


def _is_submission(reference: Reference) -> bool:
    path = Path(str(reference))
    return path.suffix == ".py" or _is_folder(path)


def _is_folder(path: Path) -> bool:
    return os.path.isfile(path / ENTRY)


def _is_function(reference: Reference) -> bool:
    file, _, function = str(reference).rpartition(":")
    return bool(file) and function.isidentifier() and _is_submission(file)


def _is_of_pool(reference: Reference, any_layout: bool) -> bool:
    where, *rest = str(reference).rsplit("/", 2)
    return len(rest) == 2 and (rest[0] == ANY_LAYOUT) == any_layout and is_pool(where)


KINDS: Final[dict[str, Kind]] = {
    "behaviour": Kind(
        "{does: carry, insist: true}", lambda it: isinstance(it, Mapping) or str(it).lstrip()[:1] == "{", _behaviour
    ),
    "scripted": Kind("greedy", lambda it: str(it) in SCRIPTED, _scripted),
    "entry": Kind("solo-cook", lambda it: str(it) in shipped_entries(), _entry),
    "script": Kind("script:carry", lambda it: str(it).startswith(SCRIPT), _script),
    "submission": Kind("my_agent.py, or a folder with agent.py", _is_submission, _submission),
    "function": Kind("my_agent.py:make_other", _is_function, _function),
    "policy": Kind("policy.safetensors", lambda it: Path(str(it)).suffix in _POLICY_SUFFIXES, _policy),
    "pool agents": Kind("pool/{layout}/agent", lambda it: _is_of_pool(it, any_layout=True), _pool_agents),
    "pool agent": Kind("pool/layout/agent", lambda it: _is_of_pool(it, any_layout=False), _pool_agent),
}
"""Every kind of reference, by name."""
