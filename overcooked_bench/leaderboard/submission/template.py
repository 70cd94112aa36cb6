"""Writes the folder of a new submission: one that plays, with a tiny agent, and that its author completes."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from overcooked_bench.agents.submissions.content import ENTRY
from overcooked_bench.files import check_name, shown, write_whole
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, SCHEMA, SubmissionError
from overcooked_bench.leaderboard.submission.names import path_problem

FEATURES: Final = 96

AGENT: Final = '''\
"""A tiny agent: one layer over the hand-made features, with random weights. Replace it with your own."""

from pathlib import Path

import numpy as np
from overcooked_bench.agents import sample_actions

TRAINING_SEEDS = 1  # number of independently trained agents, as in submission.yaml


class TinyAgent:
    observation = "features"  # act() gets (B, 96) float32: one row for each of B simultaneous episodes

    def __init__(self, weights):
        self.weight, self.bias = weights["weight"], weights["bias"]

    def reset(self, layout, seats, seeds):
        self.seeds, self.step = seeds, 0

    def act(self, observations):  # returns (B,) ints: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact
        self.step += 1
        logits = observations @ self.weight + self.bias
        chances = np.exp(logits - logits.max(axis=1, keepdims=True))
        return sample_actions(chances / chances.sum(axis=1, keepdims=True), self.seeds, self.step)


def make_agent(layout, training_seed):
    return TinyAgent(np.load(Path(__file__).with_name(f"weights-{training_seed}.npz")))
'''

_MANIFEST: Final = """\
# What a submission says of itself. `overcooked-bench submission check DIR` lists everything that has to be changed.
schema: {schema}
name: {name}
contact: {contact}               # an e-mail address or a link by which you can be reached
licence: {licence}               # SPDX identifier of the licence of your code and weights, such as MIT
link: null                # a page about it, such as a paper; null if there is none
commit: null              # full hash of the commit of the training code, in quotes; null if it is not public

method: {method}
joint_steps: {joint_steps}            # environment steps of one training seed over all layouts
partner_runs: {partner_runs}           # training runs that produced its training partners; 0 if there were none
human_data: false         # whether recorded games of people were used, for the agents or for their training partners
training_pools: []        # shipped pools whose agents it trained with, such as [train-v1]
selection_pools: []       # shipped pools that runs, checkpoints or settings were chosen with, such as [dev-v1]

observation: {observation}
training_seeds: {training_seeds}         # independent training runs, as TRAINING_SEEDS in agent.py

# I pledge that all of this file is true, and that I trained and chose with no pool that scores this submission except
# those that are listed above. Those who used the pool that scores them are shown in a table of their own.
pledge: false             # write true
"""

_README: Final = """\
# {name}

A submission to overcooked_bench. From the folder that contains this one:

```sh
overcooked-bench submission check {name}    # what is still to be changed; plays nothing
overcooked-bench score {name}               # plays it with every partner of the pool
overcooked-bench submission pack {name}     # writes {name}.submission.zip
```
"""


def new_submission(folder: str | Path) -> Path:
    """Writes a submission that plays; its author completes submission.yaml and replaces agent and weights.

    Args:
        folder: Where to; its last part is the submission's name. It must not exist.

    Raises:
        SubmissionError: The name cannot be used, or the folder exists.
    """
    folder = new_folder(folder)
    weights = io.BytesIO()
    random = np.random.default_rng(0)
    layer = random.normal(0, 0.1, (FEATURES, NUM_ACTIONS)).astype(np.float32)
    np.savez(weights, weight=layer, bias=np.zeros(NUM_ACTIONS, np.float32))
    files: Mapping[str, bytes | str] = {
        MANIFEST: manifest_text(
            folder.name, method="random weights, nothing was trained", joint_steps="0", observation="features"
        ),
        ENTRY: AGENT,
        "weights-0.npz": weights.getvalue(),
        "README.md": readme_text(folder.name),
    }
    folder.mkdir(parents=True)
    for name, data in files.items():
        write_whole(folder / name, data)
    return folder


def new_folder(folder: str | Path) -> Path:
    """Returns the folder of a new submission, not made yet.

    Raises:
        SubmissionError: Its name cannot be a submission's, or it exists.
    """
    folder = Path(folder)
    name = check_name(folder.name, "the submission's name", SubmissionError)
    if problem := path_problem(name):
        raise SubmissionError(f"{shown(name)}: {problem}")
    if folder.exists() or folder.is_symlink():
        raise SubmissionError(f"{shown(folder)}: exists already, and nothing is overwritten; choose another name")
    return folder


def manifest_text(name: str, *, method: str, joint_steps: str, observation: str) -> str:
    """Returns a submission.yaml in which its author has to fill in contact, licence and pledge.

    Args:
        name: The submission's name.
        method: How it was trained, as YAML.
        joint_steps: How long, as YAML, perhaps with a comment.
        observation: What its agents observe.
    """
    return _MANIFEST.format(
        **{"schema": SCHEMA, "name": name, "contact": '""', "licence": '""', "method": method},
        **{"joint_steps": joint_steps, "partner_runs": 0, "observation": observation, "training_seeds": 1},
    )


def readme_text(name: str) -> str:
    """Returns a README with the three commands."""
    return _README.format(name=name)
