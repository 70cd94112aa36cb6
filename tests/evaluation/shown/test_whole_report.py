"""The report of a score with strata, bounds and an explanation: in a browser, and as files."""

import csv
import shutil

import msgspec
import pytest
from PIL import Image

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.cli import main
from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.explaining.explain import explain
from overcooked_bench.evaluation.explaining.records import read_explanation
from overcooked_bench.evaluation.protocol import load_protocol, read_protocol
from overcooked_bench.evaluation.scores import Source, read_scores
from overcooked_bench.evaluation.shown import report
from tests.agents.made import scripted
from tests.evaluation.made import protocol_text, reporting, score

pytestmark = pytest.mark.slow

LAYOUTS = ["cramped_room", "forced_coordination"]
AGENT = "dev-v1/{layout}/sp-0"


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """Partners of two strata on two layouts, with bounds, and a floor."""
    home, source = tmp_path_factory.mktemp("pools") / "strangers", Pool.load("dev-v1")
    known = dict(floor_agent="stay", low=90, high=110, episodes=9, responder="greedy", responder_sha256="0" * 64)
    entries = []
    for layout in LAYOUTS:
        (home / layout).mkdir(parents=True)
        for suffix in (".json", ".safetensors"):
            shutil.copy(source.folder / layout / f"sp-4{suffix}", home / layout)
        bounds = tuple(Bound(side=side, floor=0, ceiling=90, **known) for side in range(1 + (layout == LAYOUTS[1])))
        own = msgspec.structs.replace(source.agent(layout, "sp-4"), stratum="own")
        others = [scripted("greedy", layout), scripted("stay", layout)]
        entries += [msgspec.structs.replace(one, bounds=bounds) for one in (own, *others)]
        entries.append(scripted("random", layout, role="floor"))
    write_manifest(home, "strangers", entries)
    return home


@pytest.fixture(scope="module")
def rules():
    """Scored as v1 does; without the pool's folder, which would give each run other start states and moments."""
    text = protocol_text(layouts=LAYOUTS, pool="strangers", horizon=200, episodes=3, object_probability=0.0)
    v1 = load_protocol("v1").report
    return reporting(read_protocol(text, "p.yaml"), **{name: getattr(v1, name) for name in v1.__struct_fields__})


@pytest.fixture(scope="module")
def folder(rules, pool, tmp_path_factory):
    """The score, explained, and the files that the command writes beside the score of another agent."""
    home = tmp_path_factory.mktemp("scores")
    mine = score(AGENT, rules, pool=pool, output=home / "mine")
    explain(mine.folder, pool=pool, moments=8)
    chosen = []
    for name in ("theirs", "another's"):
        (home / name).mkdir()
        msgspec.structs.replace(mine.scores, agent=Source(name, "0" * 64)).write(home / name / "score.json")
        chosen += ["--beside", str(home / name)]
    reference = score("greedy", rules, pool=pool, output=home / "greedy").scores
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "beside", lambda scores, folder: Beside(reference))
        assert main(["report", str(mine.folder), *chosen]) == 0
    return mine.folder


@pytest.fixture(scope="module")
def scores(folder):
    return read_scores(folder)


def test_the_headline_stands_first_with_its_interval_and_the_reference(folder, scores, opened):
    page = opened(folder / "report.html")
    n, h50 = scores.find("n"), scores.find("h50")
    first, second = page.locator(".cards > div").all_inner_texts()
    assert n.estimate.text(2) in " ".join(first.split())
    assert f"{100 * h50.value:.0f} %" in second
    assert "greedy" in first
    headings = page.locator("h2").all_inner_texts()
    for link, heading in zip(page.locator("nav a").all(), headings, strict=True):
        assert link.inner_text() == heading
        link.click()
        assert page.evaluate("document.querySelector(location.hash).textContent") == heading
    assert headings[0] == "Score"
    assert {"Ordered curves", "Partners", "Seats and sides", "How they cooperate", "Why it failed"} < set(headings)


def test_without_curves_and_ranks_there_is_no_empty_plot_and_a_standard_error(scores, tmp_path):
    settings = msgspec.structs.replace(
        scores.settings, report=msgspec.structs.replace(scores.settings.report, ranked=False)
    )
    rows = tuple(row for row in scores.rows if not row.metric.startswith("curve"))
    sections = report.write_report(msgspec.structs.replace(scores, settings=settings, rows=rows), tmp_path)
    assert "Ordered curves" not in [section.title for section in sections]
    assert f"± {scores.find('n').error:.2f} (standard error)" in (tmp_path / "report.html").read_text()


def test_tables_and_plots_say_what_the_score_says(folder, scores, opened):
    page = opened(folder / "report.html")
    cells = page.locator("table.heat td[title]")
    row = scores.find("n", layout="forced_coordination", partner="greedy")
    shown = page.locator("table.heat td[title^='greedy on forced_coordination']")
    assert shown.inner_text() == f"{row.value:.2f}"
    assert cells.count() == 6
    left = page.locator("tr", has_text="left side").first.inner_text().split("\t")
    assert f"{scores.find('n', layout='forced_coordination', side=0).value:.2f}" in left[2]
    for plot in page.locator("svg[role=img]").all():
        assert len(plot.get_attribute("aria-label")) > 20
    names = page.locator("ul.legend").first.locator("li").all_inner_texts()
    assert names == ["dev-v1-sp-0", "theirs", "another's", "greedy"]


@pytest.mark.parametrize(("width", "dark"), [(1280, False), (390, True)])
def test_the_page_is_as_wide_as_the_screen_in_its_theme(width, dark, folder, opened):
    page = opened(folder / "report.html", width=width, dark=dark)
    page.evaluate("document.querySelectorAll('details').forEach(one => one.open = true)")
    page.locator(".kitchen canvas").last.wait_for()
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    scrolled = "[...document.querySelectorAll('div.wide')].filter(one => one.scrollWidth > one.clientWidth).length"
    assert width < 1280 or page.evaluate(scrolled) == 0
    ground, ink = page.evaluate(
        "[getComputedStyle(document.body).backgroundColor, getComputedStyle(document.body).color]"
    )
    brightness = [sum(map(int, colour[4:-1].split(","))) for colour in (ground, ink)]
    assert (brightness[0] < brightness[1]) == dark


def test_the_worst_games_are_played_in_the_page(folder, scores, opened):
    page = opened(folder / "report.html")
    worst = min((row for row in scores.select("n") if row.partner), key=lambda row: row.value)
    games = page.locator("details", has_text="overcooked-bench replay")
    assert f"{worst.layout}, {worst.partner}" in games.first.locator("summary").inner_text()
    assert games.count() == 6
    assert page.locator(".kitchen").count() == 1  # the first; the others are made when they are unfolded
    games.nth(1).locator("summary").click()
    kitchen = games.nth(1).locator(".kitchen")
    kitchen.get_by_role("button", name="Step forward").click()
    assert kitchen.locator(".said").inner_text().startswith("step 1 of 200")
    kitchen.press("End")
    assert kitchen.locator(".said").inner_text().startswith("step 200 of 200")


def test_the_worst_moments_are_played_four_ways(folder, opened):
    page = opened(folder / "report.html")
    moment = page.locator("details", has=page.locator("details")).first
    moment.locator("summary").first.click()
    assert moment.locator(".kitchen").count() == 1
    inner = moment.locator("details").all()
    assert [one.locator("summary").inner_text().partition(":")[0] for one in inner] == [
        *("The pair", "Two of the agent", "Two of the partner", "Two of greedy")
    ]
    inner[3].locator("summary").click()
    inner[3].get_by_role("button", name="Last step").click()
    assert "greedy holds" in inner[3].locator(".said").inner_text()


def test_a_clash_says_what_the_conventions_are(folder, opened):
    page, layouts = opened(folder / "report.html"), read_explanation(folder).layouts
    shown = [(layout.moments[worst.moment], worst) for layout in layouts for worst in layout.worst]
    moment, worst = next((moment, worst) for moment, worst in shown if moment.differ and moment.reason == "clash")
    axis, (own, other) = moment.differ[0], worst.conventions
    line = page.locator("details", has_text=worst.name.removeprefix("moment-")).first
    assert f"with {moment.partner}: clash of conventions ({', '.join(moment.differ)})" in line.inner_text()
    line.locator("summary").first.click()
    assert f"{own[axis]} for the agent, {other[axis]} for its partner." in line.inner_text()


def test_every_plot_and_table_is_a_file(folder, scores):
    plots = {path.name for path in (folder / "plots").iterdir()}
    assert plots == {
        f"{name}.{form}" for name in ("headline", "curves", "partners", "reasons") for form in ("png", "svg")
    }
    with Image.open(folder / "plots" / "curves.png") as picture:
        assert picture.width > 900
    assert "<svg" in (folder / "plots" / "partners.svg").read_text()
    with (folder / "tables" / "partners.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["stratum"] for row in rows} == {"own", "scripted"}
    greedy = next(row for row in rows if row["partner"] == "greedy")
    found = scores.find("n", layout="cramped_room", partner="greedy")
    assert [float(greedy[f"cramped_room{end}"]) for end in ("", " low", " high")] == [
        *(pytest.approx(end, abs=0.005) for end in found.estimate)
    ]
    tables = {path.stem for path in (folder / "tables").iterdir()}
    assert {"score", "seats", "cooperation", "reasons", "worst", "metrics"} <= tables
    assert {"partners-on-cramped_room", "cooperation-on-cramped_room"} <= tables


def test_an_explanation_of_another_score_is_not_shown(folder, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(folder.parent / "greedy", other)
    shutil.copy(folder / "explain.json", other)
    assert main(["report", str(other)]) == 0
    text = (other / "report.html").read_text()
    assert "Not asked yet: <code>overcooked-bench explain" in text


def test_scores_of_other_games_are_not_shown_beside(folder, scores, tmp_path, capsys):
    other = msgspec.structs.replace(scores, agent=Source("greedy", "0" * 64), protocol=Source("p", "1" * 64))
    other.write(tmp_path / "score.json")
    assert main(["report", str(folder), "--beside", str(tmp_path)]) == 2
    assert "dev-v1-sp-0 and greedy were scored with a different protocol" in capsys.readouterr().err
    assert main(["report", str(tmp_path / "none")]) == 2
    assert "no such folder" in capsys.readouterr().err
