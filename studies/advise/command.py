"""`franbv advise`: which remedy helps on this part, with intervals, and the best combination of three."""

import math
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from materials.input_error import InputError
from render.matcher.d400_preset import is_file_name
from studies.advise.advice import advice_from, advice_json
from studies.advise.camera_files import SENSOR_FILE, VIEWER_PRESET, sensor_file, viewer_preset
from studies.advise.explained import EXPLAINED, explained_view, face_rows, losses
from studies.advise.flags import AdviseCommand
from studies.advise.poses import pose_texts
from studies.advise.score_store import SURFACE_COUNTS, ScoreStore
from studies.advise.search import Search
from studies.advise.sentences import advice_sentence, impossible_line, ranking_lines, untried_line
from studies.advise.settings import AdviseSettings, base_setup, checked_settings, subject_of
from studies.advise.setup import Setup
from studies.advise.stored_advice import ADVICE, StoredAdvice, read_stored_advice, stored_wall_s, write_stored_advice
from studies.advise.stored_light import LIGHT, LightStore
from studies.base.atomic_file import write_atomically
from studies.base.console import progress_bar, say, say_json, warn
from studies.base.flags import parse_wider_command
from studies.base.inputs import check_not_overwritten
from studies.base.output_errors import prepare_output
from studies.run.scene_settings import Subject, build_subject
from studies.run.stored_run import REPORT
from studies.work.maker import versions
from studies.work.study_clock import StudyClock

EXPLAINED_POSES = 2
"""Poses that are pictured and explained (choice: one from either side; causes take some ten seconds each)."""
_PROGRAM = "franbv advise"
_HELP = "Try the remedies for shiny metal on a part, rank them with intervals, and say what helps."


def run(args: list[str]) -> int:
    """Try remedies until time is up, then say what helps."""
    command = parse_wider_command(AdviseCommand, AdviseSettings, args, _PROGRAM, _HELP)
    if not (math.isfinite(command.minutes) and command.minutes > 0):
        raise InputError(f"--minutes {command.minutes:g}: is no time; give a number above 0")
    settings = checked_settings(command.settings)
    subject = build_subject(settings)
    for notice in subject.notices:
        warn(f"{_PROGRAM}: {notice}")
    poses = pose_texts(settings, subject.scene)
    preset = settings.sensor.preset
    read = [settings.mesh, settings.materials_file, command.config, Path(preset) if is_file_name(preset) else None]
    check_not_overwritten(read, map(command.out.joinpath, (ADVICE, REPORT, VIEWER_PRESET, SENSOR_FILE)))
    prepare_output(command.out)
    clock = StudyClock.started(
        command.out, [command.out / name for name in (LIGHT, SURFACE_COUNTS, EXPLAINED)], stored_wall_s(command.out)
    )
    stored = advised(command.out, settings, subject, poses, 60 * command.minutes, clock)
    clock.stop()
    _tell(command, stored, rebuild(command.out))
    return 0


def advised(
    out: Path, settings: AdviseSettings, subject: Subject, poses: tuple[str, ...], total_s: float, clock: StudyClock
) -> StoredAdvice:
    """Search, explain, and write what the page is made of."""
    lights = LightStore(out, subject_of(settings), subject.scene, poses, settings.sensor.mount_roll_deg)
    seeds = tuple(range(settings.seed, settings.seed + settings.seeds))
    scores = ScoreStore(lights, seeds)
    ends = time.monotonic() + total_s - clock.elapsed_s()
    scene = subject.scene
    base = base_setup(settings)
    has_lamps = bool(scene.lamps) or scene.ambient_radiance > 0
    with progress_bar() as progress:
        task = progress.add_task("rendering", total=None)
        search = Search(
            base, scores, ends, total_s, has_lamps, lambda step: progress.update(task, description=step, advance=1)
        )
        tried = search.run()
    advice, best = advice_from(tried, search.n_poses, len(seeds))
    words = _explained(scores, base, best.setup, min(EXPLAINED_POSES, search.n_poses))
    stored = StoredAdvice(
        title=subject.title,
        advice=advice,
        headline=advice_sentence(advice, words["lost_before"]),
        untried=tuple(remedy.title for remedy in search.untried),
        impossible=tuple(remedy.title for remedy in search.impossible),
        poses=poses[: search.n_poses],
        settings=settings.model_dump(mode="json"),
        versions=versions(),
        wall_s=clock.elapsed_s(),
        **words,
    )
    write_atomically(out / VIEWER_PRESET, viewer_preset(best.setup).encode())
    write_atomically(out / SENSOR_FILE, sensor_file(best.setup, subject.title, advice.best.words).encode())
    write_stored_advice(out, stored)
    return stored


def _explained(scores: ScoreStore, base: Setup, best: Setup, n: int) -> dict[str, Any]:
    """Causes, faces and pictures before and after."""
    from studies.advise.pictures import picture_rows

    before = [explained_view(scores, base, index) for index in range(n)]
    after = before if best == base else [explained_view(scores, best, index) for index in range(n)]
    names = [body.name for body in scores.lights.scene.bodies]
    return {
        "lost_before": losses(before),
        "lost_after": losses(after),
        "faces": tuple(asdict(row) for row in face_rows(before, after, names)),
        "pictures": tuple(picture_rows(before, after)),
    }


def _tell(command: AdviseCommand, stored: StoredAdvice, report: Path) -> None:
    say(f"{stored.title}. {stored.headline}")
    for line in (*ranking_lines(stored.advice), untried_line(stored.untried), impossible_line(stored.impossible)):
        if line:
            say(line)
    files = ", ".join(str(command.out / name) for name in (VIEWER_PRESET, SENSOR_FILE))
    say(f"To use at once: {files}\nReport: {report}")
    if command.json:
        figures = advice_json(stored.advice)
        left_out = {"untried": list(stored.untried), "impossible": list(stored.impossible)}
        say_json({"folder": str(command.out), "wall_s": stored.wall_s, **figures, **left_out})


def rebuild(out: Path) -> Path:
    """The page from the folder alone; returns its path."""
    from studies.advise.report.page import advice_html

    path = out / REPORT
    write_atomically(path, advice_html(read_stored_advice(out)).encode())
    return path
