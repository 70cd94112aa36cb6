import pytest

from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.entrant import agent_maker, identify


def test_a_script_can_be_scored_under_a_name_for_folders():
    reference = "script:{does: onions, insist: true}"
    entrant = identify(reference)
    assert (entrant.reference, entrant.name, entrant.layout) == (reference, "script-does-onions-insist-true", None)
    assert identify("script:onions").sha256 != entrant.sha256
    agent = agent_maker(reference, entrant.sha256, "sample")("cramped_room", 0)
    assert agent.observation == "state"
    with pytest.raises(AgentError, match="changed while it was being scored"):
        agent_maker(reference, "0" * 64, "sample")
    with pytest.raises(AgentError, match="'fly' is no behaviour"):
        identify("script:fly")
