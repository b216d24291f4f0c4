"""The certificate as one page that is read without us."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from studies.drawing.templates import environment, page_style
from studies.run.report.page import flattened
from studies.sensitivity.trust import spoken
from studies.thresholds.certificate import FEWEST_IN_CELL, Certificate, Combination, Promise, means
from studies.thresholds.choose import exceeded, known_mean
from studies.thresholds.config import RISK_MEANINGS, RUN_RISKS, VIEW_RISKS, Bearable
from studies.thresholds.report.precision_recall import precision_recall
from studies.thresholds.report.precision_recall_figure import DetectorCurves, detector_curves
from studies.thresholds.report.progress import read_progress
from studies.thresholds.report.progress_figure import ProgressFigures, ShownRuns, progress_figures
from studies.thresholds.report.setting_words import MARKS, mark_of, setting_words, told_apart
from studies.thresholds.report.tradeoff_figure import Dot, tradeoff_figure
from studies.work.workers import Failure


def certificate_html(certificate: Certificate, failures: Sequence[Failure]) -> str:
    """The whole page."""
    study, again = certificate.study, certificate.repetitions
    preset, setting = study.preset, certificate.evidence.settings[certificate.shown]
    domain = setting.bank.domain
    views = len(certificate.evidence.scores[VIEW_RISKS[0]])
    kinds = [words for words, risks in (("view", preset.view_risks), ("reconstruction", preset.run_risks)) if risks]
    config = preset.model_dump(mode="json", exclude={"domain"})
    return (
        environment("studies.thresholds.report")
        .get_template("certificate.html.j2")
        .render(
            title=preset.title,
            certified=certificate.certified,
            confidence=preset.confidence,
            draw_words=" or a ".join(kinds),
            promises=[promise_row(p) for p in certificate.promises],
            values=list(setting.values.items()),
            domain=list(flattened(domain.model_dump(mode="json", exclude={"sensor"}, exclude_none=True)))
            + list(flattened({"sensor": domain.sensor.model_dump(mode="json", exclude_defaults=True)})),
            fewest=FEWEST_IN_CELL,
            cameras=len(study.cameras),
            combinations=[combination_row(c) for c in certificate.combinations],
            stresses=[
                {"words": s.words, "verdict": s.verdict, "shares": shares(s.promises)} for s in certificate.stresses
            ],
            charts=charts(certificate),
            detector=detector(certificate),
            progress=progress(certificate),
            learned=len(study.dealt(views)[0]),
            prefer=spoken(preset.prefer),
            again=again,
            allowed=again.allowed(preset.confidence),
            failures=failures,
            config=list(flattened(config)),
            style=page_style(("studies.thresholds.report", "thresholds.css")),
        )
    )


def promise_row(p: Promise) -> dict[str, Any]:
    """Of the table of the guarantee."""
    unit = "views" if p.risk in VIEW_RISKS else "reconstructions"
    return {
        **vars(p),
        "most": f"{p.most:g}",
        "name": spoken(p.risk),
        "meaning": RISK_MEANINGS[p.risk],
        "unit": unit,
        "of_views": p.risk in VIEW_RISKS,
    }


def combination_row(c: Combination) -> dict[str, Any]:
    """Of the table of combinations."""
    where = {"part": c.part, "material": c.material, "lamps": c.lamps}
    return {**where, "broken": c.broken, "shares": shares(c.promises)}


def shares(promises: Sequence[Promise]) -> list[str]:
    """How many draws exceed, risk by risk."""
    return [f"{p.exceeding} of {p.draws}" if p.draws else "none says anything" for p in promises]


def charts(certificate: Certificate) -> list[tuple[str, Markup]]:
    """Heading and chart: what views tell of each setting, and reconstructions where there are any."""
    found = []
    scores, settings = certificate.evidence.scores, certificate.evidence.settings
    views = means(certificate.evidence, VIEW_RISKS)
    any_false = exceeded({"false_recoveries": scores["false_recoveries"]}, {"false_recoveries": NO_FALSE_REGION})
    x, y = 1 - views["missed_reflective_area"], known_mean(any_false["false_recoveries"])
    words = [
        f"{setting_words(s.values)}: finds {100 * a:.0f} % of the reflective holes, "
        f"false in {100 * b:.0f} % of the views"
        for s, a, b in zip(settings, x, y, strict=True)
    ]
    labels = "share of the reflective holes found, mean over views", "share of views with a false recovery"
    title = "Reflective holes found against false recoveries"
    found.append((title, tradeoff_figure(title, *labels, dots(certificate, x, y, words))))
    if all(name in scores and len(scores[name]) for name in RUN_RISKS):
        runs = means(certificate.evidence, RUN_RISKS)
        x, y = runs["acquisitions"], 1 - runs["coverage_shortfall"]
        words = [
            f"{setting_words(s.values)}: {100 * b:.0f} % covered in {a:.0f} acquisitions"
            for s, a, b in zip(settings, x, y, strict=True)
        ]
        title = "Coverage against acquisitions"
        labels = "acquisitions, mean over reconstructions", "share of the surface covered at the end"
        found.append((title, tradeoff_figure(title, *labels, dots(certificate, x, y, words))))
    return found


NO_FALSE_REGION = Bearable(most=0, level=0.5)
"""Not one false region."""


def dots(certificate: Certificate, x: np.ndarray, y: np.ndarray, words: Sequence[str]) -> list[Dot]:
    """One for each setting that both numbers are known of."""
    known = [k for k in range(len(words)) if np.isfinite(x[k]) and np.isfinite(y[k])]
    return [Dot(float(x[k]), float(y[k]), mark_of(certificate.choice, k), words[k]) for k in known]


def detector(certificate: Certificate) -> DetectorCurves:
    """Precision and recall of all views, under every setting that they were scored with."""
    study, choice, settings = certificate.study, certificate.choice, certificate.evidence.settings
    found = precision_recall(study.view_settings, study.region_pixels())
    marked = [(mark_of(choice, k), setting.view_setting) for k, setting in enumerate(settings)]
    highest = {number: klass for mark in MARKS for klass, number in marked if klass == mark}
    return detector_curves(found, highest)


def progress(certificate: Certificate) -> ProgressFigures | None:
    """How reconstructions get on under each setting that they were made with; None where none is finished."""
    settings = certificate.evidence.settings
    rows = [[read_progress(case) for case in row] for row in certificate.study.whole_runs(settings).values()]
    words = told_apart([setting.values for setting in settings])
    shown = [
        ShownRuns(words[k], k == certificate.choice.chosen, runs) for k, runs in enumerate(zip(*rows, strict=True))
    ]
    return progress_figures(shown) if shown else None
