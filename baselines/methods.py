"""The training methods by the names that the command line has for them."""

from typing import Final

METHODS: Final[dict[str, str]] = {
    "self-play": "self_play",
    "biased-self-play": "biased_self_play",
    "best-response": "best_response",
    "partner-sampling": "partner_sampling",
    "pretrained-partners": "pretrained_partners",
    "pbt": "pbt",
    "population": "population",
}
"""Method -> its module in this package, which has `Config`, `train` and `main`."""
