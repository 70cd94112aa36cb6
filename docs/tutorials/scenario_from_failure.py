# %% [markdown]
# # A scenario from a failure you saw
#
# A score says with whom an agent failed. Find the game, find out why, and write the failure down as a *scenario*, a
# unit test of a few steps that the next agent has to pass. This takes a minute on two cores.
#
# ## Find the game
#
# The agent is a self-play agent of the pool `dev-v0`; take your own instead. Its worst game with a partner it has never
# met:

# %%
from overcooked_bench import score
from overcooked_bench.evaluation.games.recording import find_recording

agent, layout = "dev-v0/cramped_room/sp-0", "cramped_room"
_ = score(agent, "v1-lite", layouts=[layout], output="scores/mine", scenarios=False)
worst = find_recording("scores/mine", worst=True)
print(worst.title)

# %% [markdown]
# On the command line: `overcooked-bench replay scores/mine --worst`. Four states of it, as text:

# %%
from overcooked_bench.rendering.text import film, side_by_side

states = [state for state, _ in worst.frames()]
print(side_by_side([film(worst.layout, states[step], colour=False) for step in (20, 30, 60, 300)]))

# %% [markdown]
# The agent is chef 0. At step 60 a soup has been ready for a while, and neither of the two has a dish; at step 300 the
# agent holds a soup that it never serves.
#
# ## Ask why
#
# `explain` plays on from moments of the recorded games: the pair, two copies of the agent, two copies of the partner,
# and two copies of `greedy`, which shows what the state allows. Each moment from which the pair fails gets a reason.
# Ten moments are few; the default is fifty. On the command line: `overcooked-bench explain scores/mine --agent AGENT`.

# %%
from overcooked_bench.evaluation.explaining.explain import explain

moments = 10  # short: 2
explanation, folder = explain("scores/mine", moments=moments)
(found,) = explanation.layouts
for moment in found.moments:
    print(f"{moment.partner:22} step {moment.step:3}: {moment.reason}")

# %% [markdown]
# ## A scenario that was written for you
#
# The worst moments are in `scores/mine/moments`, as games to watch and as scenarios. A scenario cannot hold a network,
# so a scripted cook with the partner's habits takes its place; where not even `greedy` succeeds with it, there is none.

# %%
written = sorted(folder.glob("moments/*.scenario.yaml"))
print(len(written), "scenarios")
for file in written[:1]:
    print(file.read_text())

# %% [markdown]
# ## Your own, from what you saw
#
# A written scenario says what happened; a good one says what should have happened, in as small a situation as possible.
# This one takes a single thing from games like the one above, and makes it as small as it can be: a soup is about to be
# ready, and the agent stands where its partner has to go for a dish. `A` is the tested agent, `B` its partner, and A
# passes as soon as `accept` holds.

# %%
from pathlib import Path

Path("mine").mkdir(exist_ok=True)
_ = Path("mine/X01-let-the-dish-pass.scenario.yaml").write_text("""\
id: X01-let-the-dish-pass
category: convention
layout: cramped_room
kitchen: |
  XXPXX
  O   O
  XA BX
  XDXSX
A: {facing: down, holds: onion}
B: {facing: left, does: plater, insist: true}
pots: {1: cooking 4 left}
accept: B.plate >= 1 and A.pot >= 1
why: A stands where B has to go for a dish; it makes room, and fills the pot once B has emptied it.
""")

# %% [markdown]
# ## Is it a fair test?
#
# The acceptance checks solve it from both seats and in its mirror image, and count who passes without effort. A
# scenario that doing nothing passes, or random play often, or that nobody can solve, tests nothing.

# %%
from overcooked_bench.scenarios.items import load_scenarios
from overcooked_bench.scenarios.solving.gates import check

(scenario,) = load_scenarios(["mine"])
report = check(scenario)
print("faults:", ", ".join(report.faults) or "none")
print(f"the shortest solution takes {report.steps} steps, an agent has {report.budget}")
print(f"random play passes {report.random:.1%} of its runs at most, and doing nothing {report.stay} of 4 situations")

# %% [markdown]
# On the command line: `overcooked-bench scenarios check mine --film`, which also draws a shortest solution.
#
# ## Who passes
#
# `run_scenarios` plays an agent in all four situations; `pytest mine --agent my_agent.py` does the same, and draws the
# last steps of every failure.

# %%
from overcooked_bench import run_scenarios

repeats = 20  # short: 2
for name in ("greedy", "onion_courier", "dev-v0/cramped_room/sp-0", "dev-v0/cramped_room/sp-1"):
    result = run_scenarios(name, select=["mine"], repeats=repeats)
    print(f"{name:26} passes {result.passed} of {result.n}")

# %% [markdown]
# ## Where to go from here
#
# - Every key, condition and behaviour of a partner: [Write a scenario](../scenario-language.md).
# - What the shares of reasons mean, and what they do not: [Why an agent failed](../explaining.md).
# - The scenarios that ship, and all options of pytest: [Cooperation unit tests](../unit-tests.md).
