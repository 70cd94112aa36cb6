"""The pictures of `results/human.md`: soups of each pair and each proxy, and where they spend their time."""

from collections.abc import Sequence
from io import BytesIO
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.human.conduct import PER
from overcooked_bench.human.shown import name
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.picture import draw_layout
from overcooked_bench.rendering.sprites import CHEF_COLOURS

from .crowds import Crowd
from .foretold import CLONES, REGULARISED, SELF_PLAY
from .likeness import EACH_OTHER, PEOPLE, SOUPS, Likeness
from .proxies import staged

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK: Final = "#333333"
_HEAT: Final = (0.75, 0.1, 0.35)
_COLOURS: Final = {
    pairs: tuple(part / 255 for part in colour) for pairs, colour in zip("AB", CHEF_COLOURS, strict=True)
}
_TRIANGLE: Final = "features"
_SHOWN: Final = {
    PEOPLE: "people",
    CLONES: "clones",
    REGULARISED: "regularised",
    EACH_OTHER: "regularised,\neach other",
    SELF_PLAY: "self-play",
}


def draw_soups(found: Sequence[Likeness]) -> bytes:
    """Draws a panel per layout with a dot for each pair of people, proxy, pairing and self-play agent, as PNG."""
    layouts = list(dict.fromkeys(one.layout for one in found))
    with _style():
        figure, panels = _figure(2.3 * len(layouts), 2.9, len(layouts))
        for axes, layout in zip(panels, layouts, strict=True):
            for one in found:
                if one.layout == layout:
                    _dots(axes, one)
            axes.set_title(name(layout), fontsize=8, loc="left", color=_INK)
            axes.set_xticks(range(len(_SHOWN)), list(_SHOWN.values()), rotation=90)
            axes.set_xlim(-0.6, len(_SHOWN) - 0.4)
            axes.set_ylim(bottom=0)
            axes.spines[["top", "right"]].set_visible(False)
        panels[0].set_ylabel(f"soups per {PER} steps", color=_INK)
        said = ", ".join(f"set {pairs}: {word}" for pairs, word in (("A", "blue, left"), ("B", "orange, right")))
        figure.suptitle(
            f"{said}; triangles: input {_TRIANGLE}. Bands: people, {SOUPS[0]:.0f} to {SOUPS[1]:.0f} % of their mean.",
            fontsize=8, x=0.01, ha="left", color=_INK,
        )  # fmt: skip
        return _png(figure)


def draw_visits(found: Sequence[Likeness]) -> bytes:
    """Draws the floor plan of each layout with the time spent on each cell: by people, proxies and others, as PNG."""
    layouts = list(dict.fromkeys(one.layout for one in found))
    columns = [who for who in (PEOPLE, CLONES, REGULARISED, SELF_PLAY) if all(who in one.crowds for one in found)]
    heights = [Layout.load(layout).height for layout in layouts]
    with _style():
        figure, _ = _figure(8.0, sum(heights) * 0.25 + 0.3 * len(layouts), 0)
        grid = figure.subplots(len(layouts), len(columns), squeeze=False, gridspec_kw={"height_ratios": heights})
        for row, layout in zip(grid, layouts, strict=True):
            here = [one.crowds for one in found if one.layout == layout]
            shown = {who: _visits([crowds[who] for crowds in here if who in crowds]) for who in columns}
            most = max(visits.max() for visits in shown.values())
            for axes, who in zip(row, columns, strict=True):
                axes.set_axis_off()
                _heat(axes, layout, shown[who] / most)
                title = f"{name(layout)}: {who}" if who == PEOPLE else who
                axes.set_title(title, fontsize=7, loc="left", color=_INK)
        return _png(figure)


def _dots(axes: "Axes", one: Likeness) -> None:
    colour, side = _COLOURS[one.pairs], -0.16 if one.pairs == "A" else 0.16
    mean = one.crowds[PEOPLE].all.soups.value
    axes.axhspan(SOUPS[0] / 100 * mean, SOUPS[1] / 100 * mean, color=colour, alpha=0.12, linewidth=0)
    for x, who in enumerate(_SHOWN):
        if who in one.crowds:
            soups = [each.soups.value for each in one.crowds[who].each]
            spread = np.linspace(-0.1, 0.1, len(soups)) if len(soups) > 1 else np.zeros(1)
            stage = {CLONES: "clone", REGULARISED: "regularised"}.get(who)
            inputs = [proxy.policy.architecture.observation for proxy in staged(one.proxies, stage)] if stage else []
            for k, (offset, served) in enumerate(zip(spread, soups, strict=True)):
                mark = "^" if k < len(inputs) and inputs[k] == _TRIANGLE else "o"
                axes.plot(x + side + offset, served, mark, color=colour, markersize=3.6, alpha=0.8, markeredgewidth=0)
            axes.plot([x + side - 0.14, x + side + 0.14], [np.mean(soups)] * 2, color=colour, linewidth=1.4)


def _visits(crowds: Sequence[Crowd]) -> NDArray[np.float64]:
    """Returns (H, W) shares of the time, the mean over chefs and crowds."""
    return np.asarray(np.mean([crowd.all.visits.mean(axis=0) for crowd in crowds], axis=0))


def _heat(axes: "Axes", layout: str, visits: NDArray[np.float64]) -> None:
    plan = Layout.load(layout)
    extent = (-0.5, plan.width - 0.5, plan.height - 0.5, -0.5)
    axes.imshow(draw_layout(plan, tile_size=24), extent=extent, alpha=0.6)
    heat = np.zeros((plan.height, plan.width, 4))
    heat[..., :3], heat[..., 3] = _HEAT, 0.95 * np.sqrt(visits)
    axes.imshow(heat, extent=extent, interpolation="nearest")


def _style() -> Any:
    import matplotlib

    return matplotlib.rc_context({"font.size": 8, "font.family": "DejaVu Sans"})


def _figure(width: float, height: float, panels: int) -> "tuple[Figure, Any]":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(1, panels, squeeze=False)[0] if panels else None


def _png(figure: "Figure") -> bytes:
    from PIL import Image

    drawn, small = BytesIO(), BytesIO()
    figure.savefig(drawn, format="png", metadata={"Software": None})
    drawn.seek(0)
    Image.open(drawn).convert("RGB").quantize(96).save(small, "PNG", optimize=True)
    return small.getvalue()
