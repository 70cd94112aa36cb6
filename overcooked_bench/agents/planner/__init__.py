"""The `greedy` planner and its kin: facts about the kitchen, what is most useful, and the way there."""
