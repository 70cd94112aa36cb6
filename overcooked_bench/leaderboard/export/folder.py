"""Writes converted policies into the folder of a submission, one per layout and training seed."""

import hashlib
import re
from pathlib import Path
from typing import Final, Literal

import numpy as np

from overcooked_bench.agents.policies.policy import load_policy, policy_files, save_policy
from overcooked_bench.agents.submissions.content import ENTRY
from overcooked_bench.agents.submissions.loading import MOST_TRAINING_SEEDS
from overcooked_bench.documents import LONGEST
from overcooked_bench.files import read_text, shown, write_whole
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.leaderboard.export.convert import Activation, Converted, convert
from overcooked_bench.leaderboard.export.sb3_file import ExportError, read_model
from overcooked_bench.leaderboard.submission.manifest import MANIFEST
from overcooked_bench.leaderboard.submission.template import manifest_text, new_folder, readme_text

POLICIES: Final = "policies"
_SUFFIXES: Final = (".safetensors", ".json")
_SEEDS: Final = (re.compile(r"^TRAINING_SEEDS = (\d+)", re.MULTILINE), "TRAINING_SEEDS = {}")
_SEEDS_SAID: Final = (re.compile(r"^training_seeds: (\d+)", re.MULTILINE), "training_seeds: {}")
_MODE: Final = re.compile(r'^MODE = "(\w+)"', re.MULTILINE)

_AGENT: Final = '''\
"""Plays policies that `overcooked-bench export` wrote, one per layout and training seed."""

from hashlib import sha256
from pathlib import Path

from overcooked_bench import UnknownLayout
from overcooked_bench.agents.policies.neural import NeuralAgent, load_policy

TRAINING_SEEDS = 1  # number of independently trained agents, as in submission.yaml
CODEBASE = "{codebase}"  # whose training code made them
MODE = "{mode}"  # "sample" draws from the policy's distribution, "greedy" takes its likeliest action


def make_agent(layout, training_seed):
    name = f"grid-{{sha256(layout.encode()).hexdigest()[:16]}}" if "\\n" in layout else layout
    policy = Path(__file__).parent / "{policies}" / f"{{name}}-{{training_seed}}.safetensors"
    if not policy.is_file():
        raise UnknownLayout(f"no policy for {{layout}} and training seed {{training_seed}}")
    return NeuralAgent(load_policy(policy), MODE)
'''


def export(
    model: str | Path,
    folder: str | Path,
    layout: str | Path | Layout,
    *,
    training_seed: int = 0,
    cooking: Literal["auto", "manual"] = "auto",
    observation: str | None = None,
    activation: Activation | None = None,
    raw_observations: bool = False,
) -> Path:
    """Writes a model into the folder of a submission, which is made if it does not exist.

    Args:
        model: A zip of stable-baselines3, or one of our own policies (`.safetensors`).
        folder: The submission.
        layout: The layout that it was trained on.
        training_seed: Which of the independent training runs it is, from 0.
        cooking: The cooking mode that it was trained under.
        observation: What it observes, where its file does not show it.
        activation: Its activation function, where its file does not say.
        raw_observations: Whether a VecNormalize around its environment left observations as they are.

    Returns:
        The file of weights that was written.

    Raises:
        ExportError: The model cannot be converted, or the folder holds something else or this policy already.
        SubmissionError: The folder's name cannot be a submission's.
        LayoutError: There is no such layout.
    """
    plan, folder = Layout.load(layout), Path(folder)
    if not 0 <= training_seed < MOST_TRAINING_SEEDS:
        raise ExportError(f"training seed {training_seed}; give a number from 0 to {MOST_TRAINING_SEEDS - 1}")
    if Path(model).suffix in _SUFFIXES:
        converted, codebase, steps = _own(model, plan), "overcooked-bench", 0
    else:
        saved = read_model(model)
        converted = convert(
            saved,
            plan,
            cooking=cooking,
            observation=observation,
            activation=activation,
            raw_observations=raw_observations,
        )
        codebase, steps = "stable-baselines3", saved.steps
    agent = _AGENT.format(codebase=codebase, mode=converted.mode, policies=POLICIES)
    stem = folder / POLICIES / f"{_file_name(plan.name)}-{training_seed}"
    is_new = not folder.exists()
    if is_new:
        new_folder(folder)
    else:
        _check_folder(folder, converted.mode, stem)
    files = save_policy(stem, converted.architecture, converted.tensors, dtype=np.float32)
    if is_new:
        observed = converted.architecture.observation
        manifest = manifest_text(folder.name, method='""', joint_steps="null", observation=observed)
        counted = f"# this model counts {steps:,}; "
        write_whole(folder / MANIFEST, re.sub(r"(?<=joint_steps: null)( +)# ", rf"\1{counted}", manifest, count=1))
        write_whole(folder / ENTRY, agent)
        write_whole(folder / "README.md", readme_text(folder.name))
    for name, (pattern, written) in ((ENTRY, _SEEDS), (MANIFEST, _SEEDS_SAID)):
        text = read_text(folder / name, LONGEST, raises=ExportError)
        seeds = max(training_seed + 1, *(int(number) for number in pattern.findall(text)))
        write_whole(folder / name, pattern.sub(written.format(seeds), text))
    return files.weights


def _own(file: str | Path, plan: Layout) -> Converted:
    policy = load_policy(file)
    if policy.architecture.layout != plan.name:
        raise ExportError(f"{shown(file)}: trained on {policy.architecture.layout!r}; give that as --layout")
    return Converted(policy.architecture, policy.weights, "sample")


def _file_name(layout: str) -> str:
    """Returns the name of a layout's files, as `make_agent` computes it."""
    return f"grid-{hashlib.sha256(layout.encode()).hexdigest()[:16]}" if "\n" in layout else layout


def _check_folder(folder: Path, mode: str, stem: Path) -> None:
    """Checks that a policy can be added to a folder.

    Raises:
        ExportError: It holds something else, plays otherwise, or has this policy already.
    """
    where = shown(folder)
    for name, patterns in ((ENTRY, (_SEEDS[0], _MODE)), (MANIFEST, (_SEEDS_SAID[0],))):
        text = read_text(folder / name, LONGEST, raises=ExportError) if (folder / name).is_file() else ""
        if any(len(pattern.findall(text)) != 1 for pattern in patterns):
            raise ExportError(
                f"{where}: exists, and its {name} is not one that export writes; name a folder that does not exist"
            )
        if name == ENTRY and (found := _MODE.findall(text)[0]) != mode:
            raise ExportError(
                f'{where}: its agent.py says MODE = "{found}", and this model plays "{mode}"; name another folder'
            )
    if written := [file for file in policy_files(stem) if file.exists()]:
        raise ExportError(f"{shown(written[0])}: exists already; name another --training-seed or remove it")
