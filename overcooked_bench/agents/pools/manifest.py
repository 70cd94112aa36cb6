"""A pool's manifest: its partners, how each was made, and the hashes of their files."""

import hashlib
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from overcooked_bench.agents.behaviours.parsing import VERSION
from overcooked_bench.agents.pools.records import (
    BehaviourReference,
    Entry,
    HashedFile,
    Manifest,
    PolicyReference,
)
from overcooked_bench.agents.pools.upgrades import UPGRADES
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.documents import parse_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import FileError, check_name, read_regular, shown, write_whole
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import Layout, layout_names
from overcooked_bench.shelf import guess

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

FORMAT: Final = 3
"""The format that is written; older formats are read through `UPGRADES`."""

MANIFEST: Final = "manifest.json"
MOST_BYTES: Final = 64 << 20
"""Most bytes of a file of a pool."""


class PoolError(WrongUse):
    """A pool is missing, damaged or not what its manifest says; the message names the agent and the file."""


def read_manifest(folder: Path) -> Manifest:
    """Reads a manifest of any format and checks it by itself, without looking at the policies' files.

    Raises:
        PoolError: It is missing or broken; names the entry.
    """
    file = folder / MANIFEST
    data = read_regular(file, MOST_BYTES, raises=PoolError)
    form = parse_json(data, str(file), dict[str, Any], PoolError).get("format")
    if form == FORMAT:
        manifest = parse_json(data, str(file), Manifest, PoolError)
        hashed = _hashed(manifest)
    elif type(form) is int and form in UPGRADES:
        try:
            manifest, hashed = UPGRADES[form](data)
        except ValueError as error:
            raise PoolError(f"{file}: {error}") from None
    else:
        raise PoolError(f"{file}: format {shown(form)}; this version reads formats 1 to {FORMAT}")
    _check(manifest, file)
    if manifest.hash != _sha256(hashed):
        raise PoolError(
            f"{file}: its hash does not match its entries, so one of them was changed; restore the file, or make a new "
            "pool with write_manifest"
        )
    return manifest


def write_manifest(
    folder: str | Path,
    name: str,
    entries: Sequence[Entry],
    cooking: Literal["auto", "manual"] = "auto",
    mode: Literal["sample", "greedy"] = "sample",
    frozen: bool = True,
) -> Manifest:
    """Hashes the policies' files and writes `manifest.json`.

    Args:
        folder: The pool's folder; it holds each policy's pair of files at `<layout>/<name>`.
        name: The pool's name.
        entries: The partners; a policy without a reference gets one, from its files.
        cooking: Cooking mode of all partners.
        mode: How policies choose their actions.
        frozen: False for a release candidate.

    Returns:
        The manifest that was written.

    Raises:
        PoolError: A file is missing, or an entry is not as it should be; nothing is written.
    """
    folder = Path(folder)
    whole = tuple(_with_files(entry, folder) for entry in sorted(entries, key=_order))
    manifest = Manifest(format=FORMAT, name=name, cooking=cooking, mode=mode, hash="", entries=whole, frozen=frozen)
    try:  # as it will be read: an int in a float's place would be hashed differently
        manifest = msgspec.json.decode(msgspec.json.encode(manifest), type=Manifest)
    except (msgspec.ValidationError, TypeError, UnicodeEncodeError) as error:
        raise PoolError(f"pool {name!r}: {error}") from None
    manifest = msgspec.structs.replace(manifest, hash=_sha256(_hashed(manifest)))
    _check(manifest, folder / MANIFEST)
    for entry in policies(manifest):
        check_files(folder, manifest, entry)
        check_policy(folder, manifest, entry)
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / MANIFEST, msgspec.json.format(msgspec.json.encode(manifest), indent=2) + b"\n")
    return manifest


def policies(manifest: Manifest) -> tuple[Entry, ...]:
    """Lists the entries that are frozen policies, in the manifest's order."""
    return tuple(entry for entry in manifest.entries if isinstance(entry.reference, PolicyReference))


def people_of(manifest: Manifest, layout: str | None = None) -> tuple[str, ...]:
    """Lists the people whose recorded games a pool's agents, or their training partners, were made from.

    Args:
        manifest: The pool.
        layout: The layout of the agents that are meant; all by default.
    """
    entries = (entry for entry in manifest.entries if layout in (None, entry.layout))
    return tuple(sorted({person for entry in entries for person in entry.people or ()}))


def check_version(manifest: Manifest, entry: Entry) -> None:
    """Checks that this version of the package plays an entry as the pool requires.

    Raises:
        PoolError: The scripted agent or the language of behaviours has another version here, or the agent is unknown.
    """
    reference = entry.reference
    if reference is None or isinstance(reference, PolicyReference):
        return
    if isinstance(reference, BehaviourReference):
        what, here = "behaviours", VERSION
    elif reference.agent in SCRIPTED:
        what, here = f"the scripted agent {reference.agent!r}", SCRIPTED[reference.agent].version
    else:
        raise PoolError(
            f"{_which(manifest, entry)}: there is no scripted agent {shown(reference.agent)!r}; "
            f"{guess(reference.agent, SCRIPTED)}There are {', '.join(SCRIPTED)}"
        )
    if reference.version != here:
        raise PoolError(
            f"{_which(manifest, entry)}: the pool means version {reference.version} of {what}, this version of "
            f"overcooked_bench has version {here}, which plays differently; use the release that the pool was made "
            "for, or a newer pool"
        )


def check_files(folder: Path, manifest: Manifest, entry: Entry) -> None:
    """Compares a policy's files with their hashes; other kinds of entry have no files.

    Raises:
        PoolError: One is missing, changed, not a regular file, or a link out of the folder.
    """
    if not isinstance(entry.reference, PolicyReference):
        return
    home = os.path.realpath(folder)
    for file in (entry.reference.weights, entry.reference.architecture):
        path = folder / file.path
        if not Path(os.path.realpath(path)).is_relative_to(home):
            raise PoolError(
                f"{_which(manifest, entry)}: {path} is a link that leads outside the pool's folder; copy the file"
            )
        try:
            found = _sha256(read_regular(path, MOST_BYTES))
        except FileError as error:
            raise PoolError(f"{_which(manifest, entry)}: {error}; restore it, or remove the entry") from None
        if found != file.sha256:
            raise PoolError(
                f"{_which(manifest, entry)}: {path} is not the file that the manifest was written for (SHA-256 "
                f"{found[:12]}…, expected {file.sha256[:12]}…); restore it, or write a new manifest"
            )


def check_policy(folder: Path, manifest: Manifest, entry: Entry) -> "Policy":
    """Reads a policy and compares it with the manifest.

    Raises:
        PolicyError: The two files are broken or do not fit each other.
        PoolError: It was trained for something other than the manifest says.
    """
    from overcooked_bench.agents.policies.policy import load_policy

    policy = load_policy(folder / entry.layout / entry.name)
    said = policy.architecture
    if (said.layout, said.cooking) != (entry.layout, manifest.cooking):
        raise PoolError(
            f"{_which(manifest, entry)}: its JSON file says layout {said.layout!r} and cooking {said.cooking!r}, "
            f"the manifest {entry.layout!r} and {manifest.cooking!r}; correct the manifest"
        )
    return policy


def _check(manifest: Manifest, file: Path) -> None:
    check_name(manifest.name, f"{file}: the pool's name", PoolError)
    if not manifest.entries:
        raise PoolError(f"{file}: lists no partners; a pool has at least one")
    for entry in manifest.entries:
        _check_entry(entry, f"{file}, agent {shown(entry.layout)}/{shown(entry.name)}")
    for name, times in Counter(f"{entry.layout}/{entry.name}" for entry in manifest.entries).items():
        if times > 1:
            raise PoolError(f"{file}: {times} agents are named {name}; give each its own name")
    plays: dict[object, list[str]] = {}
    for entry in manifest.entries:
        where = "" if isinstance(entry.reference, PolicyReference) else entry.layout
        plays.setdefault((where, entry.sha256), []).append(f"{entry.layout}/{entry.name}")
    for names in plays.values():
        if len(names) > 1:
            raise PoolError(
                f"{file}: the agents {', '.join(sorted(names))} have the same weights, or are the same script; list "
                "each once"
            )


def _check_entry(entry: Entry, which: str) -> None:
    check_name(entry.name, f"{which}: its name", PoolError)
    if entry.layout not in layout_names() and not _is_grid(entry):
        raise PoolError(
            f"{which}: unknown layout {shown(entry.layout)!r}; {guess(entry.layout, layout_names())}"
            f"Shipped are {', '.join(layout_names())}; scripted partners may play a grid's text too"
        )
    for key in ("stratum", "lineage"):
        if not getattr(entry, key).strip():
            raise PoolError(f"{which}: its {key} is empty; write one")
    people = entry.people
    if people is not None and (not all(map(str.strip, people)) or not 0 < len(set(people)) == len(people)):
        raise PoolError(f"{which}: its people are {list(people)}; name each once, or leave the key out")
    _check_measured(entry, which)
    if not isinstance(entry.reference, PolicyReference):
        if entry.reference is None or entry.training is not None:
            raise PoolError(f"{which}: a trained agent has a policy, any other reference and no training")
        return
    if entry.training is None:
        raise PoolError(f"{which}: it is a policy, and lacks 'training', which says how it came to be")
    if not 0 <= entry.training.done <= 1:
        raise PoolError(
            f"{which}: checkpoint is {entry.training.checkpoint}; give the share of the training done, from 0 to 1"
        )
    for said, suffix in ((entry.reference.weights.path, ".safetensors"), (entry.reference.architecture.path, ".json")):
        expected = f"{entry.layout}/{entry.name}{suffix}"
        if said != expected:
            outside = PurePosixPath(said).is_absolute() or ".." in PurePosixPath(said).parts
            what = "points outside the pool's folder" if outside else "is not this agent's file"
            raise PoolError(f"{which}: {shown(said)!r} {what}; its file is {expected!r}")


def _check_measured(entry: Entry, which: str) -> None:
    sides = [bound.side for bound in entry.bounds or ()]
    if len(set(sides)) < len(sides) or any(side < 0 for side in sides):
        raise PoolError(f"{which}: its bounds are for the sides {sides}; give each side once, from 0")
    if entry.weight is not None and not 0 <= entry.weight <= 1:
        raise PoolError(f"{which}: its weight is {entry.weight}; give its share of its stratum, from 0 to 1")


def _is_grid(entry: Entry) -> bool:
    """Returns whether a partner without files is to play a kitchen of the user's own, named by its text."""
    if "\n" not in entry.layout or isinstance(entry.reference, PolicyReference):
        return False
    try:
        return Layout.from_text(entry.layout).name == entry.layout
    except LayoutError:
        return False


def _with_files(entry: Entry, folder: Path) -> Entry:
    if entry.reference is not None and not isinstance(entry.reference, PolicyReference):
        return entry

    def hashed(suffix: str) -> HashedFile:
        path = f"{entry.layout}/{entry.name}{suffix}"
        try:
            return HashedFile(path=path, sha256=_sha256(read_regular(folder / path, MOST_BYTES)))
        except FileError as error:
            raise PoolError(f"agent {entry.layout}/{entry.name}: {error}") from None

    reference = PolicyReference(weights=hashed(".safetensors"), architecture=hashed(".json"))
    return msgspec.structs.replace(entry, reference=reference)


def _hashed(manifest: Manifest) -> bytes:
    """Returns the bytes that the pool's hash is of: with sorted entries and keys, all but the hash and `frozen`."""
    entries = tuple(sorted(manifest.entries, key=_order))
    return msgspec.json.encode(msgspec.structs.replace(manifest, hash="", entries=entries, frozen=True), order="sorted")


def _order(entry: Entry) -> tuple[str, str]:
    return entry.layout, entry.name


def _which(manifest: Manifest, entry: Entry) -> str:
    return f"pool {manifest.name!r}, agent {entry.layout}/{entry.name}"


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
