"""What `pytest --pyargs overcooked_bench.unit_scenarios --agent my_agent.py` collects: every scenario of this folder."""

from overcooked_bench.scenarios.pytest_plugin import Scenarios

test_scenarios = Scenarios()
