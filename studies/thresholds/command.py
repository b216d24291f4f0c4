"""`franbv study thresholds`: settings with a guarantee for declared parts, and a certificate that says what it is."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from materials.input_error import InputError
from studies.base.atomic_file import write_atomically
from studies.base.console import say, say_json, strict_json
from studies.base.flags import parse
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.base.stored_preset import read_preset_file
from studies.run.batch import RUNS, stored_outcome
from studies.run.scene_settings import build_subject, preset_files, with_sensor_resolved
from studies.thresholds.bank import BANK, drawn_alike, replace_part
from studies.thresholds.certificate import (
    CERTIFICATE,
    SETTINGS_FILE,
    Certificate,
    certificate_of,
    promise_lines,
    shown_setting,
    write_certificate,
    write_settings,
)
from studies.thresholds.choose import budget_sentence, check_budget, exceeded
from studies.thresholds.config import VIEW_RISKS, ThresholdsPreset
from studies.thresholds.draw import subject_settings, view_draw
from studies.thresholds.reconstructions import cell_reference, do_run_draw
from studies.thresholds.reference import MONITOR, monitor_object
from studies.thresholds.score import ScoreTask, do_score
from studies.thresholds.sensors import (
    SensorAlternative,
    chosen_preset_files,
    sensor_alternatives,
    sensor_names,
    with_preset_texts,
)
from studies.thresholds.study import Study, chosen_of, repetitions_of
from studies.work.executor import Executor, WorkFlags, check_alike, executor_of, exit_status, reasons_once
from studies.work.study_clock import StudyClock
from studies.work.workers import Failure, Job

_PROGRAM = "franbv study thresholds"
_HELP = "Choose thresholds for declared parts, materials and lamps, and certify what they guarantee."
THRESHOLDS_STUDY, THRESHOLDS_SUMMARY, PAGE = "thresholds.json", "thresholds_summary.json", "certificate.html"
"""The resolved preset, the summary and the certificate for people, in the output folder."""
THRESHOLDS_FORMAT = 1
"""Of the first; it rises when draws come to go by other names."""


@dataclass(frozen=True)
class ThresholdsCommand:
    """The flags of `franbv study thresholds`."""

    out: Path
    """Output folder. What was drawn in it is kept and used again."""
    config: Annotated[str | None, tyro.conf.Positional, tyro.conf.arg(metavar="CONFIG.yaml")] = None
    """Domain, risks, settings and budget."""
    preset: Annotated[str, tyro.conf.arg(metavar="quick|FILE.yaml")] = "quick"
    """What to study where no CONFIG.yaml is given."""
    work: Annotated[WorkFlags, tyro.conf.arg(name="")] = field(default_factory=WorkFlags)
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Draw and score what is missing, choose, certify."""
    command = parse(ThresholdsCommand, args, _PROGRAM, _HELP)
    name = command.config or command.preset
    named = ThresholdsPreset.named(name)
    preset = resolved_preset(named)
    n_draws, cameras = stated_draws(preset), sensor_alternatives(preset.settings, preset.domain.sensor)
    for line in (*rendered_sentence(preset, cameras), *budget_sentence(n_draws, preset.budget, preset.confidence)):
        say(line)
    check_budget(n_draws, preset.risks, preset.budget, preset.confidence)
    check_scenes(preset)
    study = Study.of(command.out, preset)
    check_not_overwritten(
        [*preset_files(name, named.domain.sensor), *map(Path, chosen_preset_files(named.settings))],
        map(command.out.joinpath, (THRESHOLDS_STUDY, THRESHOLDS_SUMMARY, PAGE, CERTIFICATE, SETTINGS_FILE)),
    )
    with executor_of(command.work) as executor:  # before anything is written
        prepare_output(command.out)
        stored = {"format": THRESHOLDS_FORMAT, "preset": preset.model_dump(mode="json")}
        write_atomically(command.out / THRESHOLDS_STUDY, strict_json(stored, indent=1).encode())
        clock = StudyClock.started(
            command.out,
            [command.out / BANK, command.out / RUNS],
            stored_outcome(command.out / THRESHOLDS_SUMMARY).wall_s,
        )
        failures = draw_all(study, executor)
        failures = failures or draw_stressed(study, executor)
    certificate, summary = evaluate_thresholds(study, failures, clock.elapsed_s())
    clock.stop()
    say("\n".join([*sentences(certificate), f"Certificate: {command.out / PAGE}"]))
    if command.json:
        say_json({key: value for key, value in summary.items() if key != "failures"})
    return exit_status(failures)


def resolved_preset(preset: ThresholdsPreset) -> ThresholdsPreset:
    """With the sensor as the bench turns it and its preset's content, be it chosen among; the mount's roll is the
    planner's."""
    changed = {"domain": with_sensor_resolved(preset.domain), "settings": with_preset_texts(preset.settings)}
    return preset.model_copy(update=changed)


def rendered_sentence(preset: ThresholdsPreset, cameras: Sequence[SensorAlternative]) -> list[str]:
    """How many views the budget comes to where the camera is chosen, too."""
    n, views = len(cameras), preset.budget.views
    if not sensor_names(preset.settings):
        return []
    return [f"{n} cameras to choose among, {views} views by each: {n * views} views are rendered, or are there already"]


def stated_draws(preset: ThresholdsPreset) -> dict[str, int]:
    """Draws of the budget, by stated risk."""
    views, runs = preset.budget.views, preset.budget.reconstructions
    return {name: views if name in VIEW_RISKS else runs for name in preset.risks}


def check_scenes(preset: ThresholdsPreset) -> None:
    """InputError now for what would fail in every worker: a material, a lamp or a file that there is not."""
    domain = preset.domain
    draw = view_draw(domain, preset.seed, 0)
    for part in domain.parts:
        for material in domain.materials:
            build_subject(subject_settings(domain, replace_part(draw, part).model_copy(update={"material": material})))
    for lamps in domain.lamps:
        build_subject(subject_settings(domain, draw.model_copy(update={"lamps": lamps})))


def draw_all(study: Study, executor: Executor) -> list[Failure]:
    """Views first, then the reconstructions of the finalists that the views name."""
    tasks, tell = [task for draw in study.view_tasks for task in draw], reasons_once(_PROGRAM)
    missing = _missing(tasks)
    if missing:
        check_alike(executor, study.out)
    failures = executor.run([missing], len(tasks) - len(missing), tell)
    if failures or not study.preset.run_risks:
        return failures
    runs = study.run_tasks(study.settings(study.view_scores()))
    waiting = [Job(task.title, do_run_draw, task) for task in runs if task.case is None]
    return executor.run([waiting], len(runs) - len(waiting), tell)


def draw_stressed(study: Study, executor: Executor) -> list[Failure]:
    """The chosen setting under every mismatch."""
    views = study.view_scores()
    evidence = study.evidence(views, study.settings(views))
    shown = shown_setting(study, evidence, chosen_of(study, evidence))
    tasks = [task for row in study.stress_tasks(evidence.settings[shown]).values() for task in row]
    missing = _missing(tasks)
    return executor.run([missing], len(tasks) - len(missing), reasons_once(_PROGRAM)) if missing else []


def _missing(tasks: Sequence[ScoreTask]) -> list[Job]:
    """What is to be drawn or scored, in an order that is quick."""
    missing = sorted((task for task in tasks if not task.file.exists()), key=lambda task: drawn_alike(task.view))
    return [Job(task.title, do_score, task) for task in missing]


def evaluate_thresholds(study: Study, failures: list[Failure], wall_s: float) -> tuple[Certificate, dict[str, Any]]:
    """Choose, certify, write everything."""
    from studies.thresholds.report.page import certificate_html

    if not study.finished_views:
        raise InputError(f"{study.out}: no view could be drawn; mend what is said above, and give the command again")
    views = study.view_scores()
    evidence = study.evidence(views, study.settings(views))
    try:
        choice, repetitions = chosen_of(study, evidence), repetitions_of(study, evidence)
    except ValueError as error:  # of a risk too few draws say anything
        raise InputError(f"{study.out}: {error}") from error
    certificate = certificate_of(study, evidence, choice, repetitions)
    tasks = study.run_tasks([evidence.settings[certificate.shown]])
    watched = cell_reference([case for task in tasks if (case := task.case)], study.preset.seed)
    write_certificate(study.out, certificate, {} if watched is None else {MONITOR: monitor_object(watched)})
    write_settings(study.out, certificate)
    summary = thresholds_json(certificate, failures, wall_s)
    write_atomically(study.out / THRESHOLDS_SUMMARY, strict_json(summary, indent=1).encode())
    write_atomically(study.out / PAGE, certificate_html(certificate, failures).encode())
    return certificate, summary


def thresholds_json(certificate: Certificate, failures: list[Failure], wall_s: float) -> dict[str, Any]:
    """What `--json` prints, and the failures."""
    preset, again = certificate.study.preset, certificate.repetitions
    evidence, shown = certificate.evidence, certificate.shown
    flags = exceeded(evidence.scores, preset.risks, evidence.cameras)
    runs = {name: int(np.count_nonzero(~np.isnan(flags[name][:, shown]))) for name in preset.risks}
    setting = evidence.settings[shown]
    return {
        "settings": setting.values if certificate.certified else None,
        "risks": {p.risk: p.share for p in certificate.promises},
        "targets": {name: preset.risks[name].level for name in preset.risks},
        "confidence": preset.confidence,
        "runs": runs,
        "repetitions": again.runs,
        "violations": again.violations,
        "naive_violations": again.naive_violations,
        "silent": again.silent,
        "allowed": again.allowed(preset.confidence),
        "wall_s": wall_s,
        "failures": [asdict(failure) for failure in failures],
    }


def sentences(certificate: Certificate) -> list[str]:
    """For the terminal."""
    preset, again = certificate.study.preset, certificate.repetitions
    if certificate.certified:
        values = certificate.evidence.settings[certificate.shown].values
        first = ["Certified: " + ", ".join(f"{name} {value}" for name, value in values.items())]
        first += promise_lines(certificate)
    else:
        beyond = max(certificate.promises, key=lambda p: p.share / p.level)
        first = [
            f"No setting is certified: at best {beyond.risk} exceeds in {beyond.exceeding} of {beyond.draws} draws, "
            f"and {100 * beyond.level:g} % are borne; bear more, or give other settings or more draws"
        ]
    return [
        *first,
        f"Repeated on {again.runs} other splits: {again.violations} exceed a level "
        f"({again.allowed(preset.confidence):.1f} agree with confidence {preset.confidence:g}), "
        f"{again.naive_violations} of the naive choices do; in {again.silent} nothing is certified",
    ]


def rebuild(out: Path) -> Path:
    """All that is made of the draws, from the folder alone; returns the certificate's path."""
    before = stored_outcome(out / THRESHOLDS_SUMMARY)
    preset = read_preset_file(out / THRESHOLDS_STUDY, ThresholdsPreset, THRESHOLDS_FORMAT)
    evaluate_thresholds(Study.of(out, preset), before.failures, before.wall_s)
    return out / PAGE
