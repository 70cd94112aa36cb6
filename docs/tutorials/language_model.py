# %% [markdown]
# # A language-model agent
#
# A chat model plays: it reads the kitchen as text, chooses one of a few legal goals, and a few lines of code walk
# there. Calls are limited by a budget, and every reply is kept, so the same episode is free the second time and can
# be played again exactly. It takes a minute on two cores with the stand-in for a model that is used here, which needs
# no network; with a real one, as long as its calls take.
#
# ## The submission
#
# This is the whole agent. Read it from the bottom: `act` asks for a goal when the last one is reached or cannot be
# reached any more, and walks.
#
# - **Text view.** `film` draws the kitchen, and the lines below it name chefs and pots. The step is set to 0 in the
#   text, so that equal situations have equal prompts, and the second one costs nothing.
# - **Legal goals.** A model that chooses among six directions spends its calls on walking. It is offered goals instead,
#   with the tiles at which they are reached.
# - **Budget.** After `BUDGET` calls in an episode the first legal goal is taken, so the worst cost of a score is known
#   before it starts.
# - **Cache.** Replies are rows of `replies.sqlite`, with the prompt as the key. The file is in the folder that you work
#   in, not in the submission: a submission must not change while it is played.
# - **Chat client.** Any server that speaks OpenAI's chat protocol, of a company or on your own machine, by the standard
#   library. Without `CHAT_URL`, `stand_in` replies: a rule that reads the same prompt.

# %%
from pathlib import Path

AGENT = '''
import json
import os
import re
import sqlite3
import urllib.request
from collections import deque
from contextlib import closing
from dataclasses import replace

from overcooked_bench import Layout
from overcooked_bench.agents import one_game_at_a_time
from overcooked_bench.rendering.text import film

BUDGET = int(os.environ.get("CHAT_BUDGET", "100"))  # calls per episode
REPLIES = os.environ.get("CHAT_REPLIES", "replies.sqlite")
STAY, INTERACT = 4, 5
MOVES = {(0, -1): 0, (0, 1): 1, (1, 0): 2, (-1, 0): 3}
FACES = {"north": (0, -1), "south": (0, 1), "east": (1, 0), "west": (-1, 0)}
RULES = """You are a cook with a partner. Three onions in a pot cook by themselves; when the soup is ready, take it with
a dish and serve it. Both of you are paid for every soup. The kitchen: [_] empty pot, [2] pot with 2 onions, ~12 pot
with 12 steps to go, [!] soup ready, <O> onions, <D> dishes, <S> serving, ### counter. You are M, your partner is P."""


def chat(prompt):
    body = {"model": os.environ["CHAT_MODEL"], "temperature": 0, "messages": [{"role": "user", "content": prompt}]}
    headers = {"Content-Type": "application/json", "Authorization": "Bearer " + os.environ.get("CHAT_KEY", "none")}
    request = urllib.request.Request(os.environ["CHAT_URL"], json.dumps(body).encode(), headers)
    with urllib.request.urlopen(request, timeout=50) as answer:
        return json.load(answer)["choices"][0]["message"]["content"]


def stand_in(prompt):
    legal = re.findall("^- (.*?):", prompt, re.MULTILINE)
    partner_has_dish = bool(re.search("P[<>v^] dish", prompt))
    for goal in ("serve", "plate", "fill", "dish", "onion", "put down", "wait"):
        if goal in legal and not (goal == "dish" and partner_has_dish):
            return f"I go for: {goal}"


def ask(prompt):
    """Returns the model's reply, from the cache if the same was asked before."""
    with closing(sqlite3.connect(REPLIES, timeout=60)) as cache, cache:
        cache.execute("CREATE TABLE IF NOT EXISTS replies (prompt TEXT PRIMARY KEY, reply TEXT)")
        found = cache.execute("SELECT reply FROM replies WHERE prompt = ?", [prompt]).fetchone()
        if found is None:
            found = [chat(prompt) if "CHAT_URL" in os.environ else stand_in(prompt)]
            cache.execute("INSERT OR REPLACE INTO replies VALUES (?, ?)", [prompt, found[0]])
    return found[0]


def legal_goals(layout, state, seat):
    """Returns what the chef can do now: goal -> the tiles at which it does it."""
    pots = {pot: state.objects.get(pot) for pot in layout.positions("P")}
    open_pots = [pot for pot, soup in pots.items() if soup is None or soup.is_idle]
    cooking = [pot for pot, soup in pots.items() if soup is not None and not soup.is_idle]
    bare = [cell for cell in layout.positions("X") if cell not in state.objects]
    holding = state.chefs[seat].holding
    if holding is None:
        goals = {"onion": layout.positions("O")} if open_pots else {}
        goals |= {"dish": layout.positions("D")} if cooking else {}
    elif holding == "onion":
        goals = {"fill": open_pots, "put down": bare} if open_pots else {"put down": bare}
    elif holding == "dish":
        goals = {"plate": cooking, "put down": bare} if cooking else {"put down": bare}
    else:
        goals = {"serve": layout.positions("S")}
    return {**goals, "wait": []}


def text_view(layout, state, seat, goals):
    kitchen = film(layout, replace(state, timestep=0), colour=False, names="MP" if seat == 0 else "PM")
    choices = [f"- {goal}: at {' '.join(map(str, tiles)) or 'your place'}" for goal, tiles in goals.items()]
    return "\\n".join([RULES, "", kitchen, "", "Reply with one of these goals:", *choices])


class Cook:
    observation = "state"

    def reset(self, layout, seat, seed):
        self.layout, self.seat, self.calls = Layout.load(layout), seat, 0
        self.goal, self.held, self.until = None, None, 0

    def act(self, state):
        me, goals = state.chefs[self.seat], legal_goals(self.layout, state, self.seat)
        if self.goal not in goals or me.holding != self.held or state.timestep >= self.until:
            self.goal, self.held, self.until = self.choose(state, goals), me.holding, state.timestep + 15
        dx, dy = FACES[me.facing]
        if (me.position[0] + dx, me.position[1] + dy) in goals[self.goal]:
            return INTERACT
        return self.step_towards(me.position, goals[self.goal], state.chefs[1 - self.seat].position)

    def choose(self, state, goals):
        if self.calls >= BUDGET or len(goals) == 1:
            return next(iter(goals))
        self.calls += 1
        reply = ask(text_view(self.layout, state, self.seat, goals))
        return next((goal for goal in goals if goal in reply), next(iter(goals)))

    def step_towards(self, start, tiles, blocked):
        floor = set(self.layout.positions(" ")) - {blocked}
        first, waiting = {start: STAY}, deque([start])
        while waiting:
            x, y = cell = waiting.popleft()
            for (dx, dy), move in MOVES.items():
                beside = (x + dx, y + dy)
                if beside in tiles:
                    return move if cell == start else first[cell]
                if beside in floor and beside not in first:
                    first[beside] = move if cell == start else first[cell]
                    waiting.append(beside)
        return STAY


def make_agent(layout, training_seed):
    return one_game_at_a_time(Cook)
'''
Path("llm-cook").mkdir(exist_ok=True)
_ = Path("llm-cook", "agent.py").write_text(AGENT)

# %% [markdown]
# ## What the model reads
#
# One prompt, and the reply to it:

# %%
import runpy

from overcooked_bench import Kitchens, Layout

agent = runpy.run_path("llm-cook/agent.py")
layout = Layout.load("forced_coordination")
kitchens = Kitchens(layout, 1, start="standard")
kitchens.reset(seed=0)
state = kitchens.state(0)
prompt = agent["text_view"](layout, state, 1, agent["legal_goals"](layout, state, 1))
print(prompt)
print()
print(">", agent["ask"](prompt))

# %% [markdown]
# ## A first look
#
# One layout with one partner, before you pay for more. Count the calls, too:

# %%
import sqlite3
from contextlib import closing

from overcooked_bench import load_agent, play_episodes


def replies():
    with closing(sqlite3.connect("replies.sqlite")) as cache:
        return cache.execute("SELECT count(*) FROM replies").fetchone()[0]


for attempt in ("first", "second"):
    before = replies()
    pair = load_agent("llm-cook", "cramped_room"), load_agent("greedy", "cramped_room")
    soup = play_episodes("cramped_room", pair, episodes=2).soup_reward
    print(f"{attempt} time: {soup.mean():.0f} points per episode, {replies() - before} calls of the model")

# %% [markdown]
# ## Score it
#
# `v1-lite` is made for agents that take seconds for a step: eight partners, one episode from either seat, 80 episodes
# on the five layouts. With a budget of 100 calls per episode, that is 8,000 calls at most. A batch of 16 episodes
# calls the model one after the other, so one call of `act` may take long, and `act_timeout` says how long.

# %%
from overcooked_bench import score

layouts = None  # short: ["cramped_room"]

scored = score("llm-cook", "v1-lite", layouts=layouts, scenarios=False, act_timeout=900)
print(scored.table())
print(replies(), "calls of the model in all")

# %% [markdown]
# With a real model, set the server and the model before you start Python. Everything else stays as it is; a stopped
# score goes on with the same call, and replies that were paid for are in `replies.sqlite`.
#
# ```sh
# export CHAT_URL=https://api.openai.com/v1/chat/completions CHAT_MODEL=... CHAT_KEY=...    # or your own server
# ```
#
# Use a `replies.sqlite` of its own for every model: `CHAT_REPLIES=other.sqlite`.
#
# ## What to report
#
# - The model with its version, the prompt (it is in the agent's hash), the budget, and the calls that were made.
# - That a score of `v1-lite` has a standard error and no rank: it is of eight partners. - In a sandbox (`--isolate`)
#   there is no network. A score that others are to reproduce needs a model that runs on their machine, or your
#   `replies.sqlite`.
