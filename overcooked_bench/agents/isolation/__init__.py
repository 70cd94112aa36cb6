"""Isolation: plays submissions in processes that see observations, return actions, and reach nothing else."""

from typing import Final

HOWS: Final = ("best", "strict")
"""The values of `--isolate`, see `settings.isolate`; here, where reading them imports nothing else."""
