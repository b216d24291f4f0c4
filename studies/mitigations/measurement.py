"""One case of a study of mitigations, from its configuration to its folder.

While a case is measured its counts stand one by one in a sub-folder that outlives the process, so that a case that was
killed goes on where it was. Radiance is kept while a pose is counted, and no longer: a catalogue's would fill a disk.
"""

import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from studies.advise.score_store import ScoreStore, ViewCounts
from studies.advise.settings import subject_of
from studies.advise.stored_light import LIGHT, LightStore
from studies.base.atomic_file import write_atomically
from studies.base.case_folder import PROGRESS, finished_case, writing
from studies.base.console import strict_json
from studies.mitigations.cases import MitigationCase, tried_remedies
from studies.run.scene_settings import build_subject
from studies.sensitivity.measurement import CASES, FACTS, RESULT, case_maker
from studies.work.executor import Executor, check_alike, reasons_once
from studies.work.maker import versions
from studies.work.workers import Failure, Job


@dataclass(frozen=True)
class MitigationTask:
    """A case to be measured in a study's folder."""

    out: Path
    case: MitigationCase


def measure_cases(out: Path, cases: Sequence[MitigationCase], executor: Executor, program: str) -> list[Failure]:
    """Measure the cases that are not there yet; returns those that were given up.

    program: what reasons for giving up are said by.
    """
    missing = [case for case in cases if finished_case(out / CASES, case.digest) is None]
    if missing:
        done = [case for case in cases if case not in missing]
        check_alike(executor, out, [case_maker(out, case.digest) for case in done])
    jobs = [Job(case.title, do_mitigation_case, MitigationTask(out, case)) for case in missing]
    return executor.run([jobs], len(cases) - len(missing), reasons_once(program))


def do_mitigation_case(task: MitigationTask) -> None:
    """For a worker: measure the case and write its folder."""
    case = task.case
    with writing(task.out / CASES, case.digest) as folder:
        progress = folder / PROGRESS
        progress.mkdir(exist_ok=True)
        result = counted_case(case, progress)
        facts = {"title": case.title, "config": case.model_dump(mode="json"), "versions": versions()}
        write_atomically(folder / FACTS, strict_json(facts, indent=1).encode())
        write_atomically(folder / RESULT, strict_json(result).encode())
        shutil.rmtree(progress)


def counted_case(case: MitigationCase, progress: Path) -> dict[str, Any]:
    """Counts of the camera as it is set and of every remedy, by pose and seed; what is in `progress` is not counted
    again."""
    scene = build_subject(case.settings).scene
    lights = LightStore(
        progress, subject_of(case.settings), scene, case.settings.pose, case.settings.sensor.mount_roll_deg
    )
    scores = ScoreStore(lights, case.seeds)
    setups = tried_remedies(case, bool(scene.lamps) or scene.ambient_radiance > 0)
    counts: dict[tuple[str, ...], list[ViewCounts]] = {name: [] for name in setups}
    for index in range(len(lights.poses)):
        for name, (_, setup) in setups.items():
            counts[name].append(scores.counts(setup, index))
        shutil.rmtree(progress / LIGHT, ignore_errors=True)
    return {"counts": [{"remedy": name, "views": _plain_views(views)} for name, views in counts.items()]}


def _plain_views(views: Sequence[ViewCounts]) -> list[list[dict[str, Any]]]:
    return [[asdict(count) for count in view] for view in views]
