"""`Entrant`: who is scored."""

import hashlib
import re
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.loading import ENTRY, Submission, load_submission

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy


class Entrant(NamedTuple):
    """An agent to be scored.

    Attributes:
        reference: Catalogue name or absolute path, for `agent_maker`.
        name: What tables and folders call it.
        sha256: Hash of what it is: a frozen policy's weights, a submission's files, a scripted agent's name.
        training_seeds: Independent training runs, S.
        layout: The only layout that it knows, or None.
    """

    reference: str
    name: str
    sha256: str
    training_seeds: int = 1
    layout: str | None = None


def identify(agent: str | Path) -> Entrant:
    """Finds an agent and says what it is, without playing it.

    Args:
        agent: A catalogue name, a script, `pool/layout/agent`, or the path of a submission or of a policy's file.

    Raises:
        AgentError: No such agent, or a submission that cannot be loaded.
        PoolError: A damaged pool.
        PolicyError: A damaged policy.
    """
    from overcooked_bench.agents.behaviours.parsing import VERSION
    from overcooked_bench.agents.catalogue import SCRIPT, load_agent
    from overcooked_bench.agents.scripted import SCRIPTED

    name, path = str(agent), Path(agent)
    if name in SCRIPTED:
        return Entrant(name, name, scripted_hash(name))
    if name.startswith(SCRIPT):
        load_agent(name, "")
        return Entrant(name, re.sub(r"\W+", "-", name).strip("-"), scripted_hash(f"{name}/{VERSION}"))
    if is_submission(path):
        submission = load_submission(path)
        return Entrant(str(path.absolute()), submission.name, submission.sha256, submission.training_seeds)
    policy = _frozen(name)
    if policy is None:
        load_agent(name, "")  # says why there is no such agent
        raise AssertionError(f"{name} was loaded after all")
    reference = str(path.absolute()) if path.parent.is_dir() else name
    return Entrant(reference, name.replace("/", "-"), policy.sha256, layout=policy.architecture.layout)


def agent_maker(reference: str, sha256: str, mode: str) -> Callable[[str, int], Agent]:
    """Gives `make(layout, training_seed)`, which makes the agent anew.

    A submission is imported once a process and its `make_agent` called for every block, so that no block depends on
    what was played before.

    Args:
        reference: `Entrant.reference`.
        sha256: `Entrant.sha256`: what the agent has to be still.
        mode: How a frozen policy acts.

    Raises:
        AgentError: What lies there has another hash.
    """
    from overcooked_bench.agents.catalogue import load_agent
    from overcooked_bench.agents.scripted import SCRIPTED

    if reference not in SCRIPTED and is_submission(Path(reference)):
        return _submission(reference, sha256).make_agent
    _check_hash(reference, identify(reference).sha256, sha256)
    return lambda layout, training_seed: load_agent(reference, layout, training_seed, mode)  # type: ignore[arg-type]


def scripted_hash(name: str) -> str:
    """Gives what stands for a scripted agent where others have a hash of their weights."""
    from overcooked_bench.agents.scripted import BEHAVIOUR

    return hashlib.sha256(f"scripted/{name}/{BEHAVIOUR}".encode()).hexdigest()


def is_submission(path: Path) -> bool:
    """Tells whether a path looks like a submission: a Python file, or a folder with `agent.py`."""
    return path.suffix == ".py" or (path / ENTRY).is_file()


@lru_cache(maxsize=1)
def _submission(path: str, sha256: str) -> Submission:
    submission = load_submission(path)
    _check_hash(path, submission.sha256, sha256)
    return submission


def _check_hash(reference: str, found: str, expected: str) -> None:
    if found != expected:
        raise AgentError(
            f"{reference}: changed while it was being scored (SHA-256 {expected[:12]}… when the score began, "
            f"{found[:12]}… now); score it again, with another --output where some blocks are finished"
        )


def _frozen(name: str) -> "Policy | None":
    from overcooked_bench.agents.policies.policy import load_policy
    from overcooked_bench.agents.pools.manifest import MANIFEST, read_manifest
    from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools

    if name.endswith((".safetensors", ".json")):
        return load_policy(name)
    parts = name.rsplit("/", 2)
    if len(parts) < 3 or not (parts[0] in shipped_pools() or (Path(parts[0]) / MANIFEST).is_file()):
        return None
    folder = find_pool(parts[0])
    return Pool(folder, read_manifest(folder)).policy(parts[1], parts[2])
