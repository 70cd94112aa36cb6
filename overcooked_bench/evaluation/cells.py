"""`Cells`: what was played on one layout as one labelled array.

Axes: S training seeds, P partners, E episode indices (start states), K seats of the scored agent.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.documents import parse_json
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.kitchen.layout import Layout

FLOOR: Final = "floor"
"""The kind of partners that are listed separately and do not count in any score."""

_ARRAYS: Final = ("returns", "ego_soups", "partner_soups", "sides")


class PartnerLabel(msgspec.Struct, frozen=True, omit_defaults=True):
    """What is known about a partner.

    Attributes:
        name: Unique on its layout.
        kind: "trained", "scripted" or "floor".
        sha256: Hash of what it is.
        stratum: Its origin, as the pool says it; the kind if the pool does not.
        convention: Equal for partners that go together; None if nobody has grouped them.
        is_ego: Whether it is the scored agent itself.
    """

    name: str
    kind: str
    sha256: str
    stratum: str
    convention: str | None = None
    is_ego: bool = False

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
    """

    layout: str
    soup_points: float
    partners: tuple[PartnerLabel, ...]
    seats: tuple[int, ...]
    returns: NDArray[np.float64]
    ego_soups: NDArray[np.float64]
    partner_soups: NDArray[np.float64]
    sides: NDArray[np.int64]

    @property
    def means(self) -> NDArray[np.float64]:
        """(S, P) mean return with each partner."""
        return np.asarray(self.returns.mean(axis=(2, 3)))

    @property
    def counting(self) -> "Cells":
        """The partners that enter scores."""
        return self.with_partners(index for index, partner in enumerate(self.partners) if partner.counts)

    def with_partners(self, indices: Iterable[int]) -> "Cells":
        """Returns the cells of some partners."""
        chosen = list(indices)
        arrays: dict[str, Any] = {name: np.take(getattr(self, name), chosen, axis=1) for name in _ARRAYS}
        return replace(self, partners=tuple(self.partners[index] for index in chosen), **arrays)

    def on_seat(self, seat: int) -> "Cells":
        """Returns the cells in which the scored agent sits on one seat."""
        index = self.seats.index(seat)
        return replace(self, seats=(seat,), **{name: getattr(self, name)[..., index : index + 1] for name in _ARRAYS})

    def per_repetition(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Averages an array over everything but its independent repetitions.

        Args:
            values: (S, P, E, K).

        Returns:
            (S,) the training seeds, or (E,) the episode blocks if there is only one seed.
        """
        return np.asarray(values.mean(axis=(1, 2, 3) if len(values) > 1 else (0, 1, 3)))


def read_cells(
    store: Store, layouts: Sequence[str], training_seeds: int, episodes: int, seats: Sequence[int]
) -> dict[str, Cells]:
    """Reads cells from a store.

    Args:
        store: Where the episodes are; its facts say who is scored, and may say more about the partners.
        layouts: Those of which every block is finished.
        training_seeds: S.
        episodes: E.
        seats: K seats.

    Returns:
        Layout -> its cells, partners by name, then floors by name.

    Raises:
        StoreError: An episode is missing, or a partner is described in two ways; names the file and the cell.
    """
    found = {layout: list(rows) for layout, rows in groupby(store.episodes(), lambda episode: episode.layout)}
    shape = training_seeds, episodes, tuple(seats)
    return {layout: _cells(store, layout, found.get(layout, []), shape) for layout in layouts}


def pack_labels(partners: Mapping[str, Iterable[PartnerLabel]]) -> str:
    """Writes what pools say about partners, for the notes of a store: layout -> its partners."""
    return json.dumps({layout: {p.name: [p.stratum, p.convention] for p in some} for layout, some in partners.items()})


def _cells(store: Store, layout: str, rows: Sequence[Episode], shape: tuple[int, int, tuple[int, ...]]) -> Cells:
    seeds, episodes, seats = shape
    labels = _labels(store, layout, rows)
    size = seeds, len(labels), episodes, len(seats)
    index = {label.name: number for number, label in enumerate(labels)}
    found: dict[str, NDArray[Any]] = {name: np.full(size, np.nan) for name in _ARRAYS}
    for row in rows:
        at = row.training_seed, index[row.partner], row.episode, seats.index(row.seat) if row.seat in seats else -1
        if row.training_seed >= seeds or row.episode >= episodes or at[3] < 0:
            raise StoreError(f"{store.file}: {row.cell} does not belong to the protocol; score into another folder")
        values = row.soup_reward, row.ego_soups, row.partner_soups, row.side
        for name, value in zip(_ARRAYS, values, strict=True):
            found[name][at] = value
    missing = np.argwhere(np.isnan(found["returns"]))
    if len(missing) or not labels:
        s, p, e, k = missing[0] if len(missing) else (0, 0, 0, 0)
        who = labels[p].name if labels else "any"
        raise StoreError(
            f"{store.file}: there is no episode on {layout}, training seed {s}, episode {e}, partner {who}, seat "
            f"{seats[k]}, although its block is finished; the file was changed. Delete it, or write to another folder"
        )
    sides = found.pop("sides").astype(np.int64)
    return Cells(layout, Layout.load(layout).soup_points, labels, seats, sides=sides, **found)


def _labels(store: Store, layout: str, rows: Iterable[Episode]) -> tuple[PartnerLabel, ...]:
    """Describes the partners of a layout, those that count first."""
    notes = store.facts.get("partners", "{}")
    known = parse_json(notes, str(store.file), dict[str, dict[str, tuple[str, str | None]]], StoreError).get(layout, {})
    try:
        found: dict[str, PartnerLabel] = {}
        for row in rows:
            stratum, convention = known.get(row.partner, (row.kind, None))
            is_ego = row.partner_sha256 == store.facts.get("agent")
            label = PartnerLabel(row.partner, row.kind, row.partner_sha256, stratum, convention, is_ego)
            if found.setdefault(row.partner, label) != label:
                raise ValueError(f"{row.cell} is another partner than before: {label.kind}, {label.sha256}")
    except ValueError as error:
        raise StoreError(
            f"{store.file}: its partners on {layout} are unclear ({error}); the file was changed"
        ) from error
    return tuple(sorted(found.values(), key=lambda label: (not label.counts, label.name)))
