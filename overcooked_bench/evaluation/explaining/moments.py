"""Chooses the moments: mid-episode states of the scored agent with its partners, from which all is played on."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Final, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.roster import FLOOR
from overcooked_bench.evaluation.games.streams import stream_key

MOMENTS: Final = 50
"""Moments on each layout."""

STEPS: Final = 100
"""Steps that are played from a moment."""

EARLIEST: Final = 50
"""First step of an episode that counts as its middle: by then both chefs have had time to show how they work."""


class Moment(NamedTuple):
    """A state in the middle of a recorded episode.

    Attributes:
        episode: The episode.
        step: Joint actions that were played before.
    """

    episode: Episode
    step: int


def choose_moments(
    episodes: Sequence[Episode], agent: str, horizon: int, salt: str, most: int = MOMENTS
) -> tuple[Moment, ...]:
    """Chooses moments of one layout, one in each of as many episodes.

    Nothing that happened in an episode has a say: a moment that was chosen because the pair failed after it would look
    worse than it is. Partners have the same number of moments or differ by one, then training seeds, then seats; which
    episodes, and the step in each, depends on what was played and with whom, but not on the agent, so that two scores
    under the same protocol are explained from the same steps of the same episodes.

    Args:
        episodes: All of the layout. Those with floors, and with the agent itself as a partner, have nothing to say
            about a failure between two, and are left out.
        agent: Hash of the scored agent.
        horizon: Steps of an episode.
        salt: What the choice is derived from: the hash of what was played.
        most: How many.

    Returns:
        At most so many; fewer if there are fewer episodes.

    Raises:
        WrongUse: Episodes are too short to have a middle.
    """
    if horizon < EARLIEST + STEPS:
        raise WrongUse(
            f"episodes of {horizon} steps have no moment after step {EARLIEST} from which {STEPS} steps can be played; "
            f"explain a score under a protocol with a horizon of {EARLIEST + STEPS} or more"
        )
    keyed: dict[str, list[tuple[int, Episode]]] = defaultdict(list)
    for episode in episodes:
        if episode.kind != FLOOR and episode.partner_sha256 != agent:
            keyed[episode.partner_sha256].append((_key(episode, salt, "episode"), episode))
    left = {partner: sorted(some, key=lambda pair: pair[0]) for partner, some in keyed.items()}
    partners, seeds, seats = Counter(dict.fromkeys(left, 0)), Counter[int](), Counter[int]()
    chosen: list[Moment] = []
    while left and len(chosen) < most:
        partner = min(left, key=lambda one: (partners[one], left[one][0][0]))
        pair = min(left[partner], key=lambda one: (seeds[one[1].training_seed], seats[one[1].seat], one[0]))
        left[partner].remove(pair)
        if not left[partner]:
            del left[partner]
        episode = pair[1]
        partners[partner] += 1
        seeds[episode.training_seed] += 1
        seats[episode.seat] += 1
        step = EARLIEST + _key(episode, salt, "step") % (horizon - STEPS - EARLIEST + 1)
        chosen.append(Moment(episode, step))
    return tuple(chosen)


def _key(episode: Episode, salt: str, what: str) -> int:
    e = episode
    return stream_key("explain", salt, what, e.layout, e.partner_sha256, e.training_seed, e.episode, e.seat)
