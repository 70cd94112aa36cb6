import pytest
import torch

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.running.checkpoint import load_checkpoint, save_checkpoint
from overcooked_bench.baselines.running.place import Place
from overcooked_bench.baselines.running.run import UnfitError
from overcooked_bench.baselines.self_play import train
from overcooked_bench.cli import main as command
from tests.baselines.tiny import SEED, UPDATE, self_play, tiny, tiny_learner

on_a_gpu = pytest.mark.skipif(not torch.cuda.is_available(), reason="torch finds no GPU")
ROLLOUT = UPDATE // 4


def filled(device, network):
    """A learner after its first rollout, before its first update."""
    model = tiny_learner(tiny(device=device, network=network), 3)
    env = model.get_env()
    _, callback = model._setup_learn(2 * UPDATE, None)
    assert model.collect_rollouts(env, callback, model.rollout_buffer, ROLLOUT)
    return model


@on_a_gpu
@pytest.mark.parametrize("network", ["mlp", "cnn"])
def test_a_gpu_learns_what_the_processor_does(network):
    there, here = (filled(device, network) for device in ("cuda", "cpu"))
    theirs, ours = there.rollout_buffer, here.rollout_buffer
    kept = [theirs.seen, theirs.logs, theirs.judged, *there._whole_batch(), *there.policy.state_dict().values()]
    assert all(tensor.device.type == "cuda" for tensor in kept)
    assert theirs.seen.dtype == torch.uint8
    assert theirs.seen.cpu().equal(ours.seen)
    assert (theirs.actions == ours.actions).all()
    torch.testing.assert_close(theirs.logs.cpu(), ours.logs, atol=1e-4, rtol=1e-4)
    before = there.policy.action_net.weight.clone()
    for model in (there, here):
        torch.manual_seed(0)  # how the samples are shuffled
        model.train()
    assert not there.policy.action_net.weight.equal(before)
    for theirs, ours in zip(there.policy.parameters(), here.policy.parameters(), strict=True):
        torch.testing.assert_close(theirs.cpu(), ours, atol=1e-3, rtol=1e-3)


@on_a_gpu
def test_a_run_on_a_gpu_is_saved_resumed_and_frozen(tmp_path):
    model = filled("cuda", "mlp")
    model.train()
    save_checkpoint(tmp_path / "checkpoint.pt", model, {})
    again = tiny_learner(tiny(device="cuda"), 4)
    load_checkpoint(tmp_path / "checkpoint.pt", again, {})
    for theirs, ours in zip(again.policy.parameters(), model.policy.parameters(), strict=True):
        assert theirs.device.type == "cuda"
        assert theirs.equal(ours)
    again.learn(UPDATE, reset_num_timesteps=False)
    outcome = train(tiny(device="cuda"), Place(tmp_path / "run", SEED))
    assert load_policy(outcome.files.weights).weights


def test_a_gpu_that_is_not_there_is_not_replaced_in_silence(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(UnfitError, match="torch finds no GPU here; give --device cpu"):
        train(tiny(device="cuda"), Place(tmp_path, SEED))
    assert command(self_play("--device", "cuda", "--output", str(tmp_path / "run"))) == 2
    assert "torch finds no GPU here" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
