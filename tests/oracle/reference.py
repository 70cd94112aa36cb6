"""overcooked-ai 1.1.0 behind our types. Importing this module imports that package."""

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from overcooked_bench import KitchenState, Layout
from overcooked_bench.kitchen.codes import DIRECTIONS, INTERACT, STAY
from overcooked_bench.kitchen.events import EVENTS

np.__dict__["Inf"] = np.inf  # the release was made for numpy 1

from overcooked_ai_py.mdp.actions import Action  # noqa: E402
from overcooked_ai_py.mdp.overcooked_mdp import EVENT_TYPES, OvercookedGridworld, OvercookedState  # noqa: E402
from overcooked_ai_py.planning.planners import MotionPlanner  # noqa: E402

assert tuple(EVENT_TYPES) == EVENTS


class Reference:
    """The reference kitchen of one of our layouts, cooking by hand.

    The reference keeps its recipes in one global table, so only the kitchen made last can be used.

    Args:
        layout: Any layout.
        menu: What it was made with besides the grid: the arguments of `Layout.from_text`.
        state: The state to begin in.
    """

    def __init__(self, layout: Layout, menu: Mapping[str, Any], state: KitchenState) -> None:
        self.kitchen = OvercookedGridworld(
            terrain=[list(row) for row in layout.rows],
            start_player_positions=[chef.position for chef in state.chefs],
            start_all_orders=[{"ingredients": order} for order in menu["orders"]],
            start_bonus_orders=[{"ingredients": order} for order in menu["bonus_orders"]],
            order_bonus=menu["order_bonus"],
            **_in_reference_words(menu["soup_reward"], "delivery_reward", "recipe_values", "{}_value"),
            **_in_reference_words(menu["cook_time"], "cook_time", "recipe_times", "{}_time"),
        )
        self.current = OvercookedState.from_dict(state.to_dict())
        self._planner: Any = None

    @property
    def state(self) -> KitchenState:
        """The present state, with the orders sorted."""
        return with_sorted_orders(KitchenState.from_dict(self.current.to_dict()))

    def step(self, actions: np.ndarray) -> tuple[list[float], list[float], np.ndarray]:
        """Plays a joint action; gives both chefs' soup rewards, partial rewards and events, (2, 25) bool."""
        moves = {**dict(enumerate(DIRECTIONS)), STAY: Action.STAY, INTERACT: Action.INTERACT}
        self.current, infos = self.kitchen.get_state_transition(self.current, [moves[int(a)] for a in actions])
        events = np.array([infos["event_infos"][name] for name in EVENTS]).T
        return infos["sparse_reward_by_agent"], infos["shaped_reward_by_agent"], events

    def lossless26(self, horizon: int) -> np.ndarray:
        """Both chefs' encodings, (2, 26, H, W)."""
        views = self.kitchen.lossless_state_encoding(self.current, horizon=horizon)
        return np.array(views).transpose(0, 3, 2, 1)

    def features(self) -> np.ndarray:
        """Both chefs' features, (2, 96); counters are no goals."""
        if self._planner is None:
            self._planner = SimpleNamespace(motion_planner=MotionPlanner(self.kitchen, counter_goals=[]))
        return np.array(self.kitchen.featurize_state(self.current, self._planner, num_pots=2))


def with_sorted_orders(state: KitchenState) -> KitchenState:
    """Gives the same state with its orders in one order: they are sets."""
    return replace(state, orders=tuple(sorted(state.orders or ())), bonus_orders=tuple(sorted(state.bonus_orders)))


def _in_reference_words(given: Any, common: str, listed: str, by_ingredient: str) -> dict[str, Any]:
    if isinstance(given, Mapping):
        return {by_ingredient.format(name): value for name, value in given.items()}
    return {listed: given} if isinstance(given, list) else {common: given}
