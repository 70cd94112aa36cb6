"""What all pages of the site share: their style, their links to each other, and programs at their end."""

from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from importlib.resources import files
from typing import Final

from overcooked_bench.rendering.page import page

STYLE: Final = """
body { max-width: 84rem; }
form.filters { display: flex; flex-wrap: wrap; gap: .5rem .9rem; align-items: end; margin: 1rem 0; }
form.filters label { display: grid; font-size: .85rem; color: var(--dim); max-width: 100%; }
form.filters input, form.filters select, form.filters button { font: inherit; font-size: .95rem; color: var(--ink);
  background: var(--paper); border: 1px solid var(--dim); border-radius: 4px; padding: .2rem .4rem; max-width: 100%; }
form.filters input { width: 8.5rem; } form.filters select { max-width: min(16rem, 88vw); }
button.sort { font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer;
  text-align: inherit; text-decoration: underline dotted; text-underline-offset: .2em; }
th[aria-sort=descending] button::after { content: " \\2193"; } th[aria-sort=ascending] button::after
  { content: " \\2191"; }
:focus-visible { outline: 2px solid #0072B2; outline-offset: 2px; }
section.old table, section.old h3 { color: var(--dim); }
tr[data-status=withdrawn] .score { text-decoration: line-through; }
td.remark { white-space: normal; min-width: 12rem; text-align: left; }
table.board td:first-child { min-width: 6rem; }
[hidden] { display: none !important; }
div.panels svg { width: 100%; height: auto; } .tick { font-size: 10px; fill: var(--dim); }
.first::before, .second::before { content: ""; display: inline-block; width: 1.4rem; margin-right: .4rem;
  vertical-align: .25em; border-top: .2rem solid #0072B2; }
.second::before { border-top: .2rem dashed #D55E00; }
"""


def whole(title: str, body: Iterable[str], up: str = "", style: str = "") -> str:
    """Writes a page of the site.

    Args:
        title: Its title, as text.
        body: Its parts, as HTML.
        up: What leads from its folder to that of the index: "" or "../".
        style: CSS besides that of the site.
    """
    links = {"Leaderboard": "index.html", "JSON": "table.json", "CSV": "table.csv", "Feed": "feed.xml"}
    shown = "".join(f'<a href="{up}{file}">{name}</a>' for name, file in links.items())
    return page(title, [f'<nav aria-label="Site">{shown}</nav>', *body], style + STYLE)


@cache
def program(name: str) -> str:
    """Returns a program of this folder as the end of a page."""
    text = files("overcooked_bench.leaderboard.site").joinpath(name).read_text("utf-8")
    return f"<script>\n{text}</script>"


def choice(name: str, label: str, options: Sequence[tuple[str, str]], everything: str = "all") -> str:
    """Returns a field of a form that offers values, each with its text; the empty value stands for everything."""
    listed = "".join(f'<option value="{escape(value)}">{escape(text)}</option>' for value, text in options)
    return (
        f'<label>{escape(label)}<select name="{name}"><option value="">{everything}</option>{listed}</select></label>'
    )
