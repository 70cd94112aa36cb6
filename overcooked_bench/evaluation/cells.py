"""`Cells`: what was played on one layout as one labelled array.

Axes: S training seeds, P partners, E episode indices (start states), K seats of the scored agent, D deeds.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.documents import parse_json
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.roster import FLOOR, ITSELF, SELF
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.pools.normalised import partner_shares
from overcooked_bench.kitchen.layout import Layout

_ARRAYS: Final = {
    "returns": "soup_reward",
    "ego_soups": "ego_soups",
    "partner_soups": "partner_soups",
    "sides": "side",
}
"""Arrays of cells -> columns of episodes."""


class SideBound(msgspec.Struct, frozen=True):
    """The returns that can be reached with a partner from one side, in points per episode.

    Attributes:
        side: Region that the scored agent starts in.
        floor: What the better of `stay` and `random` reaches.
        ceiling: What the best known responder does.
    """

    side: int
    floor: float
    ceiling: float


class PartnerLabel(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is known about a partner.

    Attributes:
        name: Unique on its layout.
        kind: "trained", "scripted" or "floor".
        sha256: Hash of what it is.
        stratum: Its origin, as the pool says it; the kind if the pool does not.
        convention: Equal for partners that go together; None if nobody has grouped them.
        is_ego: Whether it is the scored agent itself, or one of its training runs.
        weight: Its share of its stratum's weight; None if all partners weigh the same.
        bounds: What can be reached with it, by side; None if the pool does not say.
        home: Whether the scored agent is at home with it, see `lineage.at_home`; None if nobody knows.
    """

    name: str
    kind: str
    sha256: str
    stratum: str
    convention: str | None = None
    is_ego: bool = False
    weight: float | None = None
    bounds: tuple[SideBound, ...] | None = None
    home: bool | None = None

    @property
    def counts(self) -> bool:
        """Whether it enters scores."""
        return self.kind != FLOOR


@dataclass(frozen=True, eq=False)
class Cells:
    """One layout's episodes.

    Attributes:
        layout: Its name.
        soup_points: Points of one soup there.
        partners: P labels.
        seats: K seats of the scored agent.
        returns: (S, P, E, K) float64, points of the team.
        ego_soups: (S, P, E, K) float64, soups that the scored agent delivered.
        partner_soups: (S, P, E, K) float64, soups that the partner delivered.
        sides: (S, P, E, K) int64, region in which the scored agent started, as in `Layout.regions`.
        conduct: (S, P, E, K, 2, D) float64, what the scored agent and its partner did, in the order of
            `conduct.CONDUCT`; None if it was not counted.
        self_play: (S, E) float64, points of the team of the scored agent and its copy, averaged over seats; None if
            they did not play.
    """

    layout: str
    soup_points: float
    partners: tuple[PartnerLabel, ...]
    seats: tuple[int, ...]
    returns: NDArray[np.float64]
    ego_soups: NDArray[np.float64]
    partner_soups: NDArray[np.float64]
    sides: NDArray[np.int64]
    conduct: NDArray[np.float64] | None = None
    self_play: NDArray[np.float64] | None = None

    @property
    def means(self) -> NDArray[np.float64]:
        """(S, P) mean return with each partner."""
        return np.asarray(self.returns.mean(axis=(2, 3)))

    @property
    def counting(self) -> "Cells":
        """The partners that enter scores."""
        return self.with_partners(index for index, partner in enumerate(self.partners) if partner.counts)

    @property
    def shares(self) -> NDArray[np.float64]:
        """(P,) each partner's share of a weighted score: strata have equal shares, and divide them by the weights."""
        return partner_shares(self.partners)

    def with_partners(self, indices: Iterable[int]) -> "Cells":
        """Returns the cells of some partners."""
        chosen = list(indices)
        arrays: dict[str, Any] = {name: np.take(array, chosen, axis=1) for name, array in self._arrays().items()}
        return replace(self, partners=tuple(self.partners[index] for index in chosen), **arrays)

    def on_seat(self, seat: int) -> "Cells":
        """Returns the cells in which the scored agent sits on one seat."""
        index = [self.seats.index(seat)]
        arrays: dict[str, Any] = {name: np.take(array, index, axis=3) for name, array in self._arrays().items()}
        return replace(self, seats=(seat,), **arrays)

    def on_side(self, side: int) -> "Cells | None":
        """Returns the cells in which the scored agent starts on one side.

        Returns:
            None unless that is from one of the seats in each start state.
        """
        there = self.sides == side
        if (there.sum(axis=3) != 1).any():
            return None
        index = there.argmax(axis=3)[..., None]
        arrays: dict[str, Any] = {
            name: np.take_along_axis(array, index.reshape(*index.shape, *[1] * (array.ndim - 4)), axis=3)
            for name, array in self._arrays().items()
        }
        return replace(self, seats=self.seats[:1], **arrays)

    def per_partner(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Averages an array over everything but its independent repetitions and partners.

        Args:
            values: (S, P, E, K).

        Returns:
            (S, P), or (E, P) for the episode blocks if there is only one training seed.
        """
        return np.asarray(values.mean(axis=(2, 3)) if len(values) > 1 else values[0].mean(axis=2).T)

    def per_repetition(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Averages an array over everything but its independent repetitions.

        Args:
            values: (S, P, E, K).

        Returns:
            (S,) the training seeds, or (E,) the episode blocks if there is only one seed.
        """
        return np.asarray(values.mean(axis=(1, 2, 3) if len(values) > 1 else (0, 1, 3)))

    def _arrays(self) -> dict[str, Any]:
        """Returns the arrays that have a number for each episode with a partner."""
        named = {name: getattr(self, name) for name in (*_ARRAYS, "conduct")}
        return {name: array for name, array in named.items() if array is not None}


def read_cells(
    store: Store,
    layouts: Sequence[str],
    training_seeds: int,
    episodes: int,
    seats: Sequence[int],
    count: Callable[[Sequence[Episode]], NDArray[np.float64]] | None = None,
) -> dict[str, Cells]:
    """Reads cells from a store.

    Args:
        store: Where the episodes are; its facts say who is scored, and may say more about the partners.
        layouts: Those of which every block is finished.
        training_seeds: S.
        episodes: E.
        seats: K seats.
        count: Counts what both chefs of N episodes did, (N, 2, D); None if it is not wanted.

    Returns:
        Layout -> its cells, partners by name, then floors by name.

    Raises:
        StoreError: An episode is missing, or a partner is described in two ways; names the file and the cell.
    """
    found = {layout: list(rows) for layout, rows in groupby(store.episodes(), lambda episode: episode.layout)}
    shape = training_seeds, episodes, tuple(seats)
    return {layout: _cells(store, layout, found.get(layout, []), shape, count) for layout in layouts}


def pack_labels(partners: Mapping[str, Iterable[PartnerLabel]]) -> str:
    """Writes what pools say about partners, for the notes of a store: layout -> its partners."""
    return msgspec.json.encode({layout: {p.name: p for p in some} for layout, some in partners.items()}).decode()


def _cells(
    store: Store,
    layout: str,
    rows: Sequence[Episode],
    shape: tuple[int, int, tuple[int, ...]],
    count: Callable[[Sequence[Episode]], NDArray[np.float64]] | None,
) -> Cells:
    with_others = [row for row in rows if row.kind != SELF]
    with_itself = [row for row in rows if row.kind == SELF]
    labels = _labels(store, layout, with_others)
    names = [label.name for label in labels]
    places = _places(store, with_others, shape, names)
    found: dict[str, NDArray[Any]] = {
        name: _filled(store, layout, places, [getattr(row, column) for row in with_others], shape, names)
        for name, column in _ARRAYS.items()
    }
    found["sides"] = found["sides"].astype(np.int64)
    if count is not None:
        done = count(with_others)
        found["conduct"] = np.empty((*found["returns"].shape, *done.shape[1:]))
        found["conduct"][places] = done
    if with_itself:
        own = _places(store, with_itself, shape, [ITSELF])
        points = _filled(store, layout, own, [row.soup_reward for row in with_itself], shape, [ITSELF])
        found["self_play"] = points[:, 0].mean(axis=2)
    return Cells(layout, Layout.load(layout).soup_points, labels, shape[2], **found)


Places = tuple[NDArray[np.int64], ...]


def _places(
    store: Store, rows: Sequence[Episode], shape: tuple[int, int, tuple[int, ...]], names: Sequence[str]
) -> Places:
    """Returns the indices of episodes: training seed, partner, start state and seat, (N,) each."""
    seeds, episodes, seats = shape
    index, places = {name: number for number, name in enumerate(names)}, []
    for row in rows:
        known = row.seat in seats and row.partner in index
        if row.training_seed >= seeds or row.episode >= episodes or not known:
            raise StoreError(f"{store.file}: {row.cell} does not belong to the protocol; score into another folder")
        places.append((row.training_seed, index[row.partner], row.episode, seats.index(row.seat)))
    return tuple(np.array(places, np.int64).reshape(-1, 4).T)


def _filled(
    store: Store,
    layout: str,
    places: Places,
    values: Sequence[float],
    shape: tuple[int, int, tuple[int, ...]],
    names: Sequence[str],
) -> NDArray[np.float64]:
    """Returns an (S, P, E, K) array of one column of the episodes, none of which may be missing."""
    seeds, episodes, seats = shape
    found = np.full((seeds, len(names), episodes, len(seats)), np.nan)
    found[places] = values
    missing = np.argwhere(np.isnan(found))
    if len(missing) or not names:
        s, p, e, k = missing[0] if len(missing) else (0, 0, 0, 0)
        who = names[p] if names else "any"
        raise StoreError(
            f"{store.file}: there is no episode on {layout}, training seed {s}, episode {e}, partner {who}, seat "
            f"{seats[k]}, although its block is finished; the file was changed. Delete it, or write to another folder"
        )
    return found


_Notes = dict[str, dict[str, PartnerLabel | tuple[str, str | None]]]
"""Layout -> partner -> what the pool says of it; older stores have its stratum and convention alone."""


def _known(name: str, said: PartnerLabel | tuple[str, str | None]) -> PartnerLabel:
    return said if isinstance(said, PartnerLabel) else PartnerLabel(name, "", "", *said)


def _labels(store: Store, layout: str, rows: Iterable[Episode]) -> tuple[PartnerLabel, ...]:
    """Describes the partners of a layout, those that count first."""
    notes = parse_json(store.facts.get("partners", "{}"), str(store.file), _Notes, StoreError)
    known = {name: _known(name, said) for name, said in notes.get(layout, {}).items()}
    try:
        found: dict[str, PartnerLabel] = {}
        for row in rows:
            said = known.get(row.partner) or PartnerLabel(row.partner, "", "", row.kind)
            label = msgspec.structs.replace(
                said,
                kind=row.kind,
                sha256=row.partner_sha256,
                is_ego=said.is_ego or row.partner_sha256 == store.facts.get("agent"),
            )
            if found.setdefault(row.partner, label) != label:
                raise ValueError(f"{row.cell} is another partner than before: {label.kind}, {label.sha256}")
    except ValueError as error:
        raise StoreError(
            f"{store.file}: its partners on {layout} are unclear ({error}); the file was changed"
        ) from error
    return tuple(sorted(found.values(), key=lambda label: (not label.counts, label.name)))
