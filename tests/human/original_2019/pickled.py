"""Makes pickles of the form of those of 2019, without pandas and NumPy's pickling: of names, calls and states."""

import copyreg
import io
import pickle
import struct
from collections.abc import Mapping
from typing import Any, ClassVar

from overcooked_bench import KitchenState, Soup
from overcooked_bench.human.game import Game
from overcooked_bench.human.replay import replay
from overcooked_bench.kitchen.codes import DIRECTIONS
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS


class Pickler(pickle._Pickler):
    """Writes the names of the classes below without looking them up."""

    def save_global(self, obj, name=None):
        self.save(obj.__module__)
        self.save(obj.__qualname__)
        self.write(pickle.STACK_GLOBAL)
        self.memoize(obj)

    dispatch: ClassVar = {**pickle._Pickler.dispatch, type: save_global}


class Call:
    """Is pickled as a call of a named thing, filled with a state."""

    def __init__(self, kind, *arguments, state=None):
        self.made = kind, arguments, state

    def __reduce_ex__(self, protocol):
        return self.made


def named(name: str) -> Any:
    """A class that passes as `module.name`; its instances are pickled as new ones, filled with their `state`."""
    module, _, own = name.rpartition(".")
    what = {"__reduce_ex__": lambda self, protocol: (copyreg.__newobj__, (type(self),), self.state)}
    return type(own, (), {"__module__": module, "__qualname__": own, **what})


FRAME, BLOCKS = named("pandas.core.frame.DataFrame"), named("pandas.core.internals.managers.BlockManager")
NEW_INDEX, INDEX = named("pandas.core.indexes.base._new_Index"), named("pandas.core.indexes.base.Index")
RANGE = named("pandas.core.indexes.range.RangeIndex")
RECONSTRUCT, ARRAY, TYPE = named("numpy.core.multiarray._reconstruct"), named("numpy.ndarray"), named("numpy.dtype")
FORMS = {bool: ("b1", "?"), int: ("i8", "q"), float: ("f8", "d")}


def dumped(value: Any) -> bytes:
    file = io.BytesIO()
    Pickler(file, 4).dump(value)
    return file.getvalue()


def array(code: str, shape: tuple[int, ...], content: Any) -> Call:
    kind = Call(TYPE, code, 0, 1, state=(3, "|" if code in ("O8", "b1") else "<", None, None, None, -1, -1, 0))
    return Call(RECONSTRUCT, ARRAY, (0,), b"b", state=(1, shape, kind, False, content))


def index(names: list[str]) -> Call:
    return Call(NEW_INDEX, INDEX, {"data": array("O8", (len(names),), names), "name": None})


def table(columns: Mapping[str, list[Any]]) -> bytes:
    """Pickles a table; the columns of one type are a block."""
    rows = len(next(iter(columns.values())))
    blocks, items = [], []
    for kind in (bool, float, int, str):
        names = [name for name, column in columns.items() if type(column[0]) is kind]
        entries = [entry for name in names for entry in columns[name]]
        if not names:
            continue
        code, form = FORMS.get(kind, ("O8", ""))
        content = struct.pack(f"<{len(entries)}{form}", *entries) if form else entries
        blocks.append(array(code, (len(names), rows), content))
        items.append(index(names))
    axes = [index(list(columns)), Call(NEW_INDEX, RANGE, {"start": 0, "stop": rows, "step": 1, "name": None})]
    manager, frame = BLOCKS(), FRAME()
    manager.state = (axes, blocks, items, {"0.14.1": {"axes": axes, "blocks": []}})
    frame.state = {"_data": manager, "_typ": "dataframe", "_metadata": []}
    return dumped(frame)


def text_of(state: KitchenState) -> str:
    """A state as it was written in 2019; the clock of a ready soup goes on."""

    def thing(place, what):
        where = {"position": list(place)}
        if not isinstance(what, Soup):
            return {"name": what, **where}
        tick = what.tick + 7 if what.is_ready else max(what.tick, 0)
        return {"name": "soup", **where, "state": ["onion", what.recipe[0], tick]}

    players = [
        {"position": list(chef.position), "orientation": list(DIRECTIONS[FACINGS.index(chef.facing)])}
        | ({"held_object": thing(chef.position, chef.holding)} if chef.holding else {})
        for chef in state.chefs
    ]
    objects = {f"{x},{y}": thing((x, y), what) for (x, y), what in state.objects.items()}
    return str({"players": players, "objects": objects, "order_list": ["onion"], "pot_explosion": False})


def rows(game: Game, worker: int, layout: str | None = None) -> dict[str, list[Any]]:
    """The columns of a game's table; `layout` is its name in 2019."""
    states, rewards = [], []
    for moment in replay([game]):
        states.append(text_of(moment.kitchens.state(0)))
        rewards.append(float(moment.play().soup_reward.sum() / 4))
    states.append(text_of(moment.kitchens.state(0)))
    actions = [*([x, y] for x, y in DIRECTIONS), [0, 0], "INTERACT"]
    steps = range(game.steps)
    return {
        "workerid_num": [worker for _ in steps],
        "layout_name": [layout or game.layout for _ in steps],
        "layout": [str(Layout.load(game.layout).text.splitlines()) for _ in steps],
        "cur_gameloop": [float(step) for step in steps],
        "time_elapsed": [step * 0.15 for step in steps],
        "is_leader": [True for _ in steps],
        "state": states[:-1],
        "next_state": states[1:],
        "joint_action": [str([actions[first], actions[second]]) for first, second in game.joint_actions().tolist()],
        "reward": rewards,
    }


def joined(*some: Mapping[str, list[Any]]) -> dict[str, list[Any]]:
    """The rows of several games, one game after the other."""
    return {name: [entry for columns in some for entry in columns[name]] for name in some[0]}
