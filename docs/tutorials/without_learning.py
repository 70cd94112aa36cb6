# %% [markdown]
# # An agent without learning
#
# An agent is any object that chooses actions. This one follows rules, and needs no training: a page of code, written
# twice, because the first version gets stuck. It takes a minute on two cores.
#
# ## What an agent sees
#
# An agent says in `observation` what it wants to be given. Networks take grids; rules are easier to write with
# `"state"`, a `KitchenState` with names for everything. `film` draws one as text.

# %%
from overcooked_bench import Kitchens, Layout
from overcooked_bench.rendering.text import film

layout = Layout.load("cramped_room")
kitchens = Kitchens(layout, 1, start="standard")
kitchens.reset(seed=0)
state = kitchens.state(0)
print(film(layout, state, colour=False))
print(state.chefs[0])
print("pots", layout.positions("P"), "onions", layout.positions("O"), "dishes", layout.positions("D"))

# %% [markdown]
# `[_]` is an empty pot, `<O>` hands out onions, `<D>` dishes, and `<S>` serves; `###` are counters. `0^` is chef 0,
# who looks up. Positions are (x, y), from 0 at the top left.
#
# ## The first version
#
# A submission is a file that defines `make_agent(layout, training_seed)`, so the agent goes into a file at once. Two
# decisions make an action: which tile to use next (`_wanted`), and how to get there (`_step_towards`, a breadth-first
# search over the floor). `one_game_at_a_time` adapts an agent that plays a single episode, with `act(state) -> int`.

# %%
from pathlib import Path

COOK = """
from collections import deque

from overcooked_bench import Layout
from overcooked_bench.agents import one_game_at_a_time

NORTH, SOUTH, EAST, WEST, STAY, INTERACT = range(6)
MOVES = {(0, -1): NORTH, (0, 1): SOUTH, (1, 0): EAST, (-1, 0): WEST}
FACES = {"north": (0, -1), "south": (0, 1), "east": (1, 0), "west": (-1, 0)}


class Cook:
    observation = "state"

    def reset(self, layout, seat, seed):
        self.layout, self.seat = Layout.load(layout), seat
        self.floor = set(self.layout.positions(" "))

    def act(self, state):
        me = state.chefs[self.seat]
        wanted = self._wanted(state, me.holding)
        dx, dy = FACES[me.facing]
        if (me.position[0] + dx, me.position[1] + dy) in wanted:
            return INTERACT
        return self._step_towards(me.position, wanted, self.floor)

    def _wanted(self, state, holding):  # the tiles that are useful now
        pots = {pot: state.objects.get(pot) for pot in self.layout.positions("P")}
        if holding == "onion":
            return [pot for pot, soup in pots.items() if soup is None or soup.is_idle]
        if holding == "dish":
            return [pot for pot, soup in pots.items() if soup is not None and not soup.is_idle]
        if holding is not None:
            return self.layout.positions("S")
        cooking = any(soup is not None and not soup.is_idle for soup in pots.values())
        return self.layout.positions("D" if cooking else "O")

    def _step_towards(self, start, wanted, floor):  # the first action of a shortest way to face one of these tiles
        first, waiting = {start: STAY}, deque([start])
        while waiting:
            x, y = cell = waiting.popleft()
            for (dx, dy), move in MOVES.items():
                beside = (x + dx, y + dy)
                if beside in wanted:
                    return move if cell == start else first[cell]
                if beside in floor and beside not in first:
                    first[beside] = move if cell == start else first[cell]
                    waiting.append(beside)
        return STAY


def make_agent(layout, training_seed):
    return one_game_at_a_time(Cook)
"""
_ = Path("cook.py").write_text(COOK)

# %% [markdown]
# `play_episodes` plays two agents with each other. An agent that meets itself is loaded twice.

# %%
from overcooked_bench import load_agent, play_episodes


def points(file, partner, layout="cramped_room"):
    pair = load_agent(file, layout), load_agent(partner, layout)
    return play_episodes(layout, pair, episodes=20).soup_reward.mean()


for partner in ("cook.py", "greedy", "stay"):
    print(f"with {partner:8} {points('cook.py', partner):6.1f} points per episode")

# %% [markdown]
# ## Find out why
#
# With `greedy`, which makes room, the cook is fine; with a copy of itself something goes wrong. Play one episode step
# by step, and look at the end:

# %%
import numpy as np

from overcooked_bench.rendering.text import side_by_side


def watch(file, steps, show, layout="cramped_room"):
    kitchens = Kitchens(layout, 1, start="standard")
    kitchens.reset(seed=0)
    pair = [load_agent(file, layout) for seat in (0, 1)]
    for seat, agent in enumerate(pair):
        agent.reset(layout, np.array([seat]), np.array([seat], np.uint64))
    pictures = []
    for step in range(steps):
        state = kitchens.state(0)
        if step in show:
            pictures.append(film(kitchens.layout, state, colour=False))
        kitchens.step(np.array([[agent.act([state])[0] for agent in pair]]))
    return side_by_side(pictures)


print(watch("cook.py", 400, show=(20, 21, 399)))

# %% [markdown]
# Both want to go where the other one stands, and neither gives way.
#
# ## The second version
#
# Two changes. The way around the other chef is tried first. And a cook that did not get to move in the last step
# takes, half of the time, a random step. Its random numbers come from the `seed` of `reset`, so every episode can be
# played again. A submission may import files next to it; they belong to it, and enter its hash.

# %%
PATIENT_COOK = """
from random import Random

from cook import FACES, INTERACT, STAY, Cook

from overcooked_bench.agents import one_game_at_a_time


class PatientCook(Cook):
    def reset(self, layout, seat, seed):
        super().reset(layout, seat, seed)
        self.random, self.before = Random(seed), None

    def act(self, state):
        action, me = super().act(state), state.chefs[self.seat]
        stuck, self.before = self.before == me, me
        if action == INTERACT:
            return action
        if stuck and self.random.random() < 0.5:
            return self.random.randrange(4)
        floor = self.floor - {state.chefs[1 - self.seat].position}
        around = self._step_towards(me.position, self._wanted(state, me.holding), floor)
        return action if around == STAY else around


def make_agent(layout, training_seed):
    return one_game_at_a_time(PatientCook)
"""
_ = Path("patient_cook.py").write_text(PATIENT_COOK)

for partner in ("patient_cook.py", "greedy", "stay"):
    print(f"with {partner:15} {points('patient_cook.py', partner):6.1f} points per episode")

# %% [markdown]
# It costs a little with `greedy`, and the cook now works beside itself, and even beside a chef who only stands there.
#
# ## Check and score
#
# `check_submission` plays short episodes in batches of several sizes, and raises an error that says what is wrong: an
# agent that keeps its own global generator, for example, would play differently from run to run.

# %%
from overcooked_bench import score
from overcooked_bench.testing import check_submission

layouts = None  # short: ["cramped_room"]

check_submission("patient_cook.py", layouts=["cramped_room", "forced_coordination"])
scored = score("patient_cook.py", "v1-lite", layouts=layouts, scenarios=False)
print(scored.table())

# %% [markdown]
# The lines of `greedy` are the scripted agent that ships, in the same games. `v1-lite` has one episode with each of
# eight partners from either seat; `overcooked-bench score patient_cook.py` plays the whole of `v1`.
#
# The cook does nothing for `forced_coordination`, where neither chef can reach everything, since it never puts
# anything on a counter for its partner:

# %%
from overcooked_bench.evaluation.games.recording import find_recording

layout = "forced_coordination"  # short: "cramped_room"
worst = find_recording(scored.folder, layout=layout, worst=True)
print(worst.title)
*_, (state, _) = worst.frames()
print(film(worst.layout, state, colour=False))
