"""The skeleton of every HTML page: one file that needs nothing else, readable on a phone, in light and in dark."""

import re
from collections.abc import Iterable
from html import escape
from typing import Final

STYLE: Final = """
:root { color-scheme: light dark; --ink: #1c1e21; --paper: #fff; --line: #8883; --dim: #667; --soft: #8881; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e4e6e9; --paper: #15171a; --dim: #9aa0a8; }
}
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 68rem;
  margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; overflow-wrap: anywhere; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; }
h3 { font-size: 1rem; margin: 1.4rem 0 .3rem; }
a { color: inherit; text-underline-offset: .2em; }
nav { font-size: .9rem; } nav a { display: inline-block; margin: 0 .9rem .2rem 0; }
p.sub, p.note, td small { color: var(--dim); } p.sub { margin-top: .2rem; overflow-wrap: anywhere; }
p.note { margin: .2rem 0; font-size: .9rem; max-width: 46rem; }
p.warn { margin: .6rem 0; padding: .4rem .8rem; border-left: .25rem solid #d55e00; background: var(--soft); }
div.wide { overflow-x: auto; } div.wide + div.wide { margin-top: 1.2rem; } div.wide + p.note { margin-top: .8rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .8rem .25rem 0; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap;
  vertical-align: baseline; }
.left, td.code { text-align: left; }
th { font-weight: 600; font-size: .9rem; vertical-align: bottom; white-space: normal; }
tr > :first-child { position: sticky; left: 0; background: var(--paper); }
tr.sum td { font-weight: 600; }
code { font-size: .85rem; user-select: all; overflow-wrap: anywhere; }
figure { margin: 0; } figure svg { width: 100%; height: auto; display: block; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; font-size: .9rem; }
dt { color: var(--dim); } dd { margin: 0; overflow-wrap: anywhere; }
summary { cursor: pointer; margin: .4rem 0; }
@media (max-width: 40rem) { body { margin: 1rem auto; } dl { display: block; } dd { margin-bottom: .4rem; }
  table { font-size: .85rem; } th, td { padding-right: .5rem; } th { font-size: .8rem; }
  tr > .left:first-child { white-space: normal; } td small { display: block; } }
@media print { :root { color-scheme: light; } body { max-width: none; margin: 0; font-size: 11pt; }
  nav { display: none; }
  figure, tr, h2, h3 { break-inside: avoid; } h2, h3 { break-after: avoid; } }
"""

POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""What a browser lets a page do: nothing but to show what is in its file, whatever names it shows say."""


def page(title: str, body: Iterable[str], style: str = "", policy: str = POLICY) -> str:
    """Writes a page.

    Args:
        title: Its title, as text.
        body: Its parts, as HTML.
        style: CSS besides `STYLE`.
        policy: What a browser lets the page do.
    """
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<style>{STYLE}{style}</style></head>\n'
        "<body><main>\n" + "\n".join(body) + "\n</main></body></html>\n"
    )


def section(title: str, *parts: str) -> list[str]:
    """Returns a heading and its parts, as HTML; nothing if all parts are empty."""
    return [f'<h2 id="{anchor(title)}">{escape(title)}</h2>', *parts] if any(parts) else []


def anchor(title: str) -> str:
    """Returns the name by which a page links to a section."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def contents(titles: Iterable[str]) -> str:
    """Returns links to sections of the page, by their titles."""
    links = "".join(f'<a href="#{anchor(title)}">{escape(title)}</a>' for title in titles)
    return f'<nav aria-label="Sections">{links}</nav>'


def note(text: str, kind: str = "note") -> str:
    """Returns a paragraph.

    Args:
        text: What it says, as text.
        kind: "note", "sub" or "warn".
    """
    return f'<p class="{kind}">{escape(text)}</p>'


def definitions(entries: Iterable[tuple[str, str]]) -> str:
    """Returns a list of names and what they are, both as text."""
    return "<dl>" + "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in entries) + "</dl>"
