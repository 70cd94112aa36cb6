"""The training methods by their names on the command line."""

from importlib import import_module
from types import ModuleType
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.shelf import guess

METHODS: Final[dict[str, str]] = {
    "self-play": "one policy on both seats",
    "biased-self-play": "self-play with extra rewards for events, whose weights are drawn per run",
    "best-response": "one learner against fixed partners",
    "partner-sampling": "self-play against the learner's own saved past",
    "pretrained-partners": "one learner against partners trained beforehand (fictitious co-play)",
    "pbt": "population-based training: agents learn with each other, and copies of the best replace the worst",
    "population": "the thesis's method: agents trained one by one to differ from those before, then two final agents",
    "stock-ppo": "self-play by another trainer: stable-baselines3's PPO as it comes",
    "recurrent-ppo": "self-play by another trainer: sb3-contrib's RecurrentPPO, an actor with memory (LSTM)",
    "jaxmarl-ippo": "self-play in JaxMARL's own kitchen by its IPPO (needs JaxMARL, which uv installs)",
    "human-proxy": "clones of people in recorded games, then PPO that pays for its divergence from the clone",
}
"""Method -> what it trains. Its module in this package has the same name, with underscores."""


def check_method(name: str) -> None:
    """Makes sure that there is a method of this name.

    Raises:
        WrongUse: There is none.
    """
    if name not in METHODS:
        raise WrongUse(f"no training method named {name!r}; {guess(name, METHODS)}there is {', '.join(METHODS)}")


def find_method(name: str) -> ModuleType:
    """Imports a method's module, which has `Config` and `train`.

    Raises:
        WrongUse: There is no such method.
    """
    check_method(name)
    return import_module(f"{__package__}.{name.replace('-', '_')}")
