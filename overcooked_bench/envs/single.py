"""One kitchen as a `gymnasium.Env`: the ego agent on one seat, a partner on the other."""

import operator
from pathlib import Path
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.agents.seated import Views
from overcooked_bench.envs.event_rewards import shaping_weight
from overcooked_bench.envs.frames import RENDER_FPS, RENDER_MODES, checked_mode, frame
from overcooked_bench.envs.seats import (
    LARGEST_DRAW,
    RANDOM_SEAT,
    STAY_ACTION,
    checked_seat,
    needed_layout,
    seat_partner,
)
from overcooked_bench.envs.spaces import action_space, observation_space
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for


class OvercookedEnv(gymnasium.Env[NDArray[Any], Any]):
    """Two chefs cook and serve onion soups in a small kitchen; you are one of them, a partner is the other.

    Registered for every shipped layout as `Overcooked/<Layout>-v0`, for example `Overcooked/CrampedRoom-v0`, and for
    any grid as `Overcooked/Custom-v0`. `gymnasium.make("overcooked_bench:Overcooked/CrampedRoom-v0")` needs no import.

    ## Description
    A soup is three onions put into a pot, cooked for 20 steps, brought out with a dish and delivered at a serving tile.
    Both chefs act at the same time; the reward is shared, so both do best by helping each other. Layouts with tomatoes
    or other orders follow the same steps with their own recipes.

    ## Action Space
    `Discrete(6)`:

    | action | meaning |
    |---|---|
    | 0 | north: look up and go there if it is floor |
    | 1 | south |
    | 2 | east |
    | 3 | west |
    | 4 | stay |
    | 5 | interact with the cell in front: take, put down, fill a pot, plate a soup, serve |

    ## Observation Space
    Seen from the ego agent's seat. Grids are uint8, channels first, indexed [channel, y, x], with values from 0 to the
    longest cook time (at least 20). `observation=` chooses one of

    | name | shape | content |
    |---|---|---|
    | `lossless` | (22, H, W) | the 26 channels below without the four of tomatoes; not on layouts with tomatoes |
    | `lossless26` | (26, H, W) | all channels |
    | `lossless_2019` | (20, H, W) | the encoding of 2019 with its fault, for agents trained to see it |
    | `features` | (96,) float32 | hand-made distances and flags of both chefs |
    | `blind` | (17, H, W) | `lossless` without the other chef and what it holds |
    | `stack_channels` | (52, H, W) | `lossless`, then channels 0 to 9 of one, two and three steps ago |
    | `stack_states` | (4, 22, H, W) | `lossless` now and one, two and three steps ago |

    Before the start of an episode its first state is repeated. The 26 channels are

    | channel | 1 (or a number) where |
    |---|---|
    | 0, 1 | the own chef stands; the other chef stands |
    | 2-5 | the own chef stands, in the channel of where it looks: north, south, east, west |
    | 6-9 | the same for the other chef |
    | 10-15 | there is a pot, counter, onion, tomato or dish dispenser, serving tile |
    | 16, 17 | number of onions, of tomatoes in a pot that does not cook yet |
    | 18, 19 | number of onions, of tomatoes in a soup that cooks, is ready or is carried |
    | 20 | steps until the soup is ready |
    | 21 | a soup is ready, in a pot, on a counter or in hands |
    | 22, 23, 24 | a dish, an onion, a tomato is on a counter or in hands |
    | 25 | everywhere, while fewer than 40 steps are left |

    ## Starting State
    `start="random"`: two different floor cells, and where the floor has several separate regions one chef in each; with
    probability `object_probability` each pot and each pair of hands is filled. `start="standard"`: the layout's start
    cells. Both chefs look north. `seat="random"` draws the ego agent's seat for each episode.

    ## Rewards
    The team's reward of the step, 20 for a soup that either chef delivers, plus `shaping` times the ego agent's
    own partial reward: 3 for putting an ingredient into a pot, 3 for taking a useful dish, 5 for plating a soup.

    ## Episode End
    Never terminated; truncated after `horizon` steps.

    ## Information
    Both `reset` (with zeros) and `step` give `soup_reward` (float, the team's), `partial_reward` (float, the ego
    agent's, not weighted) and `seat` (int, the ego agent's).

    ## Arguments
    Args:
        layout: A shipped name, a grid's text, the path of a `.layout` file, or a Layout. The ids of shipped layouts set
            it; `Overcooked/Custom-v0` needs it.
        partner: What `load_agent` takes, such as "greedy", a submission's path or `{"does": "carry"}`; or an Agent.
        seat: The ego agent's, 0 or 1, or "random" for one drawn for each episode.
        observation: See above.
        cooking: "auto" (a pot starts by itself at the third ingredient) or "manual" (an empty-handed interact starts
            it).
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        horizon: Steps of an episode.
        shaping: Weight of the ego agent's partial rewards in the reward.
        render_mode: "rgb_array", "ansi" or None; `gymnasium.make` also takes "human", which needs pygame
            (`pip install overcooked-bench[play]`), and "rgb_array_list".

    Attributes:
        kitchens: The game itself, one kitchen.

    Raises:
        ValueError: An argument is out of range; says what to write instead.

    ## Version History
    * v0: first version. The dynamics of v0 never change.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": list(RENDER_MODES),
        "render_fps": RENDER_FPS,
    }

    def __init__(
        self,
        layout: str | Path | Layout | None = None,
        *,
        partner: Reference | Agent = "stay",
        seat: str | int = RANDOM_SEAT,
        observation: str = "lossless",
        cooking: str = "auto",
        start: str = "random",
        object_probability: float = 0.0,
        horizon: int = 400,
        shaping: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        plan = needed_layout(layout)
        self._chosen_seat = checked_seat(seat)
        self.render_mode = checked_mode(render_mode)
        self._partner = seat_partner(partner, plan, 1)
        self.kitchens = Kitchens(
            plan,
            1,
            cooking=cooking,
            horizon=horizon,
            start=start,
            object_probability=object_probability,
            history=history_for([observation, self._partner.observation if self._partner else ""]),
            autoreset=False,
        )
        if self._partner:
            self._partner.fit(self.kitchens)
        self.action_space = action_space()
        self.observation_space = observation_space(self.kitchens, observation)
        self._observation = observation
        self._shaping = shaping_weight(shaping)
        self._joint = np.full((1, 2), STAY_ACTION, np.int64)
        self._rewards, self._truncated = np.zeros((2, 1, 2)), np.zeros(1, np.bool_)
        self._seat = -1

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Starts an episode.

        Args:
            seed: Seeds all randomness: start states, seats, the partner.
            options: Not used.

        Returns:
            The first observation, and the information described in the class's docstring, with rewards of zero.
        """
        super().reset(seed=seed)
        if seed is not None or self._seat < 0:
            self.kitchens.reset(np.array([self.np_random.integers(LARGEST_DRAW)], np.uint64))
        else:
            self.kitchens.reset()
        draw = int(self.np_random.integers(LARGEST_DRAW))
        self._seat = draw & 1 if self._chosen_seat == RANDOM_SEAT else int(self._chosen_seat)
        self._joint[:] = STAY_ACTION
        if self._partner:
            self._partner.reset(self.kitchens.layout.name, np.array([draw >> 1], np.uint64), np.array([1 - self._seat]))
        self._seats = np.array([self._seat])
        view = self.kitchens.observe(self._observation, None, self._seats)[0]
        return view, {"soup_reward": 0.0, "partial_reward": 0.0, "seat": self._seat}

    def step(self, action: Any) -> tuple[NDArray[Any], float, bool, bool, dict[str, Any]]:
        """Plays one step together with the partner.

        Args:
            action: The ego agent's, 0 to 5.

        Returns:
            Observation, reward, False, whether the horizon is reached, and information.

        Raises:
            ResetNeeded: `reset` was never called.
            TypeError: The action is no whole number.
            ValueError: The action is out of range, or the episode is over.
        """
        seat = self._seat
        if seat < 0:
            raise ResetNeeded("call reset() before the first step()")
        try:
            self._joint[0, seat] = operator.index(action)
        except TypeError:
            raise TypeError(
                f"action {action!r} of the type {type(action).__name__}; give one whole number from 0 to 5"
            ) from None
        if self._partner:
            self._joint[0, 1 - seat] = self._partner.act(Views(self.kitchens, self._partner.seats).of(self._partner))[0]
        over = self.kitchens.step_into(self._joint, self._rewards, self._truncated)
        soup = self._rewards.item(0) + self._rewards.item(1)
        partial = self._rewards.item(2 + seat)
        return (
            self.kitchens.observe(self._observation, None, self._seats)[0],
            soup + self._shaping * partial,
            False,
            over > 0,
            {"soup_reward": soup, "partial_reward": partial, "seat": seat},
        )

    def render(self) -> Any:
        """Shows the kitchen as it is now.

        Returns:
            For "rgb_array" an (h, w, 3) uint8 picture, for "ansi" text, for None nothing.
        """
        return frame(self.kitchens, 0, self.render_mode)
