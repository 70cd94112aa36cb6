"""The planner of `greedy` and the couriers: facts about the kitchen, the most useful errand, and the way there."""
