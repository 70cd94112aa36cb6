"""The training methods by the names that the command line has for them."""

from typing import Final

METHODS: Final[dict[str, str]] = {
    "self-play": "self_play",
}
"""Method -> its module in this package, which has `Config`, `train` and `main`."""
