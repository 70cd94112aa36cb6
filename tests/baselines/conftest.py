import pytest
import torch

from overcooked_bench.baselines.running.place import Place
from overcooked_bench.baselines.self_play import train
from tests.baselines.tiny import SEED, tiny


@pytest.fixture(autouse=True, scope="session")
def one_thread():
    """Training takes one core; tests that use a network without training should too."""
    torch.set_num_threads(1)


@pytest.fixture(scope="session")
def whole_run(tmp_path_factory):
    """The folder of a run that was never interrupted, with what `train` gave."""
    folder = tmp_path_factory.mktemp("whole")
    return folder, train(tiny(), Place(folder, SEED))
