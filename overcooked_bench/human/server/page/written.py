"""Writes the page of `overcooked-bench play`, which holds all that it needs."""

import json
from collections.abc import Mapping
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from overcooked_bench.human.server.keeping import LICENCE
from overcooked_bench.human.study.plan import Study
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.page import POLICY, page

if TYPE_CHECKING:
    from overcooked_bench.human.server.house import Terms
    from overcooked_bench.human.server.offers import Offers

TITLE = "Play in an Overcooked kitchen"


def play_page(terms: "Terms", offers: Mapping[str, "Offers"], keeps: bool) -> str:
    """Returns the page as HTML.

    Args:
        terms: How games are played.
        offers: By layout, who can be chosen.
        keeps: Whether games of people who agree are kept.
    """
    layouts = [
        {
            "name": name,
            "grid": list(layout.rows),
            "starts": [list(cell) for cell in layout.start_cells],
            "offered": offers[name].offered,
            "refused": offers[name].refused,
            "suggested": offers[name].suggested,
        }
        for name, layout in ((name, Layout.named(name)) for name in terms.layouts)
    ]
    return _page(terms, {"layouts": layouts, "keeps": keeps})


def study_page(terms: "Terms", study: Study) -> str:
    """Returns the page of a study as HTML; it names neither conditions nor partners.

    Args:
        terms: How games are played.
        study: The study.
    """
    return _page(terms, {"keeps": True, "study": {"consent": study.plan.consent}})


def _page(terms: "Terms", given: dict[str, Any]) -> str:
    given = {**given, "licence": LICENCE, "seat": terms.seat, "seconds": round(terms.pace * terms.horizon)}
    data = json.dumps(given, separators=(",", ":")).replace("<", "\\u003c")  # "</script>" would end the element
    viewer = files("overcooked_bench.rendering.viewer").joinpath("kitchen.js").read_text("utf-8")
    here = files(__package__)
    parts = {name: here.joinpath(name).read_text("utf-8") for name in ("play.html", "play.js", "study.js", "play.css")}
    scripts = [
        f'<script type="application/json" id="given">{data}</script>',
        *(f"<script>\n{program}</script>" for program in (viewer, parts["study.js"], parts["play.js"])),
    ]
    body = [f"<h1>{TITLE}</h1>", parts["play.html"], *scripts]
    return page(TITLE, body, parts["play.css"], f"{POLICY}; connect-src 'self'")
