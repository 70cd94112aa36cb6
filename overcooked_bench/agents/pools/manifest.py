"""A pool's manifest: what each agent is, how it came to be, and the hashes of its files."""

import hashlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final, Literal

import msgspec

from overcooked_bench.agents.pools.records import AgentRecord, HashedFile, Manifest, PoolAgent, PoolFiles
from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import FileError, check_name, read_regular, write_whole
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import guess

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

FORMAT: Final = 2
"""What is written. Format 1, without configuration, checkpoint and profile, is read too."""

MANIFEST: Final = "manifest.json"
MOST_BYTES: Final = 64 << 20
"""Of a manifest, and of each of an agent's files."""


class PoolError(WrongUse):
    """A pool is missing, damaged or not what its manifest says; the message names the agent and the file."""


def read_manifest(folder: Path) -> Manifest:
    """Reads a manifest and checks it by itself, without looking at the agents' files.

    Raises:
        PoolError: It is missing or broken; names the entry.
    """
    file = folder / MANIFEST
    manifest = read_json(file, MOST_BYTES, Manifest, PoolError)
    _check(manifest, file)
    if manifest.hash != pool_hash(manifest):
        raise PoolError(
            f"{file}: its hash does not match its entries, so one of them was changed; restore the file, or make a new "
            "pool with write_manifest"
        )
    return manifest


def write_manifest(
    folder: str | Path,
    name: str,
    agents: Sequence[AgentRecord],
    cooking: Literal["auto", "manual"] = "auto",
    mode: Literal["sample", "greedy"] = "sample",
) -> Manifest:
    """Hashes the agents' files and writes `manifest.json`.

    Args:
        folder: The pool's; each agent's pair of files already lies at `<layout>/<name>`.
        name: The pool's name.
        agents: The entries without their files.
        cooking: Cooking mode of all agents.
        mode: How all agents' actions are chosen.

    Returns:
        What was written.

    Raises:
        PoolError: A file is missing, or an entry is not as it should be; nothing is written.
    """
    folder = Path(folder)

    entries = tuple(_with_files(agent, folder) for agent in sorted(agents, key=_order))
    manifest = Manifest(format=FORMAT, name=name, cooking=cooking, mode=mode, hash="", agents=entries)
    try:  # as it will be read: an int in a float's place would be hashed differently
        manifest = msgspec.json.decode(msgspec.json.encode(manifest), type=Manifest)
    except (msgspec.ValidationError, TypeError) as error:
        raise PoolError(f"pool {name!r}: {error}") from None
    manifest = msgspec.structs.replace(manifest, hash=pool_hash(manifest))
    _check(manifest, folder / MANIFEST)
    for agent in entries:
        check_files(folder, manifest, agent)
        check_policy(folder, manifest, agent)
    write_whole(folder / MANIFEST, msgspec.json.format(msgspec.json.encode(manifest), indent=2) + b"\n")
    return manifest


def pool_hash(manifest: Manifest) -> str:
    """Computes the pool's SHA-256: of the manifest without its hash, agents sorted by layout and name, keys sorted."""
    agents = tuple(sorted(manifest.agents, key=_order))
    return _sha256(msgspec.json.encode(msgspec.structs.replace(manifest, hash="", agents=agents), order="sorted"))


def _check(manifest: Manifest, file: Path) -> None:
    if manifest.format not in (1, FORMAT):
        raise PoolError(f"{file}: format {manifest.format}; this version reads formats 1 and {FORMAT}")
    check_name(manifest.name, f"{file}: the pool's name", PoolError)
    if not manifest.agents:
        raise PoolError(f"{file}: lists no agents; a pool has at least one")
    for agent in manifest.agents:
        _check_entry(manifest, agent, file)
    names = Counter(f"{agent.layout}/{agent.name}" for agent in manifest.agents)
    for name, times in names.items():
        if times > 1:
            raise PoolError(f"{file}: {times} agents are named {name}; give each its own name")
    weights = {f"{agent.layout}/{agent.name}": agent.files.weights.sha256 for agent in manifest.agents}
    twice = [sha256 for sha256, times in Counter(weights.values()).items() if times > 1]
    if twice:
        same = sorted(name for name, sha256 in weights.items() if sha256 in twice)
        raise PoolError(f"{file}: the agents {', '.join(same)} have the same weights; list each policy once")


def _check_entry(manifest: Manifest, agent: PoolAgent, file: Path) -> None:
    which = f"{file}, agent {agent.layout}/{agent.name}"
    check_name(agent.name, f"{which}: the name", PoolError)
    if agent.layout not in layout_names():
        names = layout_names()
        raise PoolError(
            f"{which}: unknown layout {agent.layout!r}; {guess(agent.layout, names)}Shipped are {', '.join(names)}"
        )
    if (agent.cooking, agent.mode) != (manifest.cooking, manifest.mode):
        raise PoolError(
            f"{which}: cooking {agent.cooking!r} and mode {agent.mode!r} in a pool of {manifest.cooking!r} and "
            f"{manifest.mode!r}; make one pool of each"
        )
    _check_told(manifest, agent, which)
    for said, suffix in ((agent.files.weights.path, ".safetensors"), (agent.files.architecture.path, ".json")):
        expected = f"{agent.layout}/{agent.name}{suffix}"
        if said != expected:
            outside = PurePosixPath(said).is_absolute() or ".." in PurePosixPath(said).parts
            what = "points outside the pool's folder" if outside else "is not this agent's file"
            raise PoolError(f"{which}: {said!r} {what}; its file is {expected!r}")


def _check_told(manifest: Manifest, agent: PoolAgent, which: str) -> None:
    """Makes sure that an entry tells what its format asks for, no less and no more."""
    told = {"configuration": agent.configuration, "checkpoint": agent.checkpoint, "profile": agent.profile}
    for key, value in told.items():
        if (value is None) != (manifest.format == 1):
            verb = "lacks" if value is None else "has"
            raise PoolError(f"{which}: it {verb} {key!r}, which came with format 2; this one is {manifest.format}")
    if agent.checkpoint is not None and not 0 <= agent.checkpoint <= 1:
        raise PoolError(f"{which}: checkpoint is {agent.checkpoint}; give the share of the training done, from 0 to 1")


def check_files(folder: Path, manifest: Manifest, agent: PoolAgent) -> None:
    """Compares an agent's files with their hashes.

    Raises:
        PoolError: One is missing, changed, or a link out of the folder.
    """
    home = folder.resolve()
    for file in (agent.files.weights, agent.files.architecture):
        path = folder / file.path
        try:
            inside = path.resolve(strict=True).is_relative_to(home)
        except (OSError, RuntimeError):
            inside = True  # what is missing, or a link to itself, cannot be read either
        if not inside:
            raise PoolError(
                f"{_which(manifest, agent)}: {path} is a link that leads outside the pool's folder; copy the file"
            )
        try:
            data = read_regular(path, MOST_BYTES)
        except FileError as error:
            raise PoolError(f"{_which(manifest, agent)}: {error}; restore it, or remove the entry") from None
        if _sha256(data) != file.sha256:
            raise PoolError(
                f"{_which(manifest, agent)}: {path} is not the file that the manifest was written for (SHA-256 "
                f"{_sha256(data)[:12]}…, expected {file.sha256[:12]}…); restore it, or write a new manifest"
            )


def check_policy(folder: Path, manifest: Manifest, agent: PoolAgent) -> "Policy":
    """Reads an agent's policy and compares it with the manifest.

    Raises:
        PolicyError: The two files are broken or do not fit each other.
        PoolError: It was trained for something else than the manifest says.
    """
    from overcooked_bench.agents.policies.policy import load_policy

    policy = load_policy(folder / agent.layout / agent.name)
    said = policy.architecture
    if (said.layout, said.cooking) != (agent.layout, agent.cooking):
        raise PoolError(
            f"{_which(manifest, agent)}: its JSON file says layout {said.layout!r} and cooking {said.cooking!r}, "
            f"the manifest {agent.layout!r} and {agent.cooking!r}; correct the manifest's entry"
        )
    return policy


def _with_files(agent: AgentRecord, folder: Path) -> PoolAgent:
    def hashed(suffix: str) -> HashedFile:
        path = f"{agent.layout}/{agent.name}{suffix}"
        return HashedFile(path=path, sha256=_sha256(read_regular(folder / path, MOST_BYTES, raises=PoolError)))

    given = {name: getattr(agent, name) for name in AgentRecord.__struct_fields__}
    return PoolAgent(**given, files=PoolFiles(weights=hashed(".safetensors"), architecture=hashed(".json")))


def _order(agent: AgentRecord) -> tuple[str, str]:
    return agent.layout, agent.name


def _which(manifest: Manifest, agent: PoolAgent) -> str:
    return f"pool {manifest.name!r}, agent {agent.layout}/{agent.name}"


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
