"""The network of stable-baselines3's `CnnPolicy`; `test_export` compares it with real models."""

import numpy as np
import pytest

from overcooked_bench.agents.policies.nature import NatureCnn
from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import Policy
from tests.agents.made import random_weights

SMALL = {"observation": "lossless", "layout": "x", "cooking": "auto", "features": 7, "hidden": (5,)}


def test_policies_of_a_stack_do_not_mix():
    architecture = NatureCnn(**SMALL, observation_shape=(3, 36, 40))
    policies = [
        Policy(
            str(seed),
            architecture,
            {name: array.astype(np.float32) for name, array in random_weights(architecture, seed).items()},
            "",
        )
        for seed in range(3)
    ]
    seen, rows = np.random.default_rng(0).integers(0, 2, (5, 3, 36, 40)), [2, 0, 1, 0, 2]
    together = PolicyStack(policies).assign(rows).probabilities(seen)
    alone = [PolicyStack([policies[k]]).assign([0]).probabilities(seen[[i]])[0] for i, k in enumerate(rows)]
    np.testing.assert_allclose(together, alone, rtol=1e-4, atol=1e-6)
    assert len(np.unique(together.round(4), axis=0)) == 5


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"observation_shape": (22, 35, 40)}, "at least 36 rows and columns"),
        ({"observation_shape": (96,)}, "at least 36 rows and columns"),
        ({"observation_shape": (3, 36, 36), "features": 0}, "features is"),
        ({"observation_shape": (3, 36, 36), "hidden": (0,)}, "hidden is"),
    ],
)
def test_impossible_networks_are_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        NatureCnn(**{**SMALL, **changes})
