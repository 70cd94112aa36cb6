# %% [markdown]
# # Best response to a pool
#
# One agent is trained with a fixed set of partners, a *pool*, whose members it meets in turn. It is the simplest way to
# become robust, and the yardstick for all others. With the few steps of this page it takes two minutes on two cores.
#
# ## Which pool for what
#
# Three pools ship for three jobs. Train with `train-v1`, choose settings and checkpoints with `dev-v1`, and leave `v1`
# to the score. An agent that trained with `v1` has to say so, and is listed in a table of its own.

# %%
from overcooked_bench import Pool

for name in ("train-v1", "dev-v1"):
    agents = Pool.load(name).agents("cramped_room")
    print(f"{name}: {len(agents)} agents on cramped_room, such as {', '.join(agent.name for agent in agents[:4])}")

# %% [markdown]
# ## Train
#
# `train` does what `overcooked-bench train best-response --layout cramped_room --partners train-v1` does. A partner is
# a pool, an agent's name, a policy file or a submission of yours, and several may be mixed: `("train-v1", "greedy")`.
# By default all partners play at once, each in its share of the kitchens; `per_episode` draws some for each episode.
# The default is 2,000,000 joint steps; this page trains for fewer.

# %%
from overcooked_bench.baselines.training import train

steps, kitchens, rollout = 600_000, 48, 200  # short: 96, 12, 4
partners = ("train-v1",)  # short: ("dev-v0",)

outcome, summary = train(
    "best-response",
    layout="cramped_room",
    partners=partners,
    seed=1,
    folder="runs/response",
    steps=steps,
    num_kitchens=kitchens,
    rollout=rollout,
    minibatches=12,
)
print(f"with itself       {summary.with_itself.mean:5.1f} points per episode")
print(f"with its partners {summary.with_partners.mean:5.1f} points per episode")
print("weights:", outcome.files.weights)

# %% [markdown]
# Ctrl-C saves the run, and the same call with `resume=True` continues it to the same weights.
#
# ## Choose with other partners
#
# The return with its own partners says how well it learned, not how well it does with strangers. `dev-v1` has partners
# from other seeds, some with habits and some half trained:

# %%
from overcooked_bench import score

choosing = {"protocol": "dev", "pool": "dev-v1"}  # short: {"protocol": "v1-lite"}

for agent, name in ((outcome.files.weights, "response"), ("greedy", "greedy")):
    scored = score(agent, **choosing, layouts=["cramped_room"], output=f"scores/{name}-dev", scenarios=False)
    print(f"{name:10} {scored.scores.find('mean', layout='cramped_room').estimate.text(0)} points with dev-v1")

# %% [markdown]
# Use this number to choose between settings, as often as you like. The scripted `greedy` stands beside it because it is
# hard to beat, and no learning at all.
#
# ## Score once
#
# When you are done with choosing, score it with `v1`; `v1-lite` is the quick look. `best-response-train-v1` is an entry
# that ships: three seeds of this method with its full number of steps.

# %%
for agent, name in ((outcome.files.weights, "response"), ("best-response-train-v1", "entry")):
    scored = score(agent, "v1-lite", layouts=["cramped_room"], output=f"scores/{name}-v1-lite", scenarios=False)
    found = scored.scores.find("n", layout="cramped_room")
    print(f"{name:10} N {found.value:.2f}, standard error {found.error:.2f}")

# %% [markdown]
# ## Where to go from here
#
# - Other learners: `algorithm="dqn"` or `"a2c"`. All settings: `overcooked-bench train best-response --help`.
# - A submission of the policy: `export(outcome.files.weights, "my-response", "cramped_room")`, as in
#   [Score a stable-baselines3 agent](score_sb3.md). Write `training_pools: [train-v1]` and `selection_pools: [dev-v1]`
#   into its `submission.yaml`.
# - Your own training loop needs only the environments, which take a pool's agent as a partner:
#   `partner="train-v1/cramped_room/sp-00"`.
# - The same pool with its untrained agents: [fictitious co-play](fictitious_co_play.md).
