"""Whoever can sit on a seat: the contract of agents and what helps to keep it."""

from overcooked_bench.agents.agent import Agent, UnknownLayout, one_game_at_a_time, sample_actions, uniforms

__all__ = ["Agent", "UnknownLayout", "one_game_at_a_time", "sample_actions", "uniforms"]
