"""Files of the viewer read back by the viewer's own reader and judged by its own program."""

import subprocess
from collections import defaultdict
from pathlib import Path
from typing import Any

from rerun.chunk import RrdReader

from franbv.adapters.view.server import program

Drawn = dict[str, dict[int, list[Any]]]
"""`/path:Component:field` -> step of the timeline -> instances."""


def drawn(path: Path) -> Drawn:
    """All that a file holds of a run; every piece has one timeline, `acquisition`, or none."""
    found: Drawn = defaultdict(dict)
    for chunk in RrdReader(path).stream():
        batch = chunk.to_record_batch()
        if chunk.is_static:
            continue
        assert chunk.timeline_names == ["acquisition"]
        steps = batch.column("acquisition").to_pylist()
        for name in set(batch.schema.names) - {"acquisition", "rerun.controls.RowId"}:
            for step, instances in zip(steps, batch.column(name).to_pylist(), strict=True):
                found[f"{chunk.entity_path}:{name}"][step] = instances
    return dict(found)


def counts(found: Drawn, name: str) -> list[int]:
    """How many instances stand at each step, from 0."""
    steps = found[name]
    assert sorted(steps) == list(range(len(steps)))
    return [len(steps[step]) for step in sorted(steps)]


def verified(path: Path) -> str:
    """What `rerun rrd verify` says of the file."""
    done = subprocess.run([program(), "rrd", "verify", path], capture_output=True, text=True, check=False)
    return f"{done.returncode}: {done.stderr.strip().splitlines()[-1]}"
