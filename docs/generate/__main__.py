"""Writes all generated pages and pictures again: `uv run python -m docs.generate`."""

from pathlib import Path

from docs.generate import all_pages
from docs.generate.kitchens import pictures

DOCS = Path(__file__).parents[1]

for name, text in all_pages():
    (DOCS / name).parent.mkdir(exist_ok=True)
    (DOCS / name).write_text(text, "utf-8")
for name, image in pictures():
    image.save(DOCS / name, optimize=True)
