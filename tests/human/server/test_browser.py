"""The page in a real browser: a game played by keyboard, what is kept of it, and how the page looks."""

import pytest

from overcooked_bench.human.games import read_games
from overcooked_bench.human.server.house import Terms

from .serving import running

TO_THE_POT, TO_SERVE = "ULIRUILIRUILIRUILDIRU", "IDRDI"
"""Keys, as a games file writes them, that cook and serve a soup on cramped_room from seat 0 while the partner stays."""
KEYS = {"U": "ArrowUp", "D": "ArrowDown", "R": "ArrowRight", "L": "ArrowLeft", "I": "Space"}
pytestmark = pytest.mark.slow


def begin(page, consent="#agree", **choices):
    page.click(consent)
    for field, value in choices.items():
        page.select_option(f"#{field}", value)
    page.click("button[type=submit]")
    page.wait_for_selector("#kitchen:visible")


def steps_shown(page):
    return int(page.get_attribute("#kitchen", "aria-label").split("step ")[1].split(" ")[0])


def wait_for_step(page, step):
    page.wait_for_function(
        "step => +document.getElementById('kitchen').getAttribute('aria-label').match(/step (\\d+)/)[1] >= step",
        arg=step,
    )


def press(page, letters):
    """Presses one key in each step at most, so that the steps between keys are steps in which the chef stays."""
    for letter in letters:
        before = steps_shown(page)
        page.keyboard.press(KEYS[letter])
        wait_for_step(page, before + 2)


def test_a_whole_game_is_played_by_keyboard_and_kept(visited, tmp_path):
    file = tmp_path / "ours.games.jsonl"
    with running(file, Terms(("cramped_room",), pace=0.05, horizon=200, countdown=0.0)) as server:
        page = visited(server.address)
        begin(page, partner="stay", seat="0")
        press(page, TO_THE_POT)
        wait_for_step(page, steps_shown(page) + 22)
        press(page, TO_SERVE)
        page.wait_for_selector("#end:visible", timeout=60_000)
        assert page.inner_text("#result") == "20 points, 1 soup"
        assert "was kept" in page.inner_text("#saved")
    (game,) = read_games(file)  # reading plays it again
    assert [seat for _, seat in game.soups] == [0]
    assert game.steps == 200


def test_a_person_plays_on_a_touch_screen(visited):
    with running(terms=Terms(("cramped_room",), pace=0.05, horizon=400, countdown=0.0)) as server:
        page = visited(server.address, width=390, height=844, has_touch=True, is_mobile=True)
        begin(page, "#enter", partner="stay", seat="0")
        page.wait_for_selector("#pad:visible")
        page.tap("#pad [data-action='0']")
        page.wait_for_function("document.getElementById('measured').textContent.includes('Latency')")
        wait_for_step(page, steps_shown(page) + 5)
        playing = next(iter(server.visits())).playing
        assert {first for first, _ in playing.game.actions} >= {0}
        wide = page.evaluate("document.documentElement.scrollWidth")
        assert wide <= 390
        page.click("#leave")
        page.wait_for_selector("#lobby:visible")


def test_two_people_meet_by_a_link(visited, tmp_path):
    with running(tmp_path / "ours.games.jsonl", Terms(("cramped_room",), 0.02, 50, countdown=0.0)) as server:
        first = visited(server.address)
        first.click("#agree")
        first.select_option("#mode", "person")
        first.click("button[type=submit]")
        first.wait_for_selector("#waiting:visible")
        second = visited(first.inner_text("#link"))
        second.click("#agree")
        for page in (first, second):
            page.wait_for_selector("#end:visible", timeout=60_000)
            assert "was kept" in page.inner_text("#saved")


def test_a_link_at_which_nobody_waits_leads_to_the_choice_of_a_game(visited):
    with running(terms=Terms(("cramped_room",), countdown=0.0, seat=1)) as server:
        page = visited(server.address + "&room=0123abcd")
        page.click("#enter")
        page.wait_for_selector("#lobby:visible")
        assert "ask for a new link" in page.inner_text("#problem")
        assert page.input_value("#seat") == "1"


def test_the_page_says_so_while_a_partner_is_loaded(visited, tmp_path):
    ready = tmp_path / "ready"
    agent = tmp_path / "slow.py"
    agent.write_text(
        "import time\nfrom pathlib import Path\n\n\nclass Stay:\n    observation = 'features'\n"
        "    def reset(self, layout, seats, seeds): pass\n    def act(self, observations): return [4]\n\n\n"
        "def make_agent(layout, training_seed):\n"
        f"    while not Path({str(ready)!r}).exists(): time.sleep(0.01)\n    return Stay()\n"
    )
    ready.touch()
    with running(terms=Terms(("cramped_room",), 0.05, 2000, countdown=0.0), given=(str(agent),)) as server:
        page = visited(server.address)
        page.click("#enter")
        ready.unlink()
        try:
            page.click("button[type=submit]")
            page.wait_for_selector("#loading:visible")
            assert "prepared" in page.inner_text("#loading")
        finally:
            ready.touch()
        page.wait_for_selector("#kitchen:visible")
        page.click("#leave")
        page.wait_for_selector("#lobby:visible")


def test_a_watched_game_is_paused_and_taken_over(visited):
    with running(terms=Terms(("cramped_room",), pace=0.05, horizon=2000, countdown=0.0)) as server:
        page = visited(server.address)
        begin(page, "#enter", mode="watch", first="stay", second="greedy")
        page.click("#pause")
        page.wait_for_timeout(300)
        before = steps_shown(page)
        page.select_option("#take", "0")
        page.keyboard.press("ArrowUp")
        page.click("#step")
        wait_for_step(page, before + 1)
        playing = next(iter(server.visits())).playing
        assert playing.game.actions[-1][0] == 0


def test_a_closed_tab_ends_its_game_and_a_lost_server_is_told(visited):
    with running(terms=Terms(("cramped_room",), pace=0.02, horizon=5000, countdown=0.0)) as server:
        page = visited(server.address)
        begin(page, "#enter", partner="greedy")
        other = visited(server.address)
        begin(other, "#enter", partner="greedy")
        page.close()
        other.wait_for_timeout(500)
        assert len(server.visits()) == 1
        assert steps_shown(other) > 0
    other.wait_for_selector("#problem:visible")
    assert "Reload" in other.inner_text("#problem")
