"""Renders the kitchens of all environments."""

from typing import Any, Final

from overcooked_bench.kitchen.kitchens import Kitchens

RENDER_MODES: Final = ("rgb_array", "ansi")
RENDER_FPS: Final = 8


def checked_mode(render_mode: str | None) -> str | None:
    """Returns the render mode that was given.

    Raises:
        ValueError: There is no such mode.
    """
    if render_mode == "human":
        raise ValueError(
            "render_mode='human' is drawn by Gymnasium's wrapper: write gymnasium.make(id, render_mode='human'), or "
            "gymnasium.wrappers.HumanRendering(env) around an environment with render_mode='rgb_array'"
        )
    if render_mode is not None and render_mode not in RENDER_MODES:
        raise ValueError(f"render_mode={render_mode!r}; give 'rgb_array', 'ansi' or None")
    return render_mode


def frame(kitchens: Kitchens, i: int, render_mode: str | None) -> Any:
    """Shows kitchen i: an (h, w, 3) uint8 picture, text, or None without a render mode."""
    if render_mode is None:
        return None
    if render_mode == "ansi":
        from overcooked_bench.rendering.text import film

        return film(kitchens.layout, kitchens.state(i))
    from overcooked_bench.rendering.picture import draw

    return draw(kitchens.layout, kitchens.state(i))
