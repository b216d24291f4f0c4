"""One case of a sensitivity study, from its configuration to its folder."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic

from studies.base.atomic_file import write_atomically
from studies.base.case_folder import finished_case, writing
from studies.base.console import strict_json
from studies.sensitivity.cases import AnyCase, CaseConfig, SceneOf, TwinConfig, look_scene
from studies.sensitivity.counts import incidence_counts, view_counts, view_keys
from studies.sensitivity.planning import detection_counts, first_look, recovery_rows
from studies.sensitivity.twins import make_twin
from studies.sensitivity.views import lit_views
from studies.work.executor import Executor, check_alike, reasons_once
from studies.work.maker import Maker, versions
from studies.work.workers import Failure, Job

FACTS, RESULT = "case.json", "result.json"
"""Files of a case: what was measured, and what came out."""
CASES, TWINS = "cases", "twins"
"""Sub-folders of the study."""
CaseRows = dict[str, list[dict[str, Any]]]
"""Rows of the study's tables, by the table's name."""


@dataclass(frozen=True)
class CaseTask(Generic[AnyCase]):
    """A case to be measured in a study's folder."""

    out: Path
    config: AnyCase
    scene_of: SceneOf = look_scene


@dataclass(frozen=True)
class TwinTask:
    """A twin to be measured in a study's folder."""

    out: Path
    config: TwinConfig
    scene_of: SceneOf = look_scene


def do_twin(task: TwinTask) -> None:
    """For a worker."""
    make_twin(task.out / TWINS, task.config, task.scene_of)


def do_case(task: CaseTask[CaseConfig]) -> None:
    """For a worker: measure the case and write its folder."""
    write_case(task, measured)


def write_case(task: CaseTask[AnyCase], measured: Callable[[AnyCase, Path, SceneOf], CaseRows]) -> None:
    """Write the folder of a case with the rows that `measured` makes of it and the folder of the twins."""
    config = task.config
    with writing(task.out / CASES, config.digest) as folder:
        result = measured(config, task.out / TWINS, task.scene_of)
        facts = {"title": config.title, "config": config.model_dump(mode="json"), "versions": versions()}
        write_atomically(folder / FACTS, strict_json(facts, indent=1).encode())
        write_atomically(folder / RESULT, strict_json(result).encode())


def case_maker(out: Path, digest: str) -> tuple[str, Maker]:
    """Name of a finished case in a study's folder, and what made it."""
    facts = json.loads((out / CASES / digest / FACTS).read_text(encoding="utf-8"))
    return f"case {digest}", facts["versions"]


def measure_missing(
    out: Path,
    configs: Sequence[AnyCase],
    work: Callable[[CaseTask[AnyCase]], None],
    executor: Executor,
    program: str,
    scene_of: SceneOf = look_scene,
) -> list[Failure]:
    """Measure the cases that are not there yet, and the twins that they need; returns those that were given up.

    work: what a worker does with a case. program: what reasons for giving up are said by.
    """
    distinct = {config.digest: config for config in configs}
    missing = [config for digest, config in distinct.items() if finished_case(out / CASES, digest) is None]
    twins = {twin.digest: twin for config in missing for twin in config.twins}
    needed = [twin for digest, twin in twins.items() if finished_case(out / TWINS, digest) is None]
    stages = [
        [Job(twin.title, do_twin, TwinTask(out, twin, scene_of)) for twin in needed],
        [Job(config.title, work, CaseTask(out, config, scene_of)) for config in missing],
    ]
    if missing:
        check_alike(
            executor, out, [case_maker(out, digest) for digest in distinct if finished_case(out / CASES, digest)]
        )
    return executor.run(stages, len(distinct) - len(missing), reasons_once(program))


def measured(config: CaseConfig, twins: Path, scene_of: SceneOf = look_scene) -> CaseRows:
    """Rows of the study's tables. Detection and recovery are tried under the first light only."""
    tables: CaseRows = {"views": [], "incidence": [], "recovery_views": []}
    for view in lit_views(config, twins, scene_of):
        keys = view_keys(config, view)
        row = keys | view_counts(view)
        tables["incidence"] += [keys | counts for counts in incidence_counts(view)]
        if view.light == config.lights[0]:
            planned = first_look(view.measurement.burst, config.parameters, config.seed)
            row |= detection_counts(view, planned)
            if config.recovery:
                summary, takes = recovery_rows(view, planned, config)
                row |= summary
                tables["recovery_views"] += [keys | take for take in takes]
        tables["views"].append(row)
    return tables
