"""A headless Chromium for the tests of pages; they are skipped where there is none."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A browser without network; its pages are opened by `opened`."""
    installed = next(filter(None, map(shutil.which, BROWSERS)), None)
    if installed is None:
        pytest.skip("no Chromium is installed; on Debian: apt-get install chromium")
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is in the dependency group dev")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=installed, args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture
def visited(browser: Any) -> Iterator[Any]:
    """Opens an address: `visited(address, width=390, dark=True)`; the test fails if the page has an error.

    With `alone=True` it fails too if the page asks for anything but itself.
    """
    contexts = []
    problems: list[str] = []

    def opener(
        address: str, width: int = 1280, height: int = 900, dark: bool = False, alone: bool = False, **more: Any
    ) -> Any:
        scheme = "dark" if dark else "light"
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, **more)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("console", lambda said: problems.append(said.text) if said.type == "error" else None)
        page.on("request", lambda asked: problems.append(asked.url) if alone and asked.url != address else None)
        page.goto(address)
        return page

    yield opener
    for context in contexts:
        context.close()
    assert problems == []


@pytest.fixture
def opened(visited: Any) -> Any:
    """Opens a file that needs nothing else: `opened(path, width=390)`."""
    return lambda file, *given, **more: visited(file.as_uri(), *given, alone=True, **more)
