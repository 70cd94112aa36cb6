"""How the agent and its partners cooperate, beside the reference with the same partners."""

from overcooked_bench.evaluation.shown.cooperation import cooperation_table
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.rendering.page import note


def conduct_section(material: Material) -> Section | None:
    """Lays out what both chefs do per episode; None if it was not counted."""
    table = cooperation_table(material.scores, material.reference)
    if table is None:
        return None
    said = (
        "Per episode: soups delivered, ingredients put into pots, objects handed over on a counter; "
        "and the shares of steps in which a chef was blocked by the other, or stayed."
    )
    return Section("How they cooperate", [table.html(), note(said)], {"cooperation": table})
