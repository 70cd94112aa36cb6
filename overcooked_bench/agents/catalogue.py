"""Finds agents by name, file or behaviour: the only place that looks an agent up."""

import os
from functools import lru_cache
from typing import TYPE_CHECKING

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.agents.kinds import KINDS, RUNS_CODE, SCRIPT, Entrant
from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, is_pool, shipped_pools
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.content import ENTRY
from overcooked_bench.shelf import guess

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import Isolation
    from overcooked_bench.agents.policies.neural import Mode


def catalogue() -> list[str]:
    """Lists the names that `find` knows: scripted agents, scripts, entries, then `pool/layout/agent` of shipped pools.

    Scripts that need further keys are left out; see `find`.
    """
    from overcooked_bench.agents.behaviours.parsing import KINDS as BEHAVIOURS

    scripts = [SCRIPT + name for name, kind in BEHAVIOURS.items() if not kind.needs]
    frozen = []
    for name in shipped_pools():
        pool = Pool(find_pool(name), read_manifest(find_pool(name)))
        frozen += [f"{name}/{layout}/{agent.name}" for layout in pool.layouts for agent in pool.agents(layout)]
    return [*SCRIPTED, *scripts, *shipped_entries(), *frozen]


def find(reference: Reference, *, mode: "Mode" = "sample", isolation: "Isolation | None" = None) -> Entrant:
    """Finds an agent and says what it is, without playing it. A submission's code is executed once.

    Args:
        reference: A name of `catalogue()`; `script:` and a behaviour as scenarios write it, such as
            `script:{does: carry, insist: true}`, or that mapping itself, as text or as a Python mapping;
            `pool/layout/agent` where pool is a shipped name or a folder, and `pool/{layout}/agent` for another agent on
            each layout; a policy's `.safetensors` or `.json` file; a submission: a Python file, or a folder with
            `agent.py`; `file.py:function` if another function than `make_agent` makes the agents.
        mode: How frozen policies act: "sample" draws from their distribution, "greedy" takes the likeliest action.
        isolation: Runs a submission's code in processes of its own that see observations and return actions; None runs
            it here. Other agents run no code.

    Raises:
        AgentError: No such name or file (names the nearest), or a submission's code is at fault.
        PoolError: The pool is damaged, or has no such agent.
        PolicyError: The policy's files are broken.
        IsolationError: The processes of a submission cannot be started.
    """
    for name, kind in KINDS.items():
        if kind.fits(reference):
            if isolation is not None and name in RUNS_CODE:
                from overcooked_bench.agents.isolation.isolated import find_isolated

                return find_isolated(reference, name, isolation)
            return kind.find(reference, mode)
    raise AgentError(_unknown(str(reference)))


def runs_code(reference: Reference) -> bool:
    """Returns, without running anything, whether finding an agent runs code of a submission."""
    fits = next((name for name, kind in KINDS.items() if kind.fits(reference)), None)
    return fits in RUNS_CODE


@lru_cache(maxsize=1)
def find_unchanged(reference: str, sha256: str, mode: "Mode", isolation: "Isolation | None" = None) -> Entrant:
    """Finds an agent that was found before, once per process, and makes sure that it is still the same.

    Args:
        reference: `Entrant.reference`.
        sha256: `Entrant.sha256`.
        mode: As for `find`.
        isolation: As for `find`.

    Raises:
        AgentError: It was changed since then.
    """
    found = find(reference, mode=mode, isolation=isolation)
    if found.sha256 != sha256:
        raise AgentError(
            f"{reference}: changed while it was being played (SHA-256 {sha256[:12]}… when that began, "
            f"{found.sha256[:12]}… now); run it again, with another --output where some blocks are finished"
        )
    return found


def load_agent(reference: Reference, layout: str, training_seed: int = 0, mode: "Mode" = "sample") -> Agent:
    """Loads an agent for one layout.

    Args:
        reference: What `find` takes: a name, a path, or a behaviour mapping.
        layout: The layout's name, for a custom grid its text.
        training_seed: Which independent training run of a submission or an entry; other agents have one, whatever is
            given.
        mode: How frozen policies act: "sample" draws from their distribution, "greedy" takes the likeliest action.

    Raises:
        UnknownLayout: The agent cannot play the layout; frozen ones play the one they were trained on.
        AgentError: No such name or file (names the nearest), or a submission's code is at fault.
        PoolError: The pool is damaged, or has no such agent.
        PolicyError: The policy's files are broken.
    """
    return find(reference, mode=mode).make(layout, training_seed)


def _unknown(name: str) -> str:
    if is_pool(name):
        return f"{name} is a pool, not an agent; name one of its agents: {name}/<layout>/<agent>"
    if os.path.isdir(name):
        return f"{name}: no {ENTRY} in this folder; a submission is a Python file, or a folder with {ENTRY}"
    parts = name.rsplit("/", 2)
    if len(parts) == 3 and (near := guess(parts[0], shipped_pools(), cutoff=0.7)):
        return f"no agent named {name!r}, and no pool {parts[0]!r}; {near}`overcooked-bench list` shows all agents"
    return (
        f"no agent named {name!r}, and no such file; {guess(name, catalogue(), most=3, cutoff=0.5)}Known are "
        f"{', '.join(SCRIPTED)}; an agent is also written as {', '.join(kind.written for kind in KINDS.values())}; "
        "`overcooked-bench list` shows all names"
    )
