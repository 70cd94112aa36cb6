"""The picture of where chefs stand."""

import io

import numpy as np
from PIL import Image

from overcooked_bench.human.conduct import conduct, conducts
from overcooked_bench.human.games import record
from overcooked_bench.human.heatmap import draw_conduct
from tests.human.made import PEOPLE, random_game, start_of


def drawn(found) -> np.ndarray:
    file = io.BytesIO()
    draw_conduct(found, file)
    return np.asarray(Image.open(file).convert("RGB")).astype(int)


def test_every_layout_has_a_row_of_the_same_scale():
    games = [random_game("counter_circuit"), random_game("XPOX\nX  D\nXXSX")]
    one, two = drawn(conducts(games[:1])), drawn(conducts(games))
    assert one.shape[1] == two.shape[1]
    assert two.shape[0] > one.shape[0]
    assert (drawn(conducts(games)) == two).all()


def test_each_half_shows_what_its_own_chef_does():
    start = start_of("forced_coordination", 0)
    games = [
        record("forced_coordination", [[walk, 4] for walk in walks], seats=PEOPLE, source="made up", start=start)
        for walks in ([4] * 8, [0, 4, 4, 1, 4, 4, 4, 4])
    ]
    stays, walks = (np.array_split(drawn([conduct([game])]), 2, axis=1) for game in games)
    assert (stays[0] != walks[0]).any()
    assert (stays[1] == walks[1]).all()


def test_where_chef_0_was_is_blue():
    left, right = np.array_split(drawn([conduct([random_game("cramped_room")])]), 2, axis=1)
    blue = [(half[..., 2] - half[..., 0]).max() for half in (left, right)]
    assert blue[0] > 120 > 100 > blue[1]
