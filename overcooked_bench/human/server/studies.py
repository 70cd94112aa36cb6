"""Opens a study: its plan, its record, and how its games are played."""

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from overcooked_bench.documents import LONGEST
from overcooked_bench.files import read_text, write_whole
from overcooked_bench.human.games import SUFFIX
from overcooked_bench.human.server.house import Terms
from overcooked_bench.human.server.offers import Cast
from overcooked_bench.human.study.log import StudyLog
from overcooked_bench.human.study.plan import PLAN, StudyError, read_study

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import Isolation


class OpenStudy(NamedTuple):
    """What `serve` needs for a study.

    Attributes:
        terms: How games are played.
        cast: The partners.
        games: The games file.
        log: What has happened so far.
    """

    terms: Terms
    cast: Cast
    games: Path
    log: StudyLog


def open_study(
    plan: str | Path, folder: str | Path | None, cooking: str, countdown: float, isolation: "Isolation | None"
) -> OpenStudy:
    """Reads a plan, makes sure that every partner can play its games, and goes on with what is in the folder.

    Args:
        plan: The plan's YAML file.
        folder: The study's folder, `studies/<name>` by default; gets a copy of the plan.
        cooking: Cooking mode of all kitchens.
        countdown: Seconds before the first step of a game.
        isolation: How the code of submissions is isolated, if it is.

    Raises:
        StudyError: The plan is wrong, a partner cannot play on a layout, or the folder is of another plan.
    """
    study = read_study(plan)
    home = Path(folder or f"studies/{study.plan.name}")
    log = StudyLog(home, study)
    games = {(trial.layout, trial.condition): trial.partner for trial in study.trials(0)}
    cast = Cast(tuple(dict.fromkeys(games.values())), cooking, isolation)
    for (layout, condition), partner in games.items():
        if why := cast.why_not(partner, layout):
            raise StudyError(f"{plan}: conditions, {condition}: {partner} cannot play on {layout}: {why}")
    home.mkdir(parents=True, exist_ok=True)
    write_whole(home / PLAN, read_text(plan, LONGEST, raises=StudyError))
    terms = Terms(study.plan.layouts, study.plan.pace / 1000, study.plan.horizon, countdown, cooking)
    return OpenStudy(terms, cast, home / f"{study.plan.name}{SUFFIX}", log)
