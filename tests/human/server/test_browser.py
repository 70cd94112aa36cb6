"""The page in a real browser: a game played by keyboard, what is kept of it, and how the page looks."""

import json
import subprocess
import sys
from itertools import pairwise

import pytest

from overcooked_bench.human.games import read_games
from overcooked_bench.human.server.house import Terms

from .serving import running

ONE_SOUP = "LUSUI" "DRRUUI"  # filled in below
KEYS = {"U": "ArrowUp", "D": "ArrowDown", "R": "ArrowRight", "L": "ArrowLeft", "I": "Space"}
pytestmark = pytest.mark.slow


@pytest.fixture
def visited(browser):
    """Opens an address: `visited(address, width=390)`; the test fails if the page has an error."""
    contexts, problems = [], []

    def opener(address, width=1280, height=900, dark=False, **more):
        scheme = "dark" if dark else "light"
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, **more)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("console", lambda said: problems.append(said.text) if said.type == "error" else None)
        page.goto(address)
        return page

    yield opener
    for context in contexts:
        context.close()
    assert problems == []


def begin(page, consent="#agree", **choices):
    page.click(consent)
    for field, value in choices.items():
        page.select_option(f"#{field}", value)
    page.click("button[type=submit]")
    page.wait_for_selector("#kitchen:visible")


def steps_shown(page):
    return int(page.get_attribute("#kitchen", "aria-label").split("step ")[1].split(" ")[0])
