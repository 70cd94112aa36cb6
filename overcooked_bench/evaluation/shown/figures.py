"""`Plot`: drawn by matplotlib, as a file, or as an element of a page in the colours of its theme."""

import re
from collections.abc import Callable
from html import escape
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final, Literal, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
"""Seven colours that people with any colour vision can distinguish.

Source: Okabe and Ito 2008, "Color Universal Design".
"""
INK: Final = "#333333"
DIM: Final = "#666666"
LINE: Final = "#999999"
GRID: Final = "#eeeeee"

FORMS: Final = ("png", "svg")
_DPI: Final = 150
_MOST_PIXELS: Final = 60_000
"""Pixels of a side; matplotlib draws no more than 2^16."""
_FACTS: Final = {"png": ["Software"], "svg": ["Date", "Creator", "Format", "Type"]}
"""Format of a file -> what matplotlib would write into it besides the plot."""

_STYLE: Final[Any] = {
    "svg.hashsalt": "overcooked_bench",
    "font.size": 9,
    "font.family": "DejaVu Sans",
    "text.parse_math": False,  # a file's name may hold dollar signs
    **dict.fromkeys(("text.color", "axes.labelcolor", "xtick.color", "ytick.color", "axes.edgecolor"), INK),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
}
_BY_THEME: Final = {
    INK: "currentColor",
    "#000000": "currentColor",
    DIM: "var(--dim)",
    LINE: "var(--dim)",
    GRID: "var(--line)",
}
"""Colours of a plot -> what they become on a page that is light or dark."""


_LONGEST: Final = 26
"""Characters of a name beside a plot; a kitchen of somebody else is called by the path of its file."""


def short_name(name: str) -> str:
    """Returns the end of a name that is too long to stand beside a plot."""
    return name if len(name) <= _LONGEST else "…" + name[1 - _LONGEST :]


class Plot(NamedTuple):
    """A plot.

    Attributes:
        paint: Draws it on an empty figure.
        size: Width and height, inches.
        said: What it shows, for people who cannot see it.
    """

    paint: "Callable[[Figure], None]"
    size: tuple[float, float]
    said: str

    def save(self, file: str | Path | IO[bytes], form: str = "png") -> None:
        """Draws it into a file; the same plot always makes the same bytes.

        Args:
            file: Where to.
            form: "png" or "svg".
        """
        self._save(file, form)

    def element(self) -> str:
        """Returns it as an element of a page, without a background, in the page's font and colours of text."""
        buffer = BytesIO()
        self._save(buffer, "svg", "none")
        svg = buffer.getvalue().decode()
        used = set(re.findall(r"#([\w.-]+)[\")]", svg))
        svg = re.sub(r' id="([^"]*)"', lambda name: name[0] if name[1] in used else "", svg[svg.index("<svg") :])
        svg = re.sub(r"#[0-9a-f]{6}\b", lambda colour: _BY_THEME.get(colour[0], colour[0]), svg)
        svg = svg.replace("'DejaVu Sans'", "system-ui")
        spoken = f'<svg role="img" aria-label="{escape(self.said)}" '
        return f"<figure>{svg.replace('<svg ', spoken, 1)}</figure>"

    def _save(self, file: str | Path | IO[bytes], form: str, letters: Literal["path", "none"] = "path") -> None:
        """Saves it with its letters as shapes, which look the same everywhere, or as text."""
        import matplotlib
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        with matplotlib.rc_context({**_STYLE, "svg.fonttype": letters}):
            dpi = min(_DPI, _MOST_PIXELS / max(self.size))
            figure = Figure(figsize=self.size, dpi=dpi, layout="constrained")
            FigureCanvasAgg(figure)
            self.paint(figure)
            figure.savefig(file, format=form, metadata=dict.fromkeys(_FACTS[form]), transparent=form == "svg")
