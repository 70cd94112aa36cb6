"""Every training method: a short run, the same weights after a kill, what the command line says."""

import json
import signal
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.agents.pools.manifest import people_of, read_manifest
from overcooked_bench.agents.pools.pool import find_pool
from overcooked_bench.baselines import biased_self_play, pbt, population, pretrained_partners, training
from overcooked_bench.baselines.methods import METHODS, find_method
from overcooked_bench.baselines.presets import config_class
from overcooked_bench.baselines.running import partners
from overcooked_bench.baselines.running.partners import partner_names, scoring_pools
from overcooked_bench.baselines.running.place import CheckpointError, Place, write_record
from overcooked_bench.baselines.running.seeds import USER, derive_seed
from overcooked_bench.cli import main as command
from overcooked_bench.commands.settings_options import described
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.baselines.running.test_checkpoint import press_ctrl_c
from tests.baselines.tiny import MADE, SETTINGS, UPDATE, learned, same

OWN = {
    "self-play": {"object_probability": 0.5, "observation": "stack_channels"},
    "biased-self-play": {},
    "best-response": {"partners": ("greedy", "dev-v0")},
    "partner-sampling": {"save_every": UPDATE, "per_episode": 2},
    "pretrained-partners": {"agents": 2, "agent_steps": 3 * UPDATE, "per_episode": 2},
    "pbt": {"agents": 2, "rounds": 2, "pair_episodes": 1, "steps": 4 * UPDATE},
    "population": {
        **{"candidates": 2, "chosen": 2, "agents": 1, "per_episode": 2, "candidate_steps": 3 * UPDATE},
        **{"loss_coefficient": 0.1, "loss_clip": 0.15, "reward_coefficient": 0.1, "reward_clip": 0.05},
    },
    "stock-ppo": {"network": "cnn", "observation": "lossless_2019"},
    "recurrent-ppo": {"units": 8, "head": (7,)},
    "human-proxy": {
        **{"games": str(MADE), "partners": "clones", "agents": 2, "per_episode": 2},
        **{"clone_epochs": 2, "lesson_batch": 8},
    },
}
"""What each method is told besides the settings of a tiny run."""
HERE = [method for method in METHODS if method in OWN]
"""The methods that train in kitchens of ours; `test_jaxmarl_ippo.py` has the other one."""
LEGS = {"best-response": ({"algorithm": "a2c"}, {"algorithm": "dqn"})}
CASES = [(method, {}) for method in HERE] + [(method, own) for method, several in LEGS.items() for own in several]
IDS = ["-".join([method, *own.values()]) for method, own in CASES]

TOMATOES = "XXPXX\nT1 2O\nX   X\nXDXSX"


def settings(method, others=None):
    kitchens = {"num_kitchens": 6, "rollout": 12, "minibatches": 2} if method == "best-response" else {}
    return config_class(method)(**SETTINGS | kitchens | OWN[method] | (others or {}))


def run(method, others, folder, resume=False):
    module = find_method(method)
    seed = derive_seed(USER, "cramped_room", method, 0)
    return module.train(settings(method, others), Place(folder, seed, resume, UPDATE))


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Gives a method's uninterrupted run, trained once: its folder and outcome."""
    runs = {}

    def of(method, others):
        key = method, *sorted(others.values())
        if key not in runs:
            folder = tmp_path_factory.mktemp("whole") / "run"
            runs[key] = folder, run(method, others, folder)
        return runs[key]

    return of


@pytest.mark.slow
@pytest.mark.parametrize(("method", "others"), CASES, ids=IDS)
def test_a_run_interrupted_again_and_again_gives_the_same_weights(method, others, tmp_path, whole, monkeypatch):
    _, expected = whole(method, others)
    outcome, goes = None, 0
    while outcome is None:
        with monkeypatch.context() as patch:
            press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 5 if method == "pbt" else 20)
            outcome = run(method, others, tmp_path / "run", resume=goes > 0)
        goes += 1
        assert goes < 60
    assert goes > 1
    assert outcome.files.weights.read_bytes() == expected.files.weights.read_bytes()
    assert outcome.returns.tolist() == expected.returns.tolist()
    assert load_policy(outcome.files.weights).architecture.layout == "cramped_room"
    if method not in ("self-play", "biased-self-play", "partner-sampling", "stock-ppo", "recurrent-ppo"):
        assert outcome.with_partners.tolist() == expected.with_partners.tolist()


KILLED = """
import json, os, signal, sys
from overcooked_bench.cli import main
from overcooked_bench.commands.settings_options import described
from overcooked_bench.envs.sb3 import OvercookedVecEnv

play, left = OvercookedVecEnv.step_wait, 50

def step_wait(env):
    global left
    left -= 1
    if not left:
        os.kill(os.getpid(), signal.SIGKILL)
    return play(env)

OvercookedVecEnv.step_wait = step_wait
for arguments in json.loads(sys.argv[1]):
    child = os.fork()
    if not child:
        os._exit(main(arguments))
    print(os.waitpid(child, 0)[1])
"""


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Each method's command after its process got SIGKILL in the 50th step; one process, which forks, for all."""
    home = tmp_path_factory.mktemp("killed")
    commands = {
        method: ["train", method, *flags(method), "--output", str(home / method), "--checkpoint-every", str(UPDATE)]
        for method in HERE
    }
    call = [sys.executable, "-c", KILLED, json.dumps([*commands.values()])]
    done = subprocess.run(call, capture_output=True, text=True, timeout=600)
    ends = [line for line in done.stdout.splitlines() if line.isdigit()]
    assert ends == [str(int(signal.SIGKILL))] * len(HERE), done.stderr
    return commands


def flags(method):
    given = {**SETTINGS, **OWN[method], **({"num_kitchens": 6, "rollout": 12} if method == "best-response" else {})}
    return [
        text
        for name, value in given.items()
        for text in (f"--{name.replace('_', '-')}", *(map(str, value) if isinstance(value, tuple) else [str(value)]))
    ]


@pytest.mark.slow
@pytest.mark.parametrize("method", HERE)
def test_a_killed_command_goes_on_to_the_same_weights(method, killed, whole, capsys):
    arguments = killed[method]
    assert command(arguments) == 2
    assert "--resume" in capsys.readouterr().err
    assert command([*arguments, "--resume"]) == 0
    _, expected = whole(method, {})
    assert (Path(arguments[-3]) / "policy.safetensors").read_bytes() == expected.files.weights.read_bytes()
    assert "return with itself" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("method", ["pretrained-partners", "pbt"])
def test_ctrl_c_in_the_last_update_of_a_part_ends_the_whole_run(method, tmp_path, whole, monkeypatch):
    _, expected = whole(method, {})
    steps = [3 * UPDATE // 4] if method == "pretrained-partners" else [2 * UPDATE // 4]  # of the first part
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", *steps)
        assert run(method, {}, tmp_path / "run") is None
    assert len([*(tmp_path / "run").rglob("result.json")]) == 1
    outcome = run(method, {}, tmp_path / "run", resume=True)
    assert outcome.files.weights.read_bytes() == expected.files.weights.read_bytes()


def test_restarts_and_steps_of_all_parts_are_counted(whole, tmp_path):
    _, outcome = whole("pbt", {})
    assert (outcome.steps, outcome.total_steps) == (4 * UPDATE, 8 * UPDATE)
    assert outcome.total_seconds > outcome.seconds > 0
    restarted = replace(outcome, restarts=1, parts=(replace(outcome, restarts=2, parts=()), outcome.parts[0]))
    assert restarted.total_restarts == 3


def test_a_best_response_does_not_go_on_against_partners_that_were_changed(tmp_path, whole, monkeypatch):
    names = [tmp_path / "partner.safetensors", tmp_path / "partner.json"]
    for method in ("self-play", "biased-self-play"):
        for ours, theirs in zip(names, whole(method, {"observation": "lossless"})[1].files, strict=True):
            ours.write_bytes(theirs.read_bytes())
        others = {"partners": (str(names[0]),)}
        if method == "self-play":
            with monkeypatch.context() as patch:
                press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 20)
                assert run("best-response", others, tmp_path / "run") is None
    with pytest.raises(CheckpointError, match="partner_hashes"):
        run("best-response", others, tmp_path / "run", resume=True)


def test_a_pool_that_scores_is_known_by_every_way_to_name_it():
    for name in ("dev-v0", "dev-v0/cramped_room/sp-0", str(find_pool("dev-v0"))):
        assert scoring_pools(["greedy", name]) == [("dev", "dev-v0")]
    people = [("people", "human-test"), ("people-standard", "human-test")]
    assert scoring_pools(["v1/{layout}/sp-0"]) == [("v1", "v1"), ("v1-lite", "v1")]
    assert scoring_pools(["human-test/{layout}/clone-0"]) == people
    test = read_manifest(find_pool("human-test"))
    assert scoring_pools(["greedy"], people_of(test)[:1]) == people, "partners made from the same people"
    train = people_of(read_manifest(find_pool("human-train")))
    assert scoring_pools(["greedy", "train-v1", "human-train"], train) == [], "of set A: at home with some of v1"


def test_who_is_made_from_the_people_of_a_scoring_pool_has_met_its_partners(monkeypatch):
    monkeypatch.setattr(partners, "people_of", lambda _: ("2019-01",))
    assert ("dev", "dev-v0") in scoring_pools(["greedy"], ["2019-01", "2019-03"])
    assert scoring_pools(["greedy"], ["2019-03"]) == []


def test_scripted_partners_of_a_pool_are_not_trained_with():
    assert len(partner_names(["greedy", "train-v1"], settings("best-response"))) == 1 + 48


@pytest.mark.parametrize(
    "arguments",
    [
        ["best-response", "--partners", "greedy", "dev-v0"],
        ["pretrained-partners", "--pool", "dev-v0"],
        ["population", "--development", "dev-v0"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_training_against_a_pool_that_scores_is_not_done_unwarned(arguments, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(training, "find_method", lambda _: SimpleNamespace(train=lambda *_: None))
    method, *rest = arguments
    assert command(["train", method, "--layout", "cramped_room", *rest, "--output", str(tmp_path / "run")]) == 130
    assert "protocol dev scores with the pool dev-v0" in capsys.readouterr().err


def test_defaults_that_depend_on_the_layout_hold_at_the_command_line(tmp_path, capsys):
    sizes = [f"--{name.replace('_', '-')}={SETTINGS[name]}" for name in SETTINGS if name not in ("layout", "hidden")]
    network = ["--network", "mlp", "--hidden", "16"]
    output = ["--output", str(tmp_path)]
    arguments = ["train", "self-play", "--config", "thesis", "--layout", "cramped_room", *sizes, *network, *output]
    assert command(arguments) == 0
    assert json.loads((tmp_path / "config.json").read_text())["value_coefficient"] == 0.01


def test_every_method_says_what_it_can_be_told(capsys):
    for method in METHODS:
        assert command(["train", method, "--help"]) == 0
        shown = capsys.readouterr().out
        assert f"overcooked-bench train {method}" in shown
        assert all(f"--{field.name.replace('_', '-')}" in shown for field in fields(config_class(method)))
        assert set(described(config_class(method))) == {field.name for field in fields(config_class(method))}
    assert command(["train", "self-pley"]) == 2
    told = capsys.readouterr().err
    assert all(method in told for method in METHODS)


def test_the_weights_of_events_belong_to_the_seed(whole):
    folder, _ = whole("biased-self-play", {})
    config = json.loads((folder / "config.json").read_text())
    drawn = config["event_rewards"]
    assert len(drawn) == 1 + config["restarts"]
    assert len({tuple(weights.values()) for weights in drawn}) > 1
    for weights in drawn:
        assert set(weights) == set(config["biased_events"])
        assert set(weights.values()) <= set(config["bias_weights"])
        assert any(weights.values())


def test_what_events_pay_grows_while_a_biased_run_learns(tmp_path, monkeypatch):
    paid, pay = [], OvercookedVecEnv.set_event_share
    monkeypatch.setattr(OvercookedVecEnv, "set_event_share", lambda env, share: (paid.append(share), pay(env, share)))
    run("biased-self-play", {"check_share": 0.0}, tmp_path)
    config = settings("biased-self-play")
    assert paid == [config.event_share_at(done) for done in range(0, config.steps, UPDATE)]
    assert (paid[0], paid[-1]) == (0, 1)


def test_a_biased_run_that_does_not_deliver_begins_anew_with_other_weights(tmp_path, monkeypatch):
    paid = []

    def make_env(config, **others):
        paid.append(others["event_rewards"])
        return real(config, **others)

    real = biased_self_play.make_env
    monkeypatch.setattr(biased_self_play, "make_env", make_env)
    hopeless = {"horizon": UPDATE // SETTINGS["num_kitchens"], "check_soups": 30.0, "check_share": 0.5, "restarts": 2}
    outcome = run("biased-self-play", hopeless, tmp_path)
    assert outcome.restarts == 2
    assert paid == json.loads((tmp_path / "config.json").read_text())["event_rewards"]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["best-response", "--partners", "greedi"], "did you mean"),
        (["best-response", "--partners", "dev-v0/counter_circuit/sp-0"], "cannot play"),
        (["best-response", "--partners", "greedy", "--per-episode", "1"], "frozen policies"),
        (["self-play", "--config", "thesys"], "did you mean 'thesis'"),
        (["self-play", "--config", "thesis,stack_chanels"], "did you mean 'stack_channels'"),
        (["population", "--development", "dev-v9"], "dev-v9"),
        (["population", "--cooking", "manual"], "or choose other development partners by --development"),
        (["pretrained-partners", "--pool", "dev-v9"], "dev-v9"),
        (["pretrained-partners", "--pool", "greedy"], "'greedy' is no frozen policy"),
        (["pbt", "--layout", TOMATOES, "--agents", "2", "--rounds", "2"], "use 'lossless26'"),
        (["population", "--layout", TOMATOES, "--development", "greedy"], "use 'lossless26'"),
        (["self-play", "--device", "cuda"], "give --device cpu"),
        (["pbt", "--device", "cuda", "--agents", "2", "--rounds", "2"], "give --device cpu"),
        (["human-proxy", "--device", "cuda", "--games", str(MADE)], "give --device cpu"),
        (["human-proxy", "--games", "nowhere.games.jsonl"], "`overcooked-bench games import-2019` writes"),
    ],
)
def test_mistakes_are_answered_without_a_traceback(arguments, told, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("torch.cuda.is_available", lambda: False)
    method, *rest = arguments
    sizes = [
        f"--{name.replace('_', '-')}={SETTINGS[name]}" for name in ("steps", "num_kitchens", "rollout", "minibatches")
    ]
    assert command(["train", method, "--layout", "cramped_room", *sizes, *rest, "--output", str(tmp_path / "run")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_population_is_trained_again_where_it_was_killed_before_the_first_round(tmp_path, monkeypatch):
    config, seed = settings("pbt"), 3
    with monkeypatch.context() as patch:
        patch.setattr("torch.save", lambda *_: pytest.fail("killed"))
        with pytest.raises(pytest.fail.Exception, match="killed"):
            pbt._first_agents(config, tmp_path, seed)
    folders = pbt._first_agents(config, tmp_path, seed)
    again = pbt._first_agents(config, tmp_path / "again", seed)
    for ours, theirs in zip(folders, again, strict=True):
        assert load_policy(ours / "policy").sha256 == load_policy(theirs / "policy").sha256
        assert same(learned(ours / "checkpoint.pt"), learned(theirs / "checkpoint.pt"))


def test_the_initial_agents_of_a_kitchen_without_a_name_lie_in_a_folder_with_one(tmp_path, monkeypatch):
    def trained(configs, place):
        assert place == Place(tmp_path / "initial-custom-7", 7)

    monkeypatch.setattr(population, "self_play_agents", trained)
    config = replace(settings("population"), layout=TOMATOES.replace("T", "O"), development="greedy")
    assert population.train(config, Place(tmp_path / "run", 7)) is None


def test_initial_agents_of_other_settings_are_told_by_the_name_of_their_option(tmp_path):
    config = settings("population")
    initial = tmp_path / "initial-cramped_room-7" / "sp-0"
    initial.mkdir(parents=True)
    write_record(initial / "config.json", {})
    with pytest.raises(CheckpointError, match="--initial"):
        population.train(config, Place(tmp_path / "run", 7))


def test_without_checkpoints_a_pool_gives_its_final_agents_alone(tmp_path):
    config = settings("pretrained-partners", {"pool": "train-v1", "agents": 1})
    with_them, without = (
        pretrained_partners.population(replace(config, checkpoints=on), Place(tmp_path, 0))[0] for on in (True, False)
    )
    assert not any(policy.name.endswith(("-half", "-early")) for policy in without)
    assert 3 * len(without) == len(with_them)
