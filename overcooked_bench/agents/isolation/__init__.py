"""Isolation: plays submissions in processes that see observations, return actions, and reach nothing else."""
