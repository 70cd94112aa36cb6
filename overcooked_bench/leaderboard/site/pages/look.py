"""What all pages of the site share: their style, their links to each other, and programs at their end."""

from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from importlib.resources import files
from typing import Final

from overcooked_bench.rendering.page import page

TITLE: Final = "overcooked-bench leaderboard"

STYLE: Final = """
body { max-width: 84rem; }
nav.site { border-bottom: 1px solid var(--line); padding-bottom: .3rem; margin-bottom: 1.2rem; }
form.filters { display: flex; flex-wrap: wrap; gap: .5rem .9rem; align-items: end; margin: 1rem 0 .6rem; }
form.filters label { display: grid; font-size: .85rem; color: var(--dim); max-width: 100%; }
form.filters label.tick { display: flex; gap: .4rem; align-items: center; min-height: 2.1rem; }
form.filters input, form.filters select, form.filters button { font: inherit; font-size: .95rem; color: var(--ink);
  background: var(--paper); border: 1px solid var(--dim); border-radius: 4px; padding: .2rem .4rem; max-width: 100%;
  height: 2.1rem; box-sizing: border-box; }
form.filters label.tick input { height: auto; }
form.filters input[type=search], form.filters input[type=number] { width: 8.5rem; }
form.filters select { max-width: min(16rem, 88vw); }
button.sort { font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer;
  text-align: inherit; text-decoration: underline dotted; text-underline-offset: .2em; }
th[aria-sort=descending] button::after { content: " \\2193"; } th[aria-sort=ascending] button::after
  { content: " \\2191"; }
:focus-visible { outline: 2px solid #0072B2; outline-offset: 2px; }
.old table, .old h3, nav .old { color: var(--dim); }
tr[data-status=withdrawn] .score { text-decoration: line-through; }
td.remark { white-space: normal; min-width: 24rem; text-align: left; }
table.board td:first-child { min-width: 6rem; }
[hidden], table.few .more, table.board .on { display: none; }
div.panels svg { width: 100%; height: auto; } .tick { font-size: 10px; fill: var(--dim); }
.first::before, .second::before { content: ""; display: inline-block; width: 1.4rem; margin-right: .4rem;
  vertical-align: .25em; border-top: .2rem solid #0072B2; }
.second::before { border-top: .2rem dashed #D55E00; }
canvas.still { max-width: 100%; height: auto; border-radius: 4px; display: block; margin: .8rem 0; }
pre { line-height: 1.1; }
@media (max-width: 40rem) { form.filters label { flex: 1 1 44%; } form.filters input[type=search],
  form.filters input[type=number], form.filters select { width: 100%; max-width: none; } }
"""


def whole(title: str, body: Iterable[str], up: str = "", style: str = "") -> str:
    """Writes a page of the site.

    Args:
        title: Its title, as text.
        body: Its parts, as HTML.
        up: What leads from its folder to that of the index: "" or "../".
        style: CSS besides that of the site.
    """
    links = {
        "Leaderboard": "index.html",
        "Errata": "errata.html",
        "JSON": "table.json",
        "CSV": "table.csv",
        "Feed": "feed.xml",
    }
    shown = "".join(f'<a href="{up}{file}">{name}</a>' for name, file in links.items())
    return page(title, [f'<nav class="site" aria-label="Site">{shown}</nav>', *body], style + STYLE)


@cache
def program(name: str) -> str:
    """Returns a program of this folder as the end of a page."""
    text = files("overcooked_bench.leaderboard.site.pages").joinpath(name).read_text("utf-8")
    return f"<script>\n{text}</script>"


def choice(name: str, label: str, options: Sequence[tuple[str, str]], everything: str = "all") -> str:
    """Returns a field of a form that offers values, each with its text; the empty value stands for everything."""
    listed = "".join(f'<option value="{escape(value)}">{escape(text)}</option>' for value, text in options)
    return (
        f'<label>{escape(label)}<select name="{name}"><option value="">{everything}</option>{listed}</select></label>'
    )


def link(address: str, text: str) -> str:
    """Returns a link to an address of the site, as HTML."""
    return f'<a href="{escape(address)}">{escape(text)}</a>'


def outside(address: str) -> str:
    """Returns an address that a stranger wrote as a link if it is one of https, else as text."""
    shown = escape(address)
    if not address.startswith("https://"):
        return shown
    return f'<a href="{shown}" rel="nofollow noopener noreferrer">{shown}</a>'
