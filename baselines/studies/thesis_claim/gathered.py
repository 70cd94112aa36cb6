"""Reads the records of the blocks that count, and refuses those that are not as they should be."""

from pathlib import Path

from .records import RESULTS, BlockRecord, read_record
from .registered import Registered
from .study import Study, StudyError

Whole = dict[str, list[BlockRecord]]
"""Layout -> the records of its blocks, from 0 on, without a gap."""


def whole_blocks(study: Study, part: str, home: Path, known: Registered) -> Whole:
    """Reads the records of a part: those of each layout from block 0 up to the first that is missing.

    Raises:
        StudyError: A record is damaged, lacks an arm, or was made under another plan or recipe.
    """
    found: Whole = {}
    for layout, planned in study.part(part).blocks.items():
        found[layout] = []
        for index in range(planned):
            file = home / RESULTS / f"{part}-{layout}-{index:02}.json"
            if not file.is_file():
                break
            record = read_record(file)
            _check(study, record, file, known)
            found[layout].append(record)
    return found


def _check(study: Study, record: BlockRecord, file: Path, known: Registered) -> None:
    missing = [arm for arm in study.part(record.part).arms if arm not in record.by_arm]
    if missing:
        raise StudyError(
            f"{file} lacks the arm {missing[0]}; a block counts with all of its arms: remove the file, and run "
            f"{record.part} --layouts {record.layout} --blocks {record.index}-{record.index}"
        )
    if (record.plan, record.recipe) != known.hashes:
        raise StudyError(
            f"{file} was made under another plan or recipe ({record.plan[:12]}, {record.recipe[:12]}) than the "
            f"registered ones ({known.plan[:12]}, {known.recipe[:12]}); it cannot count"
        )
