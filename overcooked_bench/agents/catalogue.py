"""From names and files to agents."""

import difflib
from pathlib import Path
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.agent import Agent, UnknownLayout
from overcooked_bench.agents.pools.manifest import MANIFEST, read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools
from overcooked_bench.agents.scripted import SCRIPTED, make_scripted
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.loading import ENTRY, load_submission

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.neural import Mode
    from overcooked_bench.agents.policies.policy import Policy

SCRIPT: Final = "script:"
"""What the name of a scenario's partner begins with; its behaviour follows, as scenarios write it (`parsing.py`)."""

_POLICY_SUFFIXES = (".safetensors", ".json")


def catalogue() -> list[str]:
    """Lists the names that `load_agent` knows: scripted agents, then `pool/layout/agent` of the shipped pools.

    Of the partners of scenarios, those that need to be told nothing: more can be named, see `load_agent`.
    """
    from overcooked_bench.agents.behaviours.parsing import KINDS

    scripts = [SCRIPT + name for name, kind in KINDS.items() if not kind.needs]
    frozen = []
    for name in shipped_pools():
        pool = Pool(find_pool(name), read_manifest(find_pool(name)))
        frozen += [f"{name}/{layout}/{agent.name}" for layout in pool.layouts for agent in pool.agents(layout)]
    return [*SCRIPTED, *scripts, *frozen]


def load_agent(name_or_path: str | Path, layout: str, training_seed: int = 0, mode: "Mode" = "sample") -> Agent:
    """Gives an agent for one layout.

    Args:
        name_or_path: A name of `catalogue()`; `script:` and a behaviour as scenarios write it, such as
            `script:{does: carry, insist: true}`; `pool/layout/agent` where pool is a folder; a policy's `.safetensors`
            or `.json` file; or a submission: a Python file, or a folder with `agent.py`.
        layout: The layout's name, for a custom grid its text.
        training_seed: Which of a submission's independent training runs; others have one, whatever is given.
        mode: Of frozen policies: "sample" draws from their distribution, "greedy" takes the likeliest action.

    Raises:
        UnknownLayout: The agent cannot play the layout; frozen ones play the one they were trained on.
        AgentError: No such name or file (says the nearest names), or a submission's code is at fault.
        PoolError: The pool is damaged, or has no such agent.
        PolicyError: The policy's files are broken.
    """
    name, path = str(name_or_path), Path(name_or_path)
    if name in SCRIPTED:
        return make_scripted(name, layout)
    if name.startswith(SCRIPT):
        return _script(name)
    if path.suffix == ".py" or (path / ENTRY).is_file():
        return load_submission(path).make_agent(layout, training_seed)
    if path.suffix in _POLICY_SUFFIXES:
        from overcooked_bench.agents.policies.policy import load_policy

        return _frozen(load_policy(path), name, layout, mode)
    parts = name.rsplit("/", 2)
    if len(parts) == 3 and (parts[0] in shipped_pools() or (Path(parts[0]) / MANIFEST).is_file()):
        folder = find_pool(parts[0])
        policy = Pool(folder, read_manifest(folder)).policy(parts[1], parts[2])  # verifies this agent's files alone
        return _frozen(policy, name, layout, mode)
    raise AgentError(_unknown(name, path))


def _script(name: str) -> Agent:
    from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
    from overcooked_bench.agents.behaviours.parsing import behaviour_from_text

    try:
        return ScriptAgent(behaviour_from_text(name.removeprefix(SCRIPT)))
    except ValueError as error:
        raise AgentError(f"{name}: {error}") from None


def _frozen(policy: "Policy", name: str, layout: str, mode: "Mode") -> Agent:
    trained_on = policy.architecture.layout
    if layout != trained_on:
        raise UnknownLayout(f"{name} was trained on {trained_on!r} and cannot play {layout!r}")
    from overcooked_bench.agents.policies.neural import NeuralAgent

    return NeuralAgent(policy, mode)


def _unknown(name: str, path: Path) -> str:
    if (path / MANIFEST).is_file() or name in shipped_pools():
        return f"{name} is a pool, not an agent; name one of its agents: {name}/<layout>/<agent>"
    if path.is_dir():
        return f"{path}: no {ENTRY} in this folder; a submission is a Python file, or a folder with {ENTRY}"
    names = catalogue()
    near = difflib.get_close_matches(name, names, n=3, cutoff=0.5)
    hint = f"did you mean {' or '.join(map(repr, near))}? " if near else ""
    return (
        f"no agent named {name!r}, and no such file; {hint}Known are {', '.join(SCRIPTED)}, scripts (script:carry), "
        "the frozen agents (pool/layout/agent; `overcooked-bench list` shows them all), a .py file, or a folder with "
        "agent.py"
    )
