# %% [markdown]
# # Fictitious co-play from train-v1
#
# Fictitious co-play (Strouse et al. 2021) is a best response to a population of self-play agents *and their past*: each
# takes part as it was before training, half trained, and trained. The weak ones teach the learner to get work done with
# partners that are no help. `train-v1` has all of them, so only the learner is trained here. With the few steps of this
# page it takes four minutes on two cores.
#
# ## The population
#
# Sixteen self-play runs per layout, each with three policies. `checkpoint` is the share of its training at which a
# policy was saved.

# %%
from overcooked_bench import Pool

agents = Pool.load("train-v1").agents("cramped_room")
kinds = {"untrained": [], "half trained": [], "trained": []}
for agent in agents:
    done = agent.trained.checkpoint
    kinds["untrained" if done == 0 else "trained" if done == 1 else "half trained"].append(agent)
for kind, members in kinds.items():
    points = [agent.trained.self_play.mean for agent in members]
    print(f"{len(members)} {kind:13} {min(points):5.0f} to {max(points):3.0f} points with themselves")

# %% [markdown]
# ## Train, with and without the past
#
# The method `pretrained-partners` draws partners from the pool for each episode. Its configuration
# `fictitious_co_play` uses all policies, `final_only` those that finished training, and the settings are otherwise the
# same. By default it trains for 2,000,000 joint steps.

# %%
from overcooked_bench.baselines.training import train

steps, kitchens, rollout = 300_000, 48, 200  # short: 96, 12, 4
pool = "train-v1"  # short: "dev-v0"

trained = {}
for configuration in ("fictitious_co_play", "final_only"):
    trained[configuration], summary = train(
        "pretrained-partners",
        configuration,
        layout="cramped_room",
        pool=pool,
        seed=1,
        folder=f"runs/{configuration}",
        steps=steps,
        num_kitchens=kitchens,
        rollout=rollout,
        minibatches=12,
    )
    print(f"{configuration:18} {summary.with_partners.mean:5.1f} points with its own partners")

# %% [markdown]
# The two numbers cannot be compared: the partners of the first are weaker.
#
# ## Compare with the same strangers
#
# `dev-v1` is the pool to choose by. Both agents play the same games, from the same start states with the same partners:

# %%
from overcooked_bench import score

choosing = {"protocol": "dev", "pool": "dev-v1"}  # short: {"protocol": "v1-lite"}

scores = {}
for name, outcome in trained.items():
    weights, folder = outcome.files.weights, f"scores/{name}"
    scores[name] = score(weights, **choosing, layouts=["cramped_room"], output=folder, scenarios=False).scores
    print(f"{name:18} {scores[name].find('mean', layout='cramped_room').estimate.text(0)} points with dev-v1")

# %% [markdown]
# `dev-v1` has partners that are half trained, too. By partner, which is where the two differ:

# %%
points = {
    name: {partner.name: row.value for partner, row in one.with_partners(one.layouts[0])}
    for name, one in scores.items()
}
print(f"{'partner':14}" + "".join(f"{name:>20}" for name in points))
for partner in sorted(points["final_only"]):
    print(f"{partner:14}" + "".join(f"{of_one[partner]:20.0f}" for of_one in points.values()))

# %% [markdown]
# ## What not to conclude
#
# That is one run of each. Two runs of the *same* method with other seeds differ, so the difference above says little
# about the methods. For a claim, train five seeds or more of each, put them into one submission each (`training_seed=0`
# to `4` of `export`), and let `overcooked-bench compare scores/mine-v1 scores/theirs-v1`
# test the difference over seeds: [Comparing scores](../comparing.md).
#
# ## Where to go from here
#
# - A population of your own instead of the pool's: leave `pool` out, and say how many with `agents=8`.
# - How many partners are drawn for an episode: `per_episode`.
# - The published variants, and all other methods: [Training](../training.md).
