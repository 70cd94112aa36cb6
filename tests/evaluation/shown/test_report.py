"""Pictures, pages and tables of a score, and its recordings."""

import json
import re
import shlex
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from io import StringIO

import msgspec
import numpy as np
import pytest
from PIL import Image
from rich.console import Console

from overcooked_bench.cli import main
from overcooked_bench.evaluation.games.recording import find_recording
from overcooked_bench.evaluation.games.store import StoreError
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE, Declined, Scores
from overcooked_bench.evaluation.shown.report import write_report
from overcooked_bench.evaluation.shown.terminal import score_tables
from tests.evaluation.comparing.made import REPORT, agent
from tests.evaluation.made import protocol_text, score, write_agent


@pytest.fixture(scope="module")
def scored(tmp_path_factory, pool_folder):
    """A score of two training runs; its pool and its floor have names that HTML must escape."""
    home = tmp_path_factory.mktemp("a score & more")
    protocol = read_protocol(protocol_text(horizon=120), "p.yaml")
    agent = write_agent(home / "a<b>.py", training_seeds=2)
    return score(agent, protocol, pool=pool_folder, output=home / "out")


class Outline(HTMLParser):
    """Checks that tags nest, and collects what stands in the page."""

    VOID = ("meta", "path", "use", "rect", "br", "wbr")

    def __init__(self):
        super().__init__()
        self.open, self.tags, self.texts, self.links = [], [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.links += [value for name, value in attributes if name in ("src", "href", "xlink:href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def test_the_page_needs_nothing_else(scored):
    page = Outline()
    page.feed((scored.folder / "report.html").read_text())
    assert page.open == []
    assert all(link.startswith("#") for link in page.links)
    assert {"svg", "table", "style"} <= set(page.tags)
    assert "default-src 'none'" in (scored.folder / "report.html").read_text()
    text = " ".join(page.texts)
    for words in ("a<b>", "cramped_room", "sp-0", "random", scored.scores.pool.sha256, "needs 19"):
        assert words in text


def test_nothing_that_a_score_names_is_markup(tmp_path):
    evil, sly = "<img src=x onerror=alert(1)>", "\"'><script>alert(1)</script>"
    text = agent(0, report=msgspec.structs.replace(REPORT, metrics=())).to_json()
    for name in ("cramped_room", "own-0", "human", "agent", "pepper"):
        text = text.replace(f': "{name}"', f": {json.dumps(f'{name}{evil}{sly}')}")
    scores = msgspec.json.decode(text, type=Scores)
    facts = [msgspec.structs.replace(one, note=f"{sly}{evil}", label=f"{one.label}{evil}") for one in scores.metrics]
    scores = msgspec.structs.replace(
        *(scores,), metrics=tuple(facts), faults=(evil, sly), interval=sly, run={evil: sly, "versions": {sly: evil}}
    )
    assert len({row.layout for row in scores.rows}) == 3
    write_report(scores, tmp_path, [scores])
    page = Outline()
    page.feed((tmp_path / "report.html").read_text())
    assert page.open == []
    assert not {"img", "script"} & set(page.tags)
    assert " ".join(page.texts).count(evil) > 20


def test_the_pages_commands_replay_the_worst_episode(scored, capsys):
    text = (scored.folder / "report.html").read_text()
    commands = re.findall(r"<code>(.*? replay .*?)</code>", text)
    pairs = scored.scores.with_partners(scored.scores.layouts[0])
    assert len(commands) == len(pairs)
    words = shlex.split(unescape(commands[0]))
    assert words[0] == "overcooked-bench"
    assert main(words[1:]) == 0
    assert f"with {pairs[0][0].name}" in capsys.readouterr().out


def test_floors_are_in_sight(scored):
    text = (scored.folder / "report.html").read_text()
    visible = re.sub(r"<details>.*?</details>", "", text, flags=re.DOTALL)
    assert "<th>floor<br>random</th>" in visible


def test_the_curve_follows_the_pages_theme(scored):
    text = (scored.folder / "report.html").read_text()
    picture = text[text.index("<svg") : text.index("</svg>")]
    assert "#ffffff" not in picture
    assert not re.search(r"#(333333|000000|eeeeee)", picture)
    assert "currentColor" in picture
    assert "#0072b2" in picture.lower()


def test_the_curve_is_a_picture_of_the_same_bytes(scored, tmp_path):
    again = write_report(scored.scores, tmp_path)
    (curves,) = (section.plots["curves"] for section in again if "curves" in section.plots)
    curves.save(tmp_path / "curve.png")
    with Image.open(tmp_path / "curve.png") as picture:
        assert picture.format == "PNG"
        colours = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)
    assert [0, 0x72, 0xB2] in colours.tolist()
    assert (tmp_path / "curve.png").read_bytes() == (scored.folder / "curve.png").read_bytes()


def test_nothing_attempted_is_said_too(scored, tmp_path):
    nothing = msgspec.structs.replace(
        *(scored.scores,), layouts=(), rows=(), overall=None, declined=(Declined("cramped_room", "too small"),)
    )
    assert not any(section.plots for section in write_report(nothing, tmp_path))
    assert "Declined: cramped_room (too small)." in (tmp_path / "report.html").read_text()
    assert "Declined: cramped_room (too small)." in shown(nothing)


def test_many_faults_do_not_push_the_score_out_of_sight(scored, tmp_path):
    faults = tuple(f"cramped_room, episode {episode}: <it> fell" for episode in range(9))
    write_report(msgspec.structs.replace(scored.scores, faults=faults), tmp_path)
    text = (tmp_path / "report.html").read_text()
    assert text.count("&lt;it&gt; fell") == 9
    seen = re.sub(r"<details>.*?</details>", "", text, flags=re.DOTALL)
    assert seen.count("fell") == 1
    assert "8 more faults" in text


def shown(scores):
    console = Console(width=80, file=StringIO())
    console.print(score_tables(scores, explain=True))
    return console.file.getvalue()


def test_the_table_fits_a_terminal_and_says_what_the_interval_means(scored):
    text = shown(scored.scores)
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text
    for words in ("cramped_room", "mean [95 %]", "seat 0", "≥1", "≥3", "worst partner", "random", "2 training seeds"):
        assert words in text


def test_a_recording_is_found_by_what_is_said_of_it(scored):
    found = find_recording(scored.folder, partner="sp-1", seat=1, episode=1, training_seed=1)
    episode = found.episode
    assert (episode.partner, episode.seat, episode.episode, episode.training_seed) == ("sp-1", 1, 1, 1)
    assert found.names == ("sp-1", "a<b>")
    assert find_recording(scored.folder / EPISODES_FILE).episode.seat == 0
    worst = find_recording(scored.folder, worst=True).episode
    assert (worst.kind != "floor", worst.soup_reward) == (True, 0)


@pytest.mark.parametrize(
    ("where", "words"),
    [
        ({"partner": "sp-9"}, "no episode with partner 'sp-9'; there are greedy, random, sp-0, sp-1"),
        ({"episode": 7}, "no episode with episode 7; there are 0, 1"),
        ({"partner": "random", "worst": True}, "no episode with partner random"),
    ],
)
def test_what_is_not_there_is_told(where, words, scored):
    with pytest.raises(StoreError, match=words):
        find_recording(scored.folder, **where)


def test_a_recording_that_does_not_bring_its_points_is_refused(scored):
    found = find_recording(scored.folder)
    forged = msgspec.structs.replace(found.episode, soup_reward=found.episode.soup_reward + 20)
    with pytest.raises(StoreError, match="the joint actions bring"):
        list(replace(found, episode=forged).frames())
