"""Trainings in other projects' kitchens: the programs, how they are started, and how their weights become policies."""
