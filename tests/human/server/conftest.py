"""A browser at the page of a server."""

import pytest


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
