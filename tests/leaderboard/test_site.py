"""The leaderboard's page: what is shown where, and in a browser from the file system."""

import csv
import json

import msgspec
import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.kitchen.layout import CLASSIC
from overcooked_bench.leaderboard.site.build import build
from overcooked_bench.leaderboard.site.entries import EntryError
from overcooked_bench.leaderboard.site.errata import read_errata
from tests.leaderboard.results import write_entry

HOSTILE = "<img src=x onerror=alert(1)>"
POOL = read_scores(REFERENCES / "v1.json").pool.sha256
HOSTILE_SCORES = {
    "path": (f'"sha256": "{POOL}"\n  }},\n  "seed"', '"sha256": "/../../../x"\n  },\n  "seed"'),
    "headline": ('"h50"\n      ]', '"mean"\n      ]'),
    "overall": ('"overall": {\n    "value": 0.', '"overall": {\n    "value": 900.'),
}
"""Entry -> what of its score.json becomes what: a page elsewhere, a rank by another number, a number of nothing."""

REFERENCE_ROWS = {"best-response-train-v1", "partner-blind", "pool-trained", "solo-cook", "greedy"}


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Entries of every kind and status, on two protocols, and folders that are refused."""
    home = tmp_path_factory.mktemp("results")
    write_entry(home, "high", steps=5000, human="true")
    write_entry(home, "near", shift=-0.002, observation="features", link="https://example.org/near")
    write_entry(home, "low", shift=-0.3, steps=100, method="=SUM(A1)", link="http://example.org/low")
    (home / "errata.yaml").write_text(
        'schema: 1\nerrata:\n  - {date: "2026-11-30", about: v1, said: a bound was wrong}\n'
    )
    write_entry(home, "alone", shift=-0.1, seeds=1)
    write_entry(home, "claimed", shift=0.1, audited=False)
    write_entry(home, "taken-back", withdrawn="its weights were those of another entry")
    write_entry(home, "on-the-test", shift=0.05, pools="[v1]")
    write_entry(home, "lite", scores=read_scores(REFERENCES / "v1-lite.json"))
    write_entry(home, "named", agent=HOSTILE, shift=-0.2, method="'<script>alert(1)</script>'")
    (home / HOSTILE).mkdir()
    changed = write_entry(home, "changed")
    (changed / "score.json").write_text((changed / "score.json").read_text().replace("0.8", "0.9"))
    for name, (old, new) in HOSTILE_SCORES.items():
        file = write_entry(home, name, audited=False) / "score.json"
        text = file.read_text()
        assert old in text
        file.write_text(text.replace(old, new, 1))
    write_entry(home, "other-name").rename(home / "squatter")
    torn = write_entry(home, "torn", audited=False)
    scores = read_scores(torn)
    msgspec.structs.replace(
        scores,
        rows=tuple(row for row in scores.rows if row.metric != "curve")
        + tuple(msgspec.structs.replace(row, params={}) for row in scores.select("curve")),
    ).write(torn / "score.json")
    return home


@pytest.fixture(scope="module")
def site(results, tmp_path_factory):
    home = tmp_path_factory.mktemp("sites") / "site"
    assert main(["leaderboard", "build", str(results), str(home)]) == 0
    return home


@pytest.fixture(scope="module")
def table(site):
    rows = json.loads((site / "table.json").read_text())["entries"]
    return {row["page"].split("/")[1].removesuffix(".html"): row for row in rows}


def test_status_decides_on_the_table(table):
    assert {name: (row["table"], row["status"]) for name, row in table.items()} == {
        **{f"_{name}-v1": ("unranked", "reference") for name in REFERENCE_ROWS},
        "_pool-trained-v1": ("open", "reference"),
        "_greedy-v1-lite": ("unranked", "reference"),
        **dict.fromkeys(("high", "near", "low", "named"), ("main", "reproduced")),
        "alone": ("agents", "reproduced"),
        "lite": ("unranked", "reproduced"),
        "claimed": ("unranked", "reported"),
        "taken-back": ("unranked", "withdrawn"),
        "on-the-test": ("open", "reproduced"),
    }
    assert table["taken-back"]["remark"] == "withdrawn on 2026-11-30: its weights were those of another entry"


def test_methods_share_a_letter_unless_the_data_separate_them(table):
    groups = {name: table[name]["group"] for name in ("high", "near", "low", "alone", "_greedy-v1", "claimed")}
    assert groups["high"] == groups["near"] == "a"
    assert "a" not in groups["low"].split()
    assert groups["alone"] == groups["_greedy-v1"] == groups["claimed"] == ""
    assert (table["high"]["places"], table["low"]["places"]) == ("1-2", "4")


def test_a_bad_folder_is_refused_and_costs_no_other_its_row(results, tmp_path):
    refused = {one.name: one.reason for one in build(results, tmp_path / "site").refused}
    assert refused.keys() == {HOSTILE, "changed", "torn", "squatter", *HOSTILE_SCORES}
    assert "no SHA-256" in refused["path"]
    assert "other headlines" in refused["headline"]
    assert "not its own n" in refused["overall"]
    assert "name the folder other-name" in refused["squatter"]
    assert "audit it again" in refused["changed"]
    assert "no parameter 'rank'" in refused["torn"]
    assert "use at most 100 letters" in refused[HOSTILE]


def test_the_same_results_give_the_same_bytes_and_no_stale_page_stays(results, site, tmp_path):
    again = tmp_path / "again"
    build(results, again)
    (again / "entries" / "gone.html").touch()
    build(results, again)
    files = {file.relative_to(site): file.read_bytes() for file in site.rglob("*") if file.is_file()}
    assert {file.relative_to(again): file.read_bytes() for file in again.rglob("*") if file.is_file()} == files


def test_a_folder_that_holds_something_else_is_left_alone(results, tmp_path):
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(EntryError, match="holds something else"):
        build(results, tmp_path)
    with pytest.raises(EntryError, match="no such folder"):
        build(tmp_path / "none", tmp_path / "site")


def test_csv_and_feed_say_what_the_json_says(site, table):
    with (site / "table.csv").open(newline="") as file:
        rows = {row["name"]: row for row in csv.DictReader(file)}
    assert float(rows["near"]["score low"]) == table["near"]["score"]["low"]
    assert rows["low"]["protocol"] == "v1"
    feed = (site / "feed.xml").read_text()
    assert feed.count("<item>") == 1 + sum(row["date"] is not None for row in table.values())
    assert "Erratum: v1" in feed
    assert "its weights were those of another entry" in feed


def test_nothing_that_an_entry_says_becomes_a_part_of_a_page(site):
    for page in site.rglob("*.html"):
        text = page.read_text()
        assert "<img" not in text
        assert "<script>alert" not in text


def test_errata_list_what_was_wrong_withdrawn_and_refused(site, tmp_path):
    page = (site / "errata.html").read_text()
    assert all(text in page for text in ("a bound was wrong", "its weights were those of another entry", "no SHA-256"))
    (tmp_path / "errata.yaml").write_text("schema: 1\nerrata:\n  - {date: 2026-1-1, about: v1, said: all}\n")
    with pytest.raises(EntryError, match=r"errata\.yaml:3.*YYYY-MM-DD"):
        read_errata(tmp_path)


def test_only_links_of_https_are_links(site):
    page = (site / "entries" / "near.html").read_text()
    assert '<a href="https://example.org/near" rel="nofollow noopener noreferrer">' in page
    assert "http://example.org/low" in (site / "entries" / "low.html").read_text()
    assert '<a href="http:' not in (site / "entries" / "low.html").read_text()


def test_each_layout_and_protocol_has_a_page_and_old_ones_are_dimmed(site, table):
    names = {file.stem for file in (site / "layouts").iterdir()}
    assert names == set(CLASSIC)
    for name in names:
        assert "Discriminates" in (site / "layouts" / f"{name}.html").read_text()
    lite = next(file for file in (site / "protocols").iterdir() if table["lite"]["protocol_sha256"][:8] in file.name)
    assert '<div class="old">' in lite.read_text()
    assert "entries/lite.html" in lite.read_text()
    assert "entries/lite.html" not in (site / "index.html").read_text()


def shown(page):
    return page.locator("table.board tbody tr:visible td:first-child").all_inner_texts()


@pytest.mark.slow
def test_rows_are_filtered_and_sorted_and_the_link_keeps_it(site, opened):
    page = opened(site / "index.html")
    everything = shown(page)
    assert everything[:5] == ["high", "near", "named", "low", "alone"]
    page.get_by_label("human data").first.select_option("no")
    page.get_by_label("joint steps at most").fill("1000")
    page.get_by_label("training columns").check()
    page.get_by_label("score at least").fill("0.7")
    page.get_by_role("button", name="N [95 %]").first.focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Enter")
    expected = ["near", "alone", "on-the-test", "greedy", "taken-back", "claimed"]
    assert shown(page) == expected
    assert page.locator("#said").inner_text() == f"{len(expected)} of {len(everything)} entries shown"
    assert page.locator("th[aria-sort=ascending]").count() >= 1
    other = page.context.new_page()
    other.goto(page.url)
    assert shown(other) == expected
    assert other.get_by_role("button", name="joint steps").first.is_visible()
    other.get_by_role("button", name="Show all").click()
    other.wait_for_function("!location.hash")
    assert shown(other) == everything


@pytest.mark.slow
def test_a_layout_shows_its_own_numbers(site, table, opened):
    page = opened(site / "index.html")
    row = page.locator("tr", has_text="greedy").first
    column = row.locator("td.on3")
    assert not column.is_visible()
    page.locator("select[name=layout]").select_option("forced_coordination")
    assert f"{table['_greedy-v1']['layouts']['forced_coordination']['value']:.2f}" in column.inner_text()
    assert "layout=forced_coordination" in page.url


@pytest.mark.slow
@pytest.mark.parametrize(("width", "dark"), [(1280, False), (390, True)])
def test_no_page_is_wider_than_the_screen(width, dark, site, opened):
    files = ("index.html", "entries/_pool-trained-v1.html", "layouts/counter_circuit.html")
    for file in (*(site / name for name in files), next(site.glob("curves/*")), next(site.glob("protocols/*"))):
        page = opened(file, width=width, dark=dark)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert (sum(map(int, ground[4:-1].split(","))) < 384) == dark


@pytest.mark.slow
def test_curves_of_any_two_entries_are_drawn(site, opened):
    file = next(file for file in (site / "curves").iterdir() if "on-the-test" in file.read_text())
    page = opened(file)
    page.get_by_label("second entry").select_option("low")
    assert page.locator("polyline").count() == 10
    assert "low from" in page.locator("svg[role=img]").first.get_attribute("aria-label")
    assert "second=low" in page.url


@pytest.mark.slow
def test_the_worst_game_of_an_entry_is_played_by_the_keyboard(site, opened):
    page = opened(site / "entries" / "_pool-trained-v1.html")
    game = page.locator("[data-kitchen]").first
    game.focus()
    page.keyboard.press("End")
    assert "step 400 of 400" in game.inner_text()
    assert page.locator("polyline").count() == 10
    assert page.locator("table.heat td").count() > 100


@pytest.mark.slow
def test_a_layout_is_drawn_and_leads_to_its_own_order(site, opened):
    page = opened(site / "layouts" / "forced_coordination.html")
    drawn = page.evaluate("document.querySelector('canvas').toDataURL().length")
    assert drawn > 5000
    link = page.get_by_role("link", name="All entries, sorted by this layout").get_attribute("href")
    assert link == "../index.html#layout=forced_coordination&sort=on-3%3Adown"


def test_other_games_under_the_name_of_a_shipped_protocol_are_refused(tmp_path):
    scores = read_scores(REFERENCES / "v1-lite.json")
    settings = scores.settings
    settings = msgspec.structs.replace(settings, play=msgspec.structs.replace(settings.play, horizon=100))
    protocol = msgspec.structs.replace(scores.protocol, sha256=settings.sha256)
    changed = msgspec.structs.replace(scores, settings=settings, protocol=protocol)
    write_entry(tmp_path / "results", "shorter", scores=changed)
    (refused,) = build(tmp_path / "results", tmp_path / "site").refused
    assert "says v1-lite, but of other games" in refused.reason
