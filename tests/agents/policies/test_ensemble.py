"""Ensembles play as their policies do one by one; sampled partners depend on their seeds alone."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import UnknownLayout
from overcooked_bench.agents.policies.ensemble import Ensemble, SampledPartners
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import load_policy, save_policy
from tests.agents.made import make_policy, random_weights, small_cnn, small_mlp

LAYOUT = "cramped_room"
KINDS = (small_mlp(), small_cnn(), small_mlp(hidden=(9,), activation="tanh"))


@pytest.fixture(scope="module")
def policies(tmp_path_factory):
    """Six policies of three architectures, mixed."""
    folder = tmp_path_factory.mktemp("ensemble")
    found = []
    for i in range(6):
        weights = {name: 10 * w for name, w in random_weights(KINDS[i % 3], i).items()}
        found.append(load_policy(save_policy(folder / f"policy-{i}", KINDS[i % 3], weights).weights))
    return found


def seen(rows, seed=0):
    return np.random.default_rng(seed).integers(0, 2, (rows, 22, 4, 5), dtype=np.uint8)


def seeds_of(rows, start=100):
    return np.arange(start, start + rows, dtype=np.uint64)


def played(agent, rows, steps=12, start=100):
    agent.reset(LAYOUT, np.zeros(rows, np.int64), seeds_of(rows, start))
    return np.stack([agent.act(seen(rows, step)) for step in range(steps)], axis=1)


@pytest.mark.parametrize("mode", ["sample", "greedy"])
@settings(max_examples=15, deadline=None)
@given(index=st.lists(st.integers(0, 5), min_size=1, max_size=10))
def test_a_row_plays_as_its_policy_alone(policies, mode, index):
    ensemble = Ensemble(policies, mode)
    ensemble.assign(index)
    together = played(ensemble, len(index))
    assert together.dtype == np.int64
    assert ensemble.members_of_rows.tolist() == index
    for row, member in enumerate(index):
        alone = NeuralAgent(policies[member], mode)
        alone.reset(LAYOUT, np.zeros(1, np.int64), seeds_of(len(index))[row : row + 1])
        assert [alone.act(seen(len(index), step)[row : row + 1])[0] for step in range(12)] == together[row].tolist()


def test_rows_are_dealt_out_anew_at_the_next_reset(policies):
    ensemble = Ensemble(policies)
    for index in ([0, 1, 2, 3], [5, 5], [4, 0, 4]):
        ensemble.assign(index)
        first = played(ensemble, len(index))
        assert ensemble.members_of_rows.tolist() == index
        assert (played(ensemble, len(index)) == first).all()


def test_one_policy_needs_no_index(policies):
    alone = NeuralAgent(policies[1])
    assert (played(Ensemble(policies[1:2]), 4) == played(alone, 4)).all()


def test_an_ensemble_refuses_what_it_cannot_play(policies, tmp_path):
    with pytest.raises(ValueError, match="at least one policy"):
        Ensemble([])
    with pytest.raises(ValueError, match="choose 'sample' or 'greedy'"):
        Ensemble(policies, "best")
    with pytest.raises(ValueError, match=r"'lossless' on 'cramped_room', and 'policy-0' sees 'lossless26'"):
        Ensemble([*policies, make_policy(tmp_path, observation="lossless26", shape=(26, 4, 5))])
    ensemble = Ensemble(policies)
    with pytest.raises(ValueError, match=r"assign\(index\)"):
        ensemble.reset(LAYOUT, np.zeros(2, np.int64), seeds_of(2))
    with pytest.raises(ValueError, match="before reset"):
        ensemble.act(seen(1))
    for index, named in (([0, 6], "policy 6"), ([-1, 0], "policy -1"), ([0.5], "float64"), ([], "number per row")):
        with pytest.raises(ValueError, match=named):
            ensemble.assign(index)
    ensemble.assign([0, 1, 2])
    with pytest.raises(ValueError, match="2 episodes, but"):
        ensemble.reset(LAYOUT, np.zeros(2, np.int64), seeds_of(2))
    with pytest.raises(UnknownLayout, match="trained on 'cramped_room'"):
        ensemble.reset("counter_circuit", np.zeros(3, np.int64), seeds_of(3))
    ensemble.reset(LAYOUT, np.zeros(3, np.int64), seeds_of(3))
    with pytest.raises(ValueError, match="4 observations for 3 episodes"):
        ensemble.act(seen(4))


@settings(max_examples=30, deadline=None)
@given(per_episode=st.integers(1, 6), rows=st.integers(6, 20), start=st.integers(0, 2**63))
def test_sampled_partners_are_drawn_by_the_seeds_alone(policies, per_episode, rows, start):
    partners, others = SampledPartners(policies, per_episode), SampledPartners(policies, per_episode)
    first = played(partners, rows, steps=3, start=start)
    members = partners.members_of_rows
    played(partners, rows + 1, steps=1, start=start + 1)
    assert (played(partners, rows, steps=3, start=start) == first).all()
    assert (played(others, rows, steps=3, start=start) == first).all()
    assert (others.members_of_rows == members).all()
    changes = np.flatnonzero(np.diff(members)) + 1
    groups = np.split(members, changes)
    assert len({int(group[0]) for group in groups}) == len(groups) == per_episode
    assert max(map(len, groups)) - min(map(len, groups)) <= 1


def test_every_partner_and_every_order_is_drawn_equally_often(policies):
    partners = SampledPartners(policies, 3)
    drawn = []
    for start in range(1200):
        partners.reset(LAYOUT, np.zeros(3, np.int64), seeds_of(3, start))
        drawn.append(tuple(partners.members_of_rows))
    for place in range(3):
        counts = np.bincount([members[place] for members in drawn], minlength=6)
        assert abs(counts - 200).max() < 60
    assert len(set(drawn)) > 110  # of 120


def test_sampled_partners_play_as_their_policies(policies):
    partners = SampledPartners(policies, 4, mode="greedy")
    ours = played(partners, 8)
    ensemble = Ensemble(policies, "greedy")
    ensemble.assign(partners.members_of_rows)
    assert (ours == played(ensemble, 8)).all()


def test_sampled_partners_refuse_what_cannot_be_drawn(policies):
    for per_episode in (0, 7):
        with pytest.raises(ValueError, match="from 1 up to theirs"):
            SampledPartners(policies, per_episode)
    with pytest.raises(ValueError, match="3 members for 2 episodes"):
        SampledPartners(policies).reset(LAYOUT, np.zeros(2, np.int64), seeds_of(2))
    with pytest.raises(ValueError, match="use Ensemble"):
        SampledPartners(policies).assign([0])
