"""Writes the page of `overcooked-bench play`, which holds all that it needs."""

import json
from collections.abc import Mapping
from importlib.resources import files
from typing import TYPE_CHECKING

from overcooked_bench.human.server.keeping import LICENCE
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
        }
        for name, layout in ((name, Layout.named(name)) for name in terms.layouts)
    ]
    given = {"layouts": layouts, "keeps": keeps, "licence": LICENCE, "seconds": round(terms.pace * terms.horizon)}
    data = json.dumps(given, separators=(",", ":")).replace("<", "\\u003c")  # "</script>" would end the element
    viewer = files("overcooked_bench.rendering.viewer").joinpath("kitchen.js").read_text("utf-8")
    parts = {
        name: files(__package__).joinpath(name).read_text("utf-8") for name in ("play.html", "play.js", "play.css")
    }
    scripts = [
        f'<script type="application/json" id="given">{data}</script>',
        f"<script>\n{viewer}</script>",
        f"<script>\n{parts['play.js']}</script>",
    ]
    body = [f"<h1>{TITLE}</h1>", parts["play.html"], *scripts]
    return page(TITLE, body, parts["play.css"], f"{POLICY}; connect-src 'self'")
