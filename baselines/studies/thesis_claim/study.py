"""The recipe of the study: what each block trains, from `study.yaml`."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import read_text

from ...learning.settings import PartnerSettings, Settings
from ...presets import PresetError, load_config
from ...pretrained_partners import Config as Pretrained
from ...pretrained_partners import self_play_config
from ...running.seeds import derive_seed
from ...self_play import Config as SelfPlay

HOME: Final = Path(str(files("overcooked_bench.baselines.studies")), "thesis-claim")
"""Where the plan, the recipe and the results are."""
RECIPE: Final = "study.yaml"
PARTNERS: Final = "pp"
"""The arm that trains the self-play agents of its block, which the population arms are made from, too."""
MAIN: Final = "main"
"""The part that decides."""
PILOT: Final = "pilot"
"""The part that fixes costs, and enters nothing else."""

Kind = Literal["self-play", "pretrained-partners", "population"]


class StudyError(WrongUse):
    """The study's recipe, plan or records are not as they should be; says what to do instead."""


class Arm(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What one agent of a block is.

    Attributes:
        number: Which of the block's self-play agents it is; None if it is trained for itself.
        method: Training method.
        config: The method's configuration.
        settings: Settings that differ from it.
    """

    number: int | None = None
    method: Kind = "self-play"
    config: str = ""
    settings: dict[str, Any] = {}


class Part(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Blocks that are trained together.

    Attributes:
        set: The set of blocks; parts of one set share the seeds and self-play agents of equal blocks.
        blocks: Layout -> how many, in the order in which they are trained.
        arms: What each block trains, in this order.
    """

    set: str
    blocks: dict[str, int]
    arms: tuple[str, ...]


class Study(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The recipe.

    Attributes:
        name: Of the study; seeds are derived from it.
        protocol: Name or file of the protocol that scores.
        play_sha256: Hash of what it plays, as registered.
        pool_sha256: Hash of its pool, as registered.
        arms: By name.
        parts: By name, in the order in which they are run.
        view: Main blocks of each layout that are shown as the thesis shows its agents.
    """

    name: str
    protocol: str
    play_sha256: str
    pool_sha256: str
    arms: dict[str, Arm]
    parts: dict[str, Part]
    view: int

    def part(self, name: str) -> Part:
        """Returns a part.

        Raises:
            StudyError: There is none of this name.
        """
        if name not in self.parts:
            raise StudyError(f"the study has no part {name!r}; it has {', '.join(self.parts)}")
        return self.parts[name]

    def settings(self, arm: str, layout: str) -> Settings:
        """Returns all settings of an arm that is trained for itself.

        Raises:
            StudyError: A setting is wrong.
        """
        one = self.arms[arm]
        try:
            return load_config(one.method, one.config, **one.settings, layout=layout)
        except (PresetError, ValueError) as error:
            raise StudyError(f"{RECIPE}, arm {arm}: {error}") from None

    def self_play(self, layout: str) -> list[SelfPlay]:
        """Returns the settings of the self-play agents that a block begins with.

        Raises:
            StudyError: A setting is wrong.
        """
        settings = self.settings(PARTNERS, layout)
        assert isinstance(settings, Pretrained)
        return [self_play_config(settings, settings.agent_steps)] * settings.agents


@dataclass(frozen=True)
class Block:
    """One block, which one process trains and scores.

    Attributes:
        study: Of which it is.
        part: And which part.
        layout: Where.
        index: Its number there, from 0.
        hashes: The plan's and the recipe's, which its record repeats.
    """

    study: Study
    part: str
    layout: str
    index: int
    hashes: tuple[str, str]

    @property
    def path(self) -> str:
        """Its folder, below that of all runs."""
        return f"{self.study.part(self.part).set}/{self.layout}/{self.index:02}"

    @property
    def name(self) -> str:
        """The name of its record."""
        return f"{self.part}-{self.layout}-{self.index:02}"

    @property
    def seed(self) -> int:
        """What the seeds of all its agents are derived from."""
        return derive_seed(f"{self.study.name}/{self.study.part(self.part).set}", self.layout, "block", self.index)


def load_study(home: Path) -> Study:
    """Reads the recipe and checks the settings of every arm.

    Raises:
        StudyError: It cannot be read, or something in it is wrong.
    """
    file = home / RECIPE
    study = parse_yaml(read_text(file, LONGEST, raises=StudyError), str(file), StudyError).convert(Study)
    for name, part in study.parts.items():
        if strange := sorted({*part.arms} - {*study.arms}):
            raise StudyError(f"{file}: part {name} has the arm {strange[0]!r}; arms are {', '.join(study.arms)}")
        for layout in part.blocks:
            for arm in part.arms:
                _check(study, arm, layout)
    return study


def blocks(
    study: Study, part: str, hashes: tuple[str, str], layouts: Sequence[str] = (), indices: Sequence[int] = ()
) -> Iterator[Block]:
    """Yields the blocks of a part in the order in which they are run.

    Args:
        study: The recipe.
        part: Which part.
        hashes: The plan's and the recipe's.
        layouts: Only these; all by default.
        indices: Only these; all by default.

    Raises:
        StudyError: There is no such part, layout or block.
    """
    planned = study.part(part).blocks
    if strange := [layout for layout in layouts if layout not in planned]:
        raise StudyError(f"part {part} has no blocks on {strange[0]!r}; it has {', '.join(planned)}")
    for layout in layouts or planned:
        if beyond := [index for index in indices if not 0 <= index < planned[layout]]:
            raise StudyError(f"part {part} has no block {beyond[0]} on {layout}; it has 0 to {planned[layout] - 1}")
        yield from (Block(study, part, layout, index, hashes) for index in indices or range(planned[layout]))


def _check(study: Study, arm: str, layout: str) -> None:
    """Makes sure that an arm can be trained, and with the self-play agents of its block if it uses them."""
    number = study.arms[arm].number
    if number is not None:
        if not 0 <= number < len(study.self_play(layout)):
            raise StudyError(f"{RECIPE}, arm {arm}: number {number}; a block has {len(study.self_play(layout))}")
        return
    settings = study.settings(arm, layout)
    if study.arms[arm].method != "population":
        return
    assert isinstance(settings, PartnerSettings)
    count, steps = getattr(settings, "candidates", 0), getattr(settings, "candidate_steps", 0)
    if [self_play_config(settings, steps)] * count != study.self_play(layout):
        raise StudyError(
            f"{RECIPE}, arm {arm}: its initial agents are not those of {PARTNERS}; give candidates and candidate_steps "
            f"as agents and agent_steps there, and the same other settings"
        )
