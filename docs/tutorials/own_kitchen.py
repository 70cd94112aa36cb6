# %% [markdown]
# # A kitchen of your own
#
# A kitchen is a text of letters. Draw one, check that it can be played, see which partners get along in it, and train
# in it. This takes a minute on two cores.
#
# ## Draw it
#
# `X` is a counter, `P` a pot, `O` hands out onions and `D` dishes, `S` serves, and a space is floor; `1` and `2` mark
# where the chefs start. This one has a long counter in the middle, onions on the left, and the rest on the right: two
# chefs who hand onions over the counter save most of the walking.

# %%
from pathlib import Path

grid = """\
XXXXXXX
O1 X  P
O  X 2D
O     S
XXXXXXX
"""
_ = Path("detour.layout").write_text(grid)

# %% [markdown]
# ## Check it
#
# `check_layout` reads the kitchen, makes sure that two chefs can make a soup in it, and plays two `greedy` agents, also
# in its mirror image. It says nothing if all is well.

# %%
from overcooked_bench import Layout
from overcooked_bench.testing import check_layout

check_layout("detour.layout")
layout = Layout.load("detour.layout")
print(layout.width, "x", layout.height, "cells,", len(layout.positions(" ")), "of them floor")

# %% [markdown]
# What is wrong is said with row and column:

# %%
from overcooked_bench import LayoutError

try:
    Layout.from_text(grid.replace("O     S", "O      "))
except LayoutError as error:
    print(error)

# %% [markdown]
# Below a line `---`, a file may go on with orders, rewards and cooking times, in YAML; tomatoes are `T`:
#
# ```yaml
# ---
# orders: [[onion, onion, onion], [tomato, tomato]]
# soup_reward: [20, 15]
# cook_time: 15
# ```
#
# ## Who gets along in it
#
# Scripted agents play in any kitchen. If every pair earns about the same, the kitchen does not separate good partners
# from bad ones, and is no good for a benchmark. Rows are on seat 0, columns on seat 1:

# %%
from overcooked_bench import load_agent, play_episodes

names = ["greedy", "counter_passer", "clockwise", "stay"]
episodes = 20  # short: 2


def mean_points(first, second):
    pair = load_agent(first, layout.name), load_agent(second, layout.name)
    return play_episodes(layout, pair, episodes=episodes).soup_reward.mean()


print(" " * 16 + "".join(f"{name:>16}" for name in names))
for first in names:
    print(f"{first:16}" + "".join(f"{mean_points(first, second):16.0f}" for second in names))

# %% [markdown]
# ## Train in it
#
# Wherever a layout is asked for, a file, a grid or a `Layout` will do. In Gymnasium the id is `Overcooked/Custom-v0`:

# %%
import gymnasium as gym

env = gym.make("overcooked_bench:Overcooked/Custom-v0", layout="detour.layout", partner="greedy", shaping=1.0)
observation, _ = env.reset(seed=0)
print(observation.shape, observation.dtype)
env.close()

# %% [markdown]
# And the shipped methods train in it, here a best response to `greedy` for a few steps:

# %%
from overcooked_bench.baselines.training import train

steps, rollout = 300_000, 200  # short: 128, 1

outcome, summary = train(
    "best-response",
    layout="detour.layout",
    partners=("greedy",),
    seed=1,
    folder="runs/detour",
    steps=steps,
    rollout=rollout,
)
print(f"with itself {summary.with_itself.mean:.0f} points per episode")
print(f"with greedy {mean_points(outcome.files.weights, 'greedy'):.0f} points per episode")

# %% [markdown]
# How it does with the partner that it was trained with says little about others, a copy of itself included.
#
# ## Watch a moment
#
# `film` draws a state as text; `state` of a `Kitchens` is what an agent with `observation = "state"` sees.

# %%
import numpy as np

from overcooked_bench import Kitchens
from overcooked_bench.rendering.text import film, side_by_side

kitchens = Kitchens(layout, 1, start="standard")
kitchens.reset(seed=0)
pictures = [film(layout, kitchens.state(0), colour=False)]
for actions in ([5, 3], [3, 3], [5, 4]):  # chef 0 and chef 1: 2 east, 3 west, 4 stay, 5 interact
    kitchens.step(np.array([actions]))
    pictures.append(film(layout, kitchens.state(0), colour=False))
print(side_by_side(pictures))

# %% [markdown]
# ## Where to go from here
#
# - Scores and pools are made for kitchens that ship. To add yours, put the file into
#   `overcooked_bench/kitchen/layouts/`; its environment id, `list`, training and the mirror image come with it.
# - Test one behaviour in it: [a scenario from a failure you saw](scenario_from_failure.md) works with any grid.
