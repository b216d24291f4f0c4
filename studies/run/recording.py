"""The recording of a run beside its case, in the form that real runs have, too (`franbv.adapters.recording`)."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from franbv.adapters.recording.contents import CameraFacts, RunFacts
from franbv.adapters.recording.opening import record_extra
from franbv.adapters.recording.watched import Watch
from studies.run.bursts import stored_infrared
from studies.run.recording_errors import recording_errors
from studies.run.run_case import RunSettings
from studies.work.maker import versions


@contextmanager
def recording_of(
    file: Path | None,
    config: RunSettings,
    title: str,
    camera: CameraFacts,
    case: Path,
    sensor: Mapping[str, Any],
) -> Iterator[Watch | None]:
    """What writes the run into the file; None where there is none. InputError where the file cannot be written.

    case: folder that has the infrared images; sensor: the camera's settings.
    """
    if file is None:
        yield None
        return
    with recording_errors():
        with record_extra():
            from franbv.adapters.recording.writer import RecordingWriter
        with RecordingWriter(file, run_facts(config, title, sensor), camera) as writer:
            yield Watch(writer, lambda number: stored_infrared(case, number))


def run_facts(config: RunSettings, title: str, sensor: Mapping[str, Any]) -> RunFacts:
    """What decides the run."""
    return RunFacts(
        title=title,
        planner=config.planner,
        parameters=config.parameters.model_dump(mode="json"),
        seed=config.seed,
        azimuth_deg=config.azimuth_deg,
        ablation=config.ablation.model_dump(mode="json", exclude_defaults=True),
        sensor=sensor,
        versions=versions(),
    )
