"""`Episode`: one finished episode, and the table that stores it.

The fields of the class are the columns of the table: their types, their order and what values are possible.
"""

import hashlib
import json
import zlib
from collections.abc import Iterable
from typing import Annotated, Any, Final, get_type_hints

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState

KEY: Final = ("layout", "training_seed", "episode", "partner", "seat")
"""What identifies an episode within a score; the first three identify its block."""

BlockKey = tuple[str, int, int]
"""(layout, training seed, episode): one start state, with every partner from every seat."""

Count = Annotated[int, Meta(ge=0)]
Points = Annotated[float, Meta(gt=-1e12, lt=1e12)]


class Episode(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """One finished episode; a row of the table `episodes`.

    Attributes:
        layout: The layout's name.
        training_seed: Which training run of the scored agent.
        episode: Index of the start state.
        partner: The partner's name.
        seat: The scored agent's seat.
        side: Number of the region in which the scored agent starts, as in `Layout.regions`; 0 if there is only one.
        partner_sha256: Hash of what the partner is.
        kind: "trained", "scripted", "floor", or "self" for a copy of the scored agent.
        soup_reward: The team's points.
        ego_partial_reward: The scored agent's partial rewards, points.
        partner_partial_reward: The partner's.
        ego_soups: Soups that the scored agent delivered.
        partner_soups: Soups that the partner delivered.
        start: The first state in overcooked_ai's JSON form.
        actions: (T, 2) uint8 joint actions, packed by `pack_actions`.
    """

    layout: str
    training_seed: Count
    episode: Count
    partner: str
    seat: Annotated[int, Meta(ge=0, le=1)]
    side: Count
    partner_sha256: str
    kind: str
    soup_reward: Points
    ego_partial_reward: Points
    partner_partial_reward: Points
    ego_soups: Count
    partner_soups: Count
    start: str
    actions: bytes

    @property
    def block(self) -> BlockKey:
        """The block that it was played in."""
        return self.layout, self.training_seed, self.episode

    @property
    def cell(self) -> str:
        """Which episode this is, for messages."""
        return (
            f"{self.layout}, training seed {self.training_seed}, episode {self.episode}, partner {self.partner}, "
            f"seat {self.seat}"
        )

    @property
    def first_state(self) -> KitchenState:
        """The state that the episode starts in.

        Raises:
            ValueError: `start` is not a state.
        """
        return KitchenState.from_dict(json.loads(self.start))

    def joint_actions(self, horizon: int) -> NDArray[np.uint8]:
        """Unpacks the joint actions.

        Args:
            horizon: T, the protocol's number of steps; no more than that is ever unpacked.

        Returns:
            (T, 2) uint8.

        Raises:
            ValueError: They are not those of T steps.
        """
        size, stream = 2 * horizon, zlib.decompressobj()
        try:
            data = stream.decompress(self.actions, size + 1)
        except zlib.error as error:
            raise ValueError(f"the joint actions cannot be unpacked ({error})") from error
        if len(data) != size or not stream.eof:
            raise ValueError(f"the joint actions are not those of {horizon} steps")
        return np.frombuffer(data, np.uint8).reshape(-1, 2)


COLUMNS: Final = Episode.__struct_fields__


def sql_columns() -> str:
    """Returns the columns and the key as SQL."""
    words = {str: "TEXT", int: "INTEGER", float: "REAL", bytes: "BLOB"}
    lines = [f"{name} {words[kind]} NOT NULL" for name, kind in get_type_hints(Episode).items()]
    return ",\n    ".join([*lines, f"PRIMARY KEY ({', '.join(KEY)})"])


def read_row(row: Iterable[Any]) -> Episode:
    """Checks a row of the table.

    Args:
        row: Values in the order of `COLUMNS`.

    Raises:
        ValueError: A value has the wrong type or is impossible; names the column.
    """
    values = tuple(row)
    try:
        return msgspec.convert(values, Episode)
    except msgspec.ValidationError as error:
        where, _, path = str(error).rpartition(" - at `$[")
        if not path:
            raise
        raise ValueError(f"{where}, in the column {COLUMNS[int(path.rstrip(']`'))]!r}") from error


def checksum(block: BlockKey, adapted: bool, episodes: Iterable[Episode]) -> str:
    """Computes the SHA-256 of a block: of its key, of `adapted`, and of all columns of its episodes in their order."""
    rows = sorted(episodes, key=lambda episode: (episode.partner, episode.seat))
    return hashlib.sha256(msgspec.msgpack.encode([block, adapted, rows])).hexdigest()


def side_of(layout: Layout, start: KitchenState, seat: int) -> int:
    """Returns the number of the region in which the chef on a seat starts."""
    return layout.regions[start.chefs[seat].position]


def pack_state(state: KitchenState) -> str:
    """Writes a state as compact JSON."""
    return json.dumps(state.to_dict(), separators=(",", ":"))


def pack_actions(actions: NDArray[np.uint8]) -> bytes:
    """Compresses (T, 2) joint actions."""
    return zlib.compress(np.ascontiguousarray(actions).tobytes(), 6)
