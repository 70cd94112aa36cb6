"""What a score says about isolation: as well as the worst of the runs that played for it."""

import json

import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.isolating import NOTE, note_isolation
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE
from tests.evaluation.made import changed, protocol_text, score, write_agent
from tests.isolating import isolation_of


@pytest.mark.slow
def test_a_score_is_the_same_isolated_or_not(protocol, tmp_path, capsys):
    agent, rules = write_agent(tmp_path / "mine.py"), tmp_path / "p.yaml"
    rules.write_text(protocol_text(horizon=20))
    isolation_of("strong")
    arguments = ["--protocol", str(rules), "--no-scenarios", "--workers", "1"]
    found = []
    for out, more in (("here", []), ("apart", ["--isolate=strict"])):
        assert main(["score", str(agent), *arguments, "--output", str(tmp_path / out), *more]) == 0
        found.append(json.loads((tmp_path / out / SCORES_FILE).read_text()))
    run = found[1].pop("run")
    assert NOTE not in found[0].pop("run")
    assert found[0] == found[1]
    assert run[NOTE]["level"] == "strong"
    assert run[NOTE]["said"] in " ".join(capsys.readouterr().out.split())
    assert run[NOTE]["said"] in (tmp_path / "apart" / "report.html").read_text()


def test_a_score_is_as_well_isolated_as_the_worst_of_its_runs(protocol, tmp_path):
    weak = isolation_of("weak")
    score("greedy", changed(protocol, horizon=20), output=tmp_path)
    with Store(tmp_path / EPISODES_FILE, **_facts(tmp_path)) as store:
        assert note_isolation(store, None, complete=True) is None
        assert note_isolation(store, weak, complete=True)["level"] == "none"
        assert "without isolation" in note_isolation(store, weak, complete=False)["said"]
        store.note(NOTE, "strong")
        assert note_isolation(store, weak, complete=False) == {"level": "weak", "said": weak.sentence}
        assert note_isolation(store, None, complete=True)["level"] == "weak"
        assert note_isolation(store, None, complete=False)["level"] == "none"
    with Store(tmp_path / EPISODES_FILE) as store:
        assert store.facts[NOTE] == "none"


def _facts(folder):
    with Store(folder / EPISODES_FILE) as store:
        return {
            "facts": {name: store.facts[name] for name in ("protocol", "agent", "pool", "seed", "salt")},
            "notes": {},
        }
