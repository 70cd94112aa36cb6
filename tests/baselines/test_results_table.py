from overcooked_bench.baselines.results_table import main
from overcooked_bench.cli import main as command
from tests.baselines.tiny import STEPS, self_play


def test_finished_runs_stand_in_one_table(tmp_path, capsys):
    assert command(self_play("--output", str(tmp_path / "run"))) == 0
    capsys.readouterr()
    assert main([str(tmp_path / "run")]) == 0
    *_, line = capsys.readouterr().out.splitlines()
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert cells[:4] == ["cramped_room", "self-play", "fast", "0"]
    assert cells[5:] == ["-", f"{STEPS / 1e6:.1f} M", "0.0 min"]
    assert main([str(tmp_path)]) == 2
    assert "no finished run" in capsys.readouterr().err
