"""What `pytest --pyargs overcooked_bench.unit_scenarios --agent my_agent.py` collects: all scenarios here."""

from overcooked_bench.scenarios.plugin.hooks import Scenarios

test_scenarios = Scenarios()
