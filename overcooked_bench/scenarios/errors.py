"""Errors of scenario files, and of the agents that play scenarios."""

from overcooked_bench.errors import AgentFault, WrongUse


class ScenarioError(WrongUse):
    """A scenario cannot be found or read; the message names the file and the line, and says what to write instead."""


class ScenarioFault(AgentFault):
    """The tested agent broke the contract while it played a scenario."""
