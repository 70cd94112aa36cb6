"""What the README and the pages of docs/ show runs as it stands there."""

import re
import shlex
from pathlib import Path
from typing import Any, ClassVar

import pytest

from overcooked_bench import play_episodes, score
from overcooked_bench.agents import UnknownLayout
from overcooked_bench.agents.submissions.loading import load_submission
from overcooked_bench.cli import main
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.score import Scored
from overcooked_bench.evaluation.scores import read_scores
from tests.evaluation.made import protocol_text
from tests.leaderboard.made import COMPLETE, edit

ROOT = Path(__file__).parents[1]
PAGES = {path.name: path.read_text("utf-8") for path in [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]}
BLOCKS = [
    (f"{page}-{number}", block)
    for page, text in PAGES.items()
    for number, block in enumerate(re.findall(r"```python\n(.*?)```", text, re.DOTALL))
]
SUBMISSIONS = {name: block for name, block in BLOCKS if "def make_agent" in block}
NETWORKS = {name: block for name, block in SUBMISSIONS.items() if "torch" in block}
SIMPLE = {name: block for name, block in SUBMISSIONS.items() if name not in NETWORKS}
ANALYSES = {name: block for name, block in BLOCKS if "episodes.sqlite" in block}
TRAININGS = {name: block for name, block in BLOCKS if ".learn(" in block}
SCRIPTS = {name: block for name, block in BLOCKS if name not in (*SUBMISSIONS, *ANALYSES, *TRAININGS)}


def submission(text, tmp_path):
    (tmp_path / "agent.py").write_text(text)
    return load_submission(tmp_path / "agent.py")


@pytest.mark.parametrize("text", SIMPLE.values(), ids=SIMPLE)
def test_a_submission_plays(text, tmp_path):
    shown = submission(text, tmp_path)
    assert shown.training_seeds == 1
    pair = (shown.make_agent("cramped_room", 0), shown.make_agent("cramped_room", 0))
    assert play_episodes("cramped_room", agents=pair, episodes=3, horizon=20).soup_reward.shape == (3,)


def test_the_network_plays_what_it_has_weights_for(tmp_path):
    import torch
    from safetensors.torch import save_file

    body = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(440, 8), torch.nn.ReLU(), torch.nn.Linear(8, 6))
    save_file(body.state_dict(), tmp_path / "cramped_room-4.safetensors")
    (text,) = NETWORKS.values()
    shown = submission(text, tmp_path)
    assert shown.training_seeds == 5
    pair = (shown.make_agent("cramped_room", 4), shown.make_agent("cramped_room", 4))
    assert play_episodes("cramped_room", agents=pair, episodes=3, horizon=20).soup_reward.shape == (3,)
    with pytest.raises(UnknownLayout, match="no weights for coordination_ring"):
        shown.make_agent("coordination_ring", 0)


@pytest.mark.parametrize("text", SCRIPTS.values(), ids=SCRIPTS)
def test_a_script_runs(text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(compile(text, "a page", "exec"), names)
    environments = [names[name] for name in ("env", "many", "own") if name in names]
    for environment in environments:
        observation, _ = environment.reset(seed=0)
        assert observation in environment.observation_space
        environment.step(environment.action_space.sample())
        environment.close()
    if "views" in names:
        assert names["views"].shape == (4096, 2, 26, 4, 5)
    elif "scored" in names:
        assert (tmp_path / "scores" / "greedy-v1" / "report.html").is_file()
    elif "games" in names:
        assert names["games"] == [names["game"]]
        assert names["seen"].shape == (1, 2, 22, 4, 5)
    else:
        assert environments


@pytest.mark.slow
@pytest.mark.parametrize("text", ANALYSES.values(), ids=ANALYSES)
def test_an_analysis_finds_the_numbers_of_score_json(text, tmp_path, monkeypatch):
    layouts = ["cramped_room", "forced_coordination"]
    scored = score("greedy", "v1-lite", layouts=layouts, output=tmp_path / "scores" / "greedy-v1-lite", scenarios=False)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(compile(text, "a page", "exec"), names)
    names["store"].close()
    found = scored.scores
    assert len(names["n"]) == len(layouts)
    for layout in layouts:
        assert names["n"][layout, 0] == pytest.approx(found.find("n", layout=layout).value)
        soups = found.find("threshold", layout=layout, params={"soups": 3})
        assert names["three_soups"][layout, 0] == pytest.approx(soups.value)
        for row in found.select("mean", layout=layout, seat=None):
            if row.partner:
                assert names["mean"][layout, 0, row.partner] == row.value


@pytest.mark.slow
def test_a_model_is_trained_exported_and_scored_as_the_page_says(tmp_path, monkeypatch):
    (text,), page = TRAININGS.values(), PAGES["submissions.md"]
    (commands,) = re.findall(r"```sh\n(overcooked-bench export .*?)```", page, re.DOTALL)
    less = {"num_envs=64": "num_envs=4", "n_steps=100": "n_steps=16", "batch_size=1600": "batch_size=64"}
    for long, short in {**less, "2_000_000": "64"}.items():
        assert long in text
        text = text.replace(long, short)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(protocol_text())
    exec(compile(text, "a page", "exec"), {})
    export, check, played, pack = (shlex.split(line)[1:] for line in commands.splitlines())
    assert [main(export), main(check)] == [0, 1]
    filled = {'method: ""': "method: a few steps", "joint_steps: null": "joint_steps: 64 #", **COMPLETE}
    edit(tmp_path / "my-ppo" / "submission.yaml", filled)
    assert main(check) == 0
    assert main([*played, "--protocol", "tiny.yaml", "--workers", "1", "--no-scenarios"]) == 0
    assert main(pack) == 0
    assert (tmp_path / "my-ppo.submission.zip").is_file()


def test_the_scenario_passes_the_acceptance_checks(tmp_path):
    from overcooked_bench.scenarios.language.loading import load_scenario
    from overcooked_bench.scenarios.solving.gates import check

    (text,) = re.findall(r"```yaml\n(.*?)```", PAGES["scenario-language.md"], re.DOTALL)
    name = text.partition("id: ")[2].partition("\n")[0]
    (tmp_path / f"{name}.scenario.yaml").write_text(text)
    assert len(text.splitlines()) <= 15
    report = check(load_scenario(tmp_path / f"{name}.scenario.yaml"))
    assert report.mergeable, report.faults


def test_every_word_of_the_scenario_language_is_explained():
    from overcooked_bench.agents.behaviours.parsing import KINDS, MANNERS, TIMED
    from overcooked_bench.scenarios import CATEGORIES
    from overcooked_bench.scenarios.language.counters import EVENTS
    from overcooked_bench.scenarios.language.loading import CHEF_KEYS, KEYS
    from overcooked_bench.scenarios.language.predicates import _AFTER_CHEF

    parameters = {key for kind in KINDS.values() for key in (*kind.needs, *kind.may)}
    for word in (*KEYS, *CHEF_KEYS, *KINDS, *MANNERS, *TIMED, *parameters, *EVENTS, *_AFTER_CHEF, *CATEGORIES):
        assert re.search(rf"`[^`\n]*\b{word}\b", PAGES["scenario-language.md"]), word


def test_every_option_of_the_plugin_is_listed():
    from overcooked_bench.scenarios.plugin.hooks import pytest_addoption

    class Parser:
        options: ClassVar[list[str]] = []

        def getgroup(self, *names):
            return self

        def addoption(self, name, **settings):
            self.options.append(name)

    pytest_addoption(Parser())
    assert [option for option in Parser.options if option not in PAGES["unit-tests.md"]] == []
    assert "--agent" in Parser.options


@pytest.fixture(scope="module")
def reference():
    """The score of `greedy` that ships with the protocol v1."""
    return read_scores(REFERENCES / "v1.json")


@pytest.mark.parametrize("page", ["README.md", "quickstart.md"])
def test_the_card_of_greedy_is_that_of_the_shipped_reference(page, reference, tmp_path):
    (card,) = re.findall(r"```text\n(greedy · protocol .*?)\n```", PAGES[page], re.DOTALL)
    table, notes = card.splitlines(), Scored(reference, tmp_path, 0).table().splitlines()
    assert table == notes[: len(table)]
    assert notes[len(table)] == "", "the page ends in the middle of the table"


def test_what_the_quickstart_reads_from_the_card_is_on_it(reference):
    text = " ".join(PAGES["quickstart.md"].split())
    whole, hardest = reference.find("n"), reference.find("n", layout="forced_coordination")
    for said in (
        f"`greedy` gets {whole.value:.2f} of the way, and in `forced_coordination` {hardest.value:.2f}.",
        f"**[{whole.estimate.low:.2f}, {whole.estimate.high:.2f}]** is the 95 % interval.",
    ):
        assert said in text
    strata = {row.stratum: row.value for row in reference.select("n", layout=None) if row.stratum is not None}
    assert min(strata, key=strata.get) == "other-trainers"
    assert "Here `greedy` is weakest with agents that other projects trained." in text


FOUND = [(page, link) for page, text in PAGES.items() for link in re.findall(r"\]\(([^)#]+)", text)]
LINKS = [(page, link) for page, link in dict.fromkeys(FOUND) if "://" not in link]


@pytest.mark.parametrize(("page", "link"), LINKS, ids=str)
def test_every_link_inside_the_repository_leads_to_a_file(page, link):
    folder = ROOT if page == "README.md" else ROOT / "docs"
    assert (folder / link).exists()


def test_the_readme_is_one_page():
    assert len(PAGES["README.md"].splitlines()) <= 150
