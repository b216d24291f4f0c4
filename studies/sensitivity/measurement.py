"""One case of a sensitivity study, from its configuration to its folder."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.base.atomic_file import write_atomically
from studies.base.case_folder import writing
from studies.base.console import strict_json
from studies.sensitivity.cases import CaseConfig, TwinConfig
from studies.sensitivity.counts import incidence_counts, view_counts, view_keys
from studies.sensitivity.planning import detection_counts, first_look, recovery_rows
from studies.sensitivity.twins import make_twin
from studies.sensitivity.views import lit_views
from studies.work.maker import Maker, versions

FACTS, RESULT = "case.json", "result.json"
"""Files of a case: what was measured, and what came out."""
CASES, TWINS = "cases", "twins"
"""Sub-folders of the study."""


@dataclass(frozen=True)
class CaseTask:
    """A case to be measured in a study's folder."""

    out: Path
    config: CaseConfig


@dataclass(frozen=True)
class TwinTask:
    """A twin to be measured in a study's folder."""

    out: Path
    config: TwinConfig


def do_twin(task: TwinTask) -> None:
    """For a worker."""
    make_twin(task.out / TWINS, task.config)


def do_case(task: CaseTask) -> None:
    """For a worker: measure the case and write its folder."""
    config = task.config
    with writing(task.out / CASES, config.digest) as folder:
        result = measured(config, task.out / TWINS)
        facts = {"title": config.title, "config": config.model_dump(mode="json"), "versions": versions()}
        write_atomically(folder / FACTS, strict_json(facts, indent=1).encode())
        write_atomically(folder / RESULT, strict_json(result).encode())


def case_maker(out: Path, digest: str) -> tuple[str, Maker]:
    """Name of a finished case in a study's folder, and what made it."""
    facts = json.loads((out / CASES / digest / FACTS).read_text(encoding="utf-8"))
    return f"case {digest}", facts["versions"]


def measured(config: CaseConfig, twins: Path) -> dict[str, list[dict[str, Any]]]:
    """Rows of the study's tables. Detection and recovery are tried under the first light only."""
    tables: dict[str, list[dict[str, Any]]] = {"views": [], "incidence": [], "recovery_views": []}
    for view in lit_views(config, twins):
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
