# %% [markdown]
# # Score a stable-baselines3 agent
#
# You have a model that stable-baselines3 trained, and want to know how it gets on with partners that it has never
# met. This takes about a minute on two cores, nearly all of it training.
#
# ## Train
#
# `gymnasium.make_vec` makes the kitchens: 64 of them, stepped by one call. You play one chef, `partner` the other;
# here that is the scripted agent `greedy`. The reward is the team's, 20 points per soup, plus `shaping` times your
# chef's rewards for useful steps on the way. stable-baselines3 takes only its own kind of vector environment, and
# `GymnasiumVecEnv` makes one of these kitchens.

# %%
import gymnasium as gym
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

from overcooked_bench.envs.sb3_gymnasium import GymnasiumVecEnv

torch.set_num_threads(1)  # a small network computes faster on one thread than on several
num_envs = 64  # short: 4
steps = 400_000  # short: 800

kitchens = gym.make_vec("overcooked_bench:Overcooked/CrampedRoom-v0", num_envs=num_envs, partner="greedy", shaping=1.0)
model = PPO(
    "MlpPolicy",
    VecMonitor(GymnasiumVecEnv(kitchens)),
    n_steps=100,
    batch_size=25 * num_envs,
    learning_rate=1e-3,
    n_epochs=4,
    ent_coef=0.01,
    seed=0,
    device="cpu",
)
model.learn(total_timesteps=steps)
model.save("model.zip")

# %% [markdown]
# ## Export
#
# A score needs a *submission*: a folder with `agent.py`, which defines `make_agent(layout, training_seed)`, and its
# weights. `export` makes one of the saved model. It reads the weights and the readable settings, and unpickles
# nothing. On the command line this is `overcooked-bench export model.zip my-ppo --layout cramped_room`.

# %%
from overcooked_bench.leaderboard.export.folder import export

print(export("model.zip", "my-ppo", "cramped_room"))

# %% [markdown]
# `make_agent` declines every layout for which the folder has no weights. Models of other layouts and of other
# training seeds go into the same folder: `export("ring-2.zip", "my-ppo", "coordination_ring", training_seed=2)`.
#
# ## Check
#
# `check_submission` plays short episodes, and says what a score would stumble over: an action that is out of range,
# or an episode that depends on what else is in the batch. It returns nothing if all is well.

# %%
from overcooked_bench.testing import check_submission

check_submission("my-ppo", layouts=["cramped_room"])

# %% [markdown]
# That is enough for a score. What a leaderboard wants to know besides is in `my-ppo/submission.yaml`, and
# `overcooked-bench submission check my-ppo` lists what is not filled in yet:

# %%
from overcooked_bench.leaderboard.submission.check import check_submission as check_folder

for problem in check_folder("my-ppo").problems:
    print("-", problem)

# %% [markdown]
# ## Score
#
# The protocol `v1-lite` takes seconds: eight partners, one episode from either seat. Use it to look, and `v1`, which
# is the default, for a number that you report. On the command line:
# `overcooked-bench score my-ppo --protocol v1-lite --layouts cramped_room`.

# %%
from overcooked_bench import score

scored = score("my-ppo", "v1-lite", layouts=["cramped_room"], scenarios=False)
print(scored.table())

# %% [markdown]
# **N** is 0 for what the better of `stay` and `random` reaches with a partner, and 1 for what the best known
# responder does. The next columns are N with partners of four origins. The line below is the scripted `greedy` in the
# same games.
#
# A model that was trained with one partner for a minute meets eight others here. Look at which ones it fails with:

# %%
facts = scored.scores.layouts[0]
for partner, points in sorted(scored.scores.with_partners(facts), key=lambda pair: pair[1].value):
    print(f"{partner.name:24} {partner.stratum:16} {points.value:5.0f} points")

# %% [markdown]
# ## Where to go from here
#
# - Watch the worst episode: `overcooked-bench replay scores/my-ppo-v1-lite --worst --page worst.html`. The folder
#   `scores/my-ppo-v1-lite` also has `report.html`, with all numbers and plots.
# - Ask why it fails: [a scenario from a failure you saw](scenario_from_failure.md).
# - Train with many partners instead of one: [best response to a pool](best_response.md).
# - One model is one agent. Five training runs say something about a method:
#   [Submissions](../submissions.md) has the details.
