"""Writes the scores of reference agents that ship in `protocols/references`, after a protocol or its pool was changed.

python -m overcooked_bench.evaluation.references
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.games.engines import default_workers
from overcooked_bench.evaluation.protocol import Protocol, load_protocol, protocol_names
from overcooked_bench.evaluation.score import score
from overcooked_bench.evaluation.scores import Scores


def reference_scores(protocol: Protocol) -> Scores | None:
    """Scores the reference agent of a protocol; None if it names none."""
    agent = protocol.report.reference
    if agent is None:
        return None
    with TemporaryDirectory() as folder:
        found = score(agent, protocol, output=folder, workers=default_workers()).scores
    layouts = tuple(msgspec.structs.replace(layout, partners=()) for layout in found.layouts)
    rows = tuple(row for row in found.rows if row.partner is None)
    return msgspec.structs.replace(found, layouts=layouts, rows=rows, run={})


def write_references(home: Path = REFERENCES) -> None:
    """Writes `<protocol>.json` for each shipped protocol with a reference agent."""
    home.mkdir(exist_ok=True)
    for name in protocol_names():
        found = reference_scores(load_protocol(name))
        if found is not None:
            found.write(home / f"{name}.json")
            print(home / f"{name}.json", file=sys.stderr)


if __name__ == "__main__":
    write_references()
