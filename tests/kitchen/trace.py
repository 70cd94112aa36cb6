"""Plays a few kitchens and keeps everything that can be seen; as a script it writes that to the file it is given.

It imports nothing of the tests, so that it can run in a process of its own, under other settings.
"""

import sys

import numpy as np

from overcooked_bench import Kitchens, Layout

ROOM = "XOPX\nD  S\nXXXX"
ROOMS = "XPXXX\nO X P\nD X S\nXXXXX"
MIXED = "XPTXX\nO   P\nXXDSX"
MENU = {
    "orders": [["onion"] * 3, ["onion", "tomato", "tomato"]],
    "bonus_orders": [["onion", "tomato", "tomato"]],
    "soup_reward": {"onion": 4, "tomato": 7},
    "cook_time": {"onion": 2, "tomato": 3},
}
STEPS, HORIZON, KITCHENS = 100, 29, 6


def trace() -> dict[str, np.ndarray]:
    """Gives rewards, events, truncation and all observations of short games in three kitchens and both modes."""
    seen: dict[str, np.ndarray] = {}
    for name, layout in (
        ("room", Layout.from_text(ROOM, cook_time=6)),
        ("rooms", Layout.from_text(ROOMS)),
        ("mixed", Layout.from_text(MIXED, **MENU)),
    ):
        for cooking in ("auto", "manual"):
            options = {"horizon": HORIZON, "start": "random", "object_probability": 0.7, "history": 3}
            kitchens = Kitchens(layout, KITCHENS, cooking=cooking, events=True, actions_taken=True, **options)
            kitchens.reset(seed=9)
            views = [
                "lossless26",
                "features",
                *([] if layout.has_tomatoes else ["lossless", "stack_channels", "stack_states"]),
            ]
            actions = np.random.default_rng(4).choice(6, (STEPS, KITCHENS, 2), p=[0.12, 0.12, 0.12, 0.12, 0.04, 0.48])
            rows: dict[str, list[np.ndarray]] = {}
            for joint in actions:
                parts = {view: kitchens.observe(view) for view in views} | kitchens.step(joint)._asdict()
                for key, value in parts.items():
                    rows.setdefault(key, []).append(value)
            seen |= {f"{name} {cooking} {key}": np.array(values) for key, values in rows.items()}
    return seen


if __name__ == "__main__":
    np.savez_compressed(sys.argv[1], **trace())
