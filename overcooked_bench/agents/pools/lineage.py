"""Checks from manifests alone that the agents of pools are independent of each other."""

from collections import defaultdict
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Sequence
from typing import Final, NamedTuple, TypeVar

from overcooked_bench.agents.pools.manifest import people_of, policies
from overcooked_bench.agents.pools.records import Entry, Manifest

SET_A: Final = tuple(f"2019-{pair:02d}" for pair in range(0, 17, 2))
"""The pairs of people of 2019 that several pools may have partners of: those that agents may be trained with."""

Key = TypeVar("Key")


class Finding(NamedTuple):
    """A problem of a pool.

    Attributes:
        grave: Whether the pool should not be used as it is.
        text: The problem, and the agents concerned.
    """

    grave: bool
    text: str


class Origin(NamedTuple):
    """Where an agent comes from.

    Attributes:
        codebase: The project whose training code made it; None for this one, "" if nobody trained it.
        people: Whose recorded games it was made from, or its training partners were.
    """

    codebase: str | None
    people: tuple[str, ...] = ()


def origin_of(entries: Iterable[Entry]) -> Origin:
    """Returns the common origin of trained agents of one method; the people are those of all of them together."""
    found = list(entries)
    people = sorted({person for entry in found for person in entry.people or ()})
    return Origin(found[0].trained.codebase, tuple(people))


def check_lineages(manifest: Manifest, others: Sequence[Manifest] = ()) -> list[Finding]:
    """Finds trained agents with undeclared ties.

    Within a pool, agents of one layout and lineage are checkpoints of one run, and agents of one seed are of one
    lineage; where partners have weights, a lineage has one partner on a layout. Between pools nothing is shared: no
    seed, no lineage, no weights, and no person whose games agents were made from. Equal namespaces are a warning, and
    so are people of set A: several pools have partners of them, with whom an agent that trained with one of these pools
    is at home.

    Args:
        manifest: The pool.
        others: Pools that it must have nothing in common with.
    """
    found = [*_one_run(manifest), *_one_seed(manifest), *_one_partner(manifest)]
    for other in others:
        found += _between(manifest, other)
    return found


def shared_people(manifest: Manifest, other: Manifest) -> tuple[str, ...]:
    """Lists the people whose games agents of both pools, or their training partners, were made from."""
    return tuple(sorted({*people_of(manifest)} & {*people_of(other)}))


def at_home(codebase: str | None, people: Collection[str], partner: Entry) -> bool:
    """Returns whether an agent is at home with a partner: what it reaches with it says little about strangers.

    It is at home with agents of the code that trained it, and with people that it was trained with.

    Args:
        codebase: The project whose training code made the agent; None for this one, "" if nobody trained it.
        people: Whose recorded games it was made from, or its training partners were.
        partner: The partner.
    """
    if set(people) & set(partner.people or ()):
        return True
    training = partner.training
    return training is not None and training.stratum != "human" and training.codebase == codebase


def _one_run(manifest: Manifest) -> Iterator[Finding]:
    for (layout, lineage), agents in _grouped(policies(manifest), lambda a: (a.layout, a.lineage)):
        if len(agents) < 2:
            continue
        who = f"{layout}: {_names(agents)} are of one lineage, {lineage!r}, "
        if any(agent.trained.checkpoint is None for agent in agents):
            yield Finding(True, f"{who}and do not say which checkpoints of a run they are")
            continue
        for key in ("method", "seed", "namespace", "configuration", "settings"):
            if any(getattr(agent.trained, key) != getattr(agents[0].trained, key) for agent in agents):
                yield Finding(True, f"{who}but not checkpoints of one run: they differ in {key}")
        for share, same in _grouped(agents, lambda a: a.trained.checkpoint):
            if len(same) > 1:
                yield Finding(True, f"{who}and {_names(same)} are the same checkpoint, {share}")


def _one_seed(manifest: Manifest) -> Iterator[Finding]:
    for (layout, seed), agents in _grouped(policies(manifest), lambda a: (a.layout, a.trained.seed)):
        if len({agent.lineage for agent in agents}) > 1:
            yield Finding(True, f"{layout}: {_names(agents)} have the training seed {seed} and different lineages")


def _one_partner(manifest: Manifest) -> Iterator[Finding]:
    partners = [entry for entry in policies(manifest) if entry.role == "partner" and entry.weight is not None]
    for (layout, lineage), agents in _grouped(partners, lambda a: (a.layout, a.lineage)):
        if len(agents) > 1:
            yield Finding(
                True, f"{layout}: {_names(agents)} are of one lineage, {lineage!r}; a pool with weights has one of them"
            )


def _between(manifest: Manifest, other: Manifest) -> Iterator[Finding]:
    ours, theirs = policies(manifest), policies(other)
    keys: list[tuple[str, Callable[[Entry], Hashable]]] = [
        ("the training seed", lambda a: (a.layout, a.trained.seed)),
        ("the lineage", lambda a: a.lineage),
        ("the weights", lambda a: a.sha256),
    ]
    for what, key in keys:
        common = {key(agent) for agent in theirs}
        for agent in ours:
            if key(agent) in common:
                whose = next(them for them in theirs if key(them) == key(agent))
                where = f"{other.name}/{whose.layout}/{whose.name}"
                yield Finding(True, f"{agent.layout}/{agent.name} shares {what} with {where}")
    shared = shared_people(manifest, other)
    for people in ([one for one in shared if one not in SET_A], [one for one in shared if one in SET_A]):
        who = next((entry for entry in manifest.entries if set(people) & set(entry.people or ())), None)
        if who is not None:
            yield Finding(
                people[0] not in SET_A,
                f"agents such as {who.layout}/{who.name} were made from games of {', '.join(people)}, or trained with "
                f"such agents; those of the pool {other.name} too",
            )
    for namespace in sorted(
        {agent.trained.namespace for agent in ours} & {agent.trained.namespace for agent in theirs}
    ):
        yield Finding(False, f"the seed namespace {namespace!r} is also used by the pool {other.name}")


def _grouped(agents: Iterable[Entry], key: Callable[[Entry], Key]) -> list[tuple[Key, list[Entry]]]:
    groups: dict[Key, list[Entry]] = defaultdict(list)
    for agent in agents:
        groups[key(agent)].append(agent)
    return list(groups.items())


def _names(agents: Iterable[Entry]) -> str:
    return ", ".join(sorted(agent.name for agent in agents))
