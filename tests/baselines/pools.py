"""A pool that is trained in seconds."""

import json
from pathlib import Path
from typing import Any

from overcooked_bench.baselines.building.config import PoolConfig, load_pool_config
from tests.baselines.tiny import SETTINGS

OVERRIDES = {key: value for key, value in SETTINGS.items() if key != "layout"}
OVERRIDES["hidden"] = list(OVERRIDES["hidden"])


def group(prefix="sp", **others: Any) -> dict[str, Any]:
    return {"prefix": prefix, "method": "self-play", "count": 1, "overrides": OVERRIDES} | others


THREE_AGENTS = {"keep": ["final", "half", "early"], "snapshots": [0.0, 0.4, 0.8]}


def write_config(folder: Path, *groups: dict[str, Any], **others: Any) -> Path:
    content = {
        "name": "tiny",
        "namespace": "tests of pools",
        "layouts": ["cramped_room"],
        "groups": list(groups) or [group(**THREE_AGENTS), group("other", first=1)],
    }
    file = folder / "tiny.yaml"
    file.write_text(json.dumps(content | others))
    return file


def pool_config(folder: Path, *groups: dict[str, Any], **others: Any) -> PoolConfig:
    return load_pool_config(write_config(folder, *groups, **others))
