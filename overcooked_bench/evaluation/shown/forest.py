"""A forest plot as SVG: differences with their intervals, one below the other, around a line at 0.

It is drawn narrow, with its labels above the bars, so that its text keeps its size on a phone.
"""

from collections.abc import Sequence
from html import escape
from math import ceil, floor, log10
from typing import Final, NamedTuple

from overcooked_bench.estimate import Estimate

STYLE: Final = (
    "figure.forest { max-width: 32rem; } figure.forest text { font: 12px system-ui, sans-serif; paint-order: stroke; "
    "stroke: var(--paper); stroke-width: 4px; }"
)
"""CSS of a page with forest plots."""

_WIDTH: Final = 360
_LEAST: Final = 1e-6  # a smaller span is drawn as none: its scale would be no number
_MARGIN: Final = 14
_ROW: Final = 40
_TOP: Final = 26
_MARK: Final = "#0072B2"


class Bar(NamedTuple):
    """One row.

    Attributes:
        label: What it is about.
        difference: The number and its interval.
        text: The same in words, at the right.
        strong: Whether it sums the others up.
    """

    label: str
    difference: Estimate
    text: str
    strong: bool = False


def forest(bars: Sequence[Bar], left: str, right: str) -> str:
    """Draws bars, in the page's colours; a mark is filled if its interval excludes 0.

    Args:
        bars: From top to bottom, one at least.
        left: What a difference below 0 means.
        right: What one above 0 means.
    """
    ends = [end for bar in bars for end in bar.difference if end is not None]
    low, high = min(0.0, *ends), max(0.0, *ends)
    if high - low < _LEAST:
        low, high = -1.0, 1.0
    scale = (_WIDTH - 2 * _MARGIN) / (high - low)

    def x(value: float) -> float:
        return round(_MARGIN + (value - low) * scale, 2)

    bottom = _TOP + _ROW * len(bars)
    parts = [
        f'<text x="0" y="12" fill="var(--dim)">← {escape(left)}</text>',
        f'<text x="{_WIDTH}" y="12" text-anchor="end" fill="var(--dim)">{escape(right)} →</text>',
    ]
    for tick in _ticks(low, high):
        at = x(tick)
        line = "var(--dim)" if tick == 0 else "var(--line)"
        parts.append(f'<line x1="{at}" x2="{at}" y1="{_TOP - 6}" y2="{bottom}" stroke="{line}"/>')
        parts.append(f'<text x="{at}" y="{bottom + 16}" text-anchor="middle" fill="var(--dim)">{tick:g}</text>')
    for index, bar in enumerate(bars):
        parts += _row(
            bar, _TOP + _ROW * index, x(bar.difference.value), [x(end) for end in bar.difference.interval or ()]
        )
    words = escape("; ".join(f"{bar.label}: {bar.text}" for bar in bars), quote=True)
    return (
        f'<figure class="forest"><svg viewBox="0 0 {_WIDTH} {bottom + 22}" role="img" aria-label="{words}">'
        + "".join(parts)
        + "</svg></figure>"
    )


def _row(bar: Bar, top: int, at: float, ends: Sequence[float]) -> list[str]:
    y, weight = top + 26, ' font-weight="600"' * bar.strong
    low, high = bar.difference.interval or (-1.0, 1.0)
    fill = _MARK if low > 0 or high < 0 else "var(--paper)"
    parts = [
        f'<text x="0" y="{top + 12}" fill="currentColor"{weight}>{escape(bar.label)}</text>',
        f'<text x="{_WIDTH}" y="{top + 12}" text-anchor="end" fill="currentColor"{weight}>{escape(bar.text)}</text>',
    ]
    if ends:
        parts.append(f'<line x1="{ends[0]}" x2="{ends[1]}" y1="{y}" y2="{y}" stroke="{_MARK}" stroke-width="2"/>')
    radius = 5.5 if bar.strong else 4.5
    parts.append(f'<circle cx="{at}" cy="{y}" r="{radius}" fill="{fill}" stroke="{_MARK}" stroke-width="2"/>')
    return parts


def _ticks(low: float, high: float) -> list[float]:
    """Returns three to six round numbers from `low` to `high`, 0 among them."""
    rough = (high - low) / 5
    power = 10.0 ** floor(log10(rough))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= rough)
    return [round(index * step, 10) for index in range(ceil(low / step - 1e-9), floor(high / step + 1e-9) + 1)]
