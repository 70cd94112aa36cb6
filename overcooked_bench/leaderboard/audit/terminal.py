"""An audit for the terminal: what was checked, what was not, and what is unusual."""

from typing import TYPE_CHECKING, Final

from overcooked_bench.leaderboard.audit.records import Audit
from overcooked_bench.rendering.table import styled

if TYPE_CHECKING:
    from rich.console import Group

_STYLES: Final = {"passed": "green", "failed": "bold red", "not checked": "yellow"}
_MOST: Final = 5
"""Problems of a check that are shown; audit.json lists more."""


def audit_tables(audit: Audit) -> "Group":
    """Lays an audit out within 100 columns."""
    from rich.console import Group, RenderableType
    from rich.table import Table

    table = Table(box=None, padding=(0, 2, 0, 0))
    for heading in ("check", "verdict", "what was compared"):
        table.add_column(heading, header_style="bold", overflow="fold")
    for check in audit.checks:
        table.add_row(styled(check.name), styled(check.verdict, _STYLES[check.verdict]), styled(check.said))
        for problem in check.problems[:_MOST]:
            table.add_row("", "", styled(problem, "red"))
    salt = "a secret salt" if audit.official else "the public salt, so no official run"
    parts: list[RenderableType] = [
        styled(f"{audit.agent.name} · protocol {audit.protocol.name} ({audit.protocol.sha256[:8]})", "bold"),
        table,
        *(styled(f"flag, {flag.kind}{f', {flag.layout}' if flag.layout else ''}: {flag.said}") for flag in audit.flags),
        styled(f"played with {salt}; cells drawn with the seed {audit.seed}", "dim"),
        styled(f"status {audit.status}, table {audit.table}: {_standing(audit)}", "bold"),
    ]
    return Group(*parts)


def _standing(audit: Audit) -> str:
    if audit.withdrawn is not None:
        return f"withdrawn on {audit.withdrawn.date}, {audit.withdrawn.reason}"
    if not audit.sound:
        return "something is wrong"
    return f"{audit.played:,} of {audit.cells:,} cells were played again"
