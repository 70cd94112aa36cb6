"""Lists the licence of each weight file, and metadata of the data in the format Croissant, from the manifests.

Source: the Croissant format 1.0, https://docs.mlcommons.org/croissant/docs/croissant-spec.html
"""

import csv
import hashlib
import json
from collections.abc import Iterator
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from typing import Any, Final

from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.records import Entry, PolicyReference

LICENCES: Final = "data/licences.csv"
CROISSANT: Final = "data/croissant.json"
LICENCE: Final = "MIT"
FIELDS: Final = {
    "file": "Path of the weight file in the repository",
    "sha256": "SHA-256 of the file",
    "licence": "SPDX identifier of the licence that the file is under",
    "layout": "Kitchen that the agent plays",
    "method": "Training method",
    "codebase": "Project whose training code made it",
    "people": "Pairs of people in whose recorded games it or its training partners were trained, separated by spaces",
}
"""Columns of the file of licences, and what they mean."""

_BASELINES: Final = Path(__file__).parents[2] / "baselines"


def pages() -> Iterator[tuple[str, str]]:
    """Yields both files and their texts."""
    written = StringIO()
    rows = csv.DictWriter(written, FIELDS, lineterminator="\n")
    rows.writeheader()
    manifests = sorted(_BASELINES.glob("*/*/manifest.json"))
    for manifest in manifests:
        folder = manifest.parent.relative_to(_BASELINES.parent).as_posix()
        rows.writerows(_row(entry, folder) for entry in read_manifest(manifest.parent).entries if entry.training)
    licences = written.getvalue()
    yield LICENCES, licences
    yield CROISSANT, json.dumps(_croissant(manifests, licences), indent=1) + "\n"


def _row(entry: Entry, folder: str) -> dict[str, str]:
    assert isinstance(entry.reference, PolicyReference)
    return {
        "file": f"{folder}/{entry.reference.weights.path}",
        "sha256": entry.reference.sha256,
        "licence": LICENCE,
        "layout": entry.layout,
        "method": entry.trained.method,
        "codebase": entry.trained.codebase or "overcooked-bench",
        "people": " ".join(entry.people or ()),
    }


def _croissant(manifests: list[Path], licences: str) -> dict[str, Any]:
    table = _file("licences.csv", f"docs/{LICENCES}", "text/csv", licences.encode())
    return {
        "@context": {
            "@language": "en",
            "@vocab": "https://schema.org/",
            "sc": "https://schema.org/",
            "cr": "http://mlcommons.org/croissant/",
            "dct": "http://purl.org/dc/terms/",
            "conformsTo": "dct:conformsTo",
            "recordSet": "cr:recordSet",
            "field": "cr:field",
            "source": "cr:source",
            "extract": "cr:extract",
            "column": "cr:column",
            "fileObject": {"@id": "cr:fileObject", "@type": "@id"},
            "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
        },
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": "overcooked_bench_partners",
        "description": "Frozen partners and reference entries of overcooked_bench: weights as safetensors, "
        "architectures as JSON, and a manifest for each pool with training, behaviour, floors, ceilings and SHA-256 of "
        "every file.",
        "license": "https://spdx.org/licenses/MIT.html",
        "version": version("overcooked-bench"),
        "distribution": [
            *(_file(*_named(manifest), "application/json", manifest.read_bytes()) for manifest in manifests),
            table,
        ],
        "recordSet": [
            {
                "@type": "cr:RecordSet",
                "@id": "weights",
                "name": "weights",
                "description": "One record per weight file.",
                "field": [_field(name, what) for name, what in FIELDS.items()],
            }
        ],
    }


def _named(manifest: Path) -> tuple[str, str]:
    path = manifest.relative_to(_BASELINES.parent).as_posix()
    return path.removeprefix("baselines/"), path


def _file(name: str, path: str, kind: str, content: bytes) -> dict[str, str]:
    found = hashlib.sha256(content).hexdigest()
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": path,
        "encodingFormat": kind,
        "sha256": found,
    }


def _field(name: str, what: str) -> dict[str, Any]:
    return {
        "@type": "cr:Field",
        "@id": f"weights/{name}",
        "name": name,
        "description": what,
        "dataType": "sc:Text",
        "source": {"fileObject": {"@id": "licences.csv"}, "extract": {"column": name}},
    }
