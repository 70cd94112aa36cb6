# %% [markdown]
# # A human proxy from games you recorded
#
# A *human proxy* is an agent that plays as the people in recorded games do, so that an agent can meet "people" without
# people. You need games of three pairs of people or more. This takes two minutes on two cores.
#
# ## The games
#
# Recorded games are kept in one format, `*.games.jsonl`, one game per line. To have something to work with, pairs of
# scripted agents stand in for people here: `play_a_game` returns joint actions as a recording of yours would have them,
# (steps, 2) numbers from 0 to 5, and everything after it is the same for real games.

# %%
import numpy as np

from overcooked_bench import Kitchens, load_agent

layout, steps = "cramped_room", 400


def play_a_game(names, seed):
    kitchens = Kitchens(layout, 1, start="standard")
    kitchens.reset(seed=seed)
    chefs = [load_agent(name, layout) for name in names]
    for seat, chef in enumerate(chefs):
        chef.reset(layout, np.array([seat]), np.array([2 * seed + seat], np.uint64))
    actions = []
    for _ in range(steps):
        seen = kitchens.observe("lossless26")
        actions.append([int(chef.act(seen[:, seat])[0]) for seat, chef in enumerate(chefs)])
        kitchens.step(np.array([actions[-1]]))
    return actions


pairs = [("hesitant", "hesitant"), ("hesitant", "waiter"), ("waiter", "hesitant"), ("plates_first", "hesitant")]

# %% [markdown]
# `record` plays a game again to see which soups are delivered, and `write_games` writes the file. `group` is a label of
# the people, the same for all their games: people are split into those to learn from and those to check with, never
# games. Nothing in the file should identify a person.

# %%
from overcooked_bench.human.game import Player
from overcooked_bench.human.games import read_games, record, write_games

people = Player("human", "first"), Player("human", "second")
games_per_pair = 3  # short: 1
games = [
    record(
        layout,
        play_a_game(pair, seed=10 * number + game),
        seats=people,
        source="scripted stand-ins for people",
        group=f"ours-{number:02}",
        licence="CC0-1.0",
    )
    for number, pair in enumerate(pairs)
    for game in range(games_per_pair)
]
write_games("ours.games.jsonl", games)
for game in read_games("ours.games.jsonl")[::games_per_pair]:
    print(game.group, game.steps, "steps,", len(game.soups), "soups")

# %% [markdown]
# ## What the people do
#
# `overcooked-bench games stats ours.games.jsonl` prints tables and draws a picture. In Python:

# %%
from overcooked_bench.human.conduct import conduct

of_people = conduct(games)
print(f"idle in {100 * of_people.idle.value:.0f} % of the steps, {of_people.soups.value:.1f} soups per 400 steps")

# %% [markdown]
# ## Train the proxy
#
# First a network learns to predict what a person does next, from a bootstrap sample of the pairs, and is held against
# pairs that were not drawn. This *clone* is then trained further for soups, and pays for playing differently, so that
# it does not get lost in states that no person was in. On the command line:
# `overcooked-bench train human-proxy --games ours.games.jsonl --pairs ours-00,ours-01 --layout cramped_room`, with
# all pairs that are to be learned from.

# %%
from overcooked_bench.baselines.training import train

training_steps, rollout, passes = 60_000, 100, 30  # short: 64, 1, 2

outcome, summary = train(
    "human-proxy",
    "features",
    layout=layout,
    games="ours.games.jsonl",
    pairs="ours-00,ours-01,ours-02,ours-03",
    seed=1,
    folder="runs/proxy",
    steps=training_steps,
    num_kitchens=32,
    rollout=rollout,
    clone_epochs=passes,
)
print(f"{summary.with_itself.mean:.0f} points with itself")
print("the clone:", outcome.snapshots[0.0].files.weights)
print("the proxy:", outcome.files.weights)

# %% [markdown]
# ## Does it play like them?
#
# `config.json` has who was drawn and who was held out, and how well the clone predicts the held-out pairs, in nats per
# step, of which fewer are better. `played` plays both with themselves, in the
# same form as recorded games, so that conduct can be compared:

# %%
import json
from pathlib import Path

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.cloning.played import played

record_of_run = json.loads(Path("runs/proxy/config.json").read_text())
print("drawn", record_of_run["drawn"], "held out", record_of_run["held_out"])
print(f"the clone predicts the held-out pairs at {record_of_run['clone_nats']:.2f} nats per step")
print(f"guessing among six actions predicts them at {np.log(6):.2f}")

episodes = 10  # short: 1
for name, files in (("clone", outcome.snapshots[0.0].files), ("proxy", outcome.files)):
    policy = load_policy(files.weights)
    own = played((policy, policy), episodes=episodes, horizon=steps)
    does = conduct(own)
    print(f"{name}: idle in {100 * does.idle.value:.0f} % of the steps, {does.soups.value:.1f} soups per 400 steps")

# %% [markdown]
# ## Use it
#
# The proxy is a partner like any other, in an environment, in training and for `play_episodes`:

# %%
import gymnasium as gym

env = gym.make("overcooked_bench:Overcooked/CrampedRoom-v0", partner=str(outcome.files.weights))
env.reset(seed=0)
env.step(4)
env.close()

# %% [markdown]
# ## Where to go from here
#
# - Real people: `overcooked-bench games import-2019` gets the public recordings of 2019, and
#   [People in the kitchen](../humans.md) says what they do, and which pools of proxies ship.
# - The format, key by key: [Recorded games](../games.md).
# - An agent that was trained with proxies should be tested with proxies of other people. `PEOPLE` in a submission says
#   whose games were used.
