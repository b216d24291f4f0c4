"""What a study promises, as data: the chosen setting, what holds with which confidence, and where it does not."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from jaxtyping import Float
from scipy.stats import binomtest

from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.thresholds.choose import Choice, Repetitions, exceeded, known_mean
from studies.thresholds.config import RISK_MEANINGS, VIEW_RISKS, Bearable
from studies.thresholds.draw import run_draw, view_draw
from studies.thresholds.score import read_scores
from studies.thresholds.stress import STRESSES
from studies.thresholds.study import DrawnEvidence, Setting, Study

CERTIFICATE, SETTINGS_FILE = "certificate.json", "thresholds.yaml"
"""What a study leaves for programs, and for the other commands."""
CERTIFICATE_FORMAT = 1
"""Of the first."""
CELL_CONFIDENCE = 0.95
"""One-sided, of what is said of a combination of the domain (the usual one)."""
FEWEST_IN_CELL = 5
"""Draws of a combination below which nothing is said of it (choice)."""


@dataclass(frozen=True)
class Promise:
    """One risk of the chosen setting on the certifying draws."""

    risk: str
    most: float
    level: float
    draws: int
    """That say something of it."""
    exceeding: int

    @property
    def share(self) -> float:
        """Of the draws that exceed."""
        return self.exceeding / self.draws if self.draws else 0.0


@dataclass(frozen=True)
class Combination:
    """A part of a material under lamps: what of the domain's draws of it exceeds."""

    part: str
    material: str
    lamps: str
    promises: tuple[Promise, ...]

    @property
    def broken(self) -> tuple[str, ...]:
        """Risks that are beyond their level here, although they are within it over the domain."""
        return tuple(p.risk for p in self.promises if lower_share(p.exceeding, p.draws) > p.level)


@dataclass(frozen=True)
class Stressed:
    """What the shown setting does under a mismatch."""

    name: str
    words: str
    promises: tuple[Promise, ...]
    """By the draws that the mismatch changes."""

    @property
    def verdict(self) -> str:
        """`breaks`: a level is exceeded beyond doubt; `holds`: none is, beyond doubt; else `not told`."""
        if any(lower_share(p.exceeding, p.draws) > p.level for p in self.promises):
            return "breaks"
        holds = all(upper_share(p.exceeding, p.draws) <= p.level for p in self.promises)
        return "holds" if holds else "not told"


def upper_share(exceeding: int, draws: int) -> float:
    """Upper end of the one-sided Clopper-Pearson interval of a share; 1 of too few draws."""
    if draws < FEWEST_IN_CELL:
        return 1.0
    return float(binomtest(exceeding, draws, alternative="less").proportion_ci(CELL_CONFIDENCE, "exact").high)


def stressed(study: Study, setting: Setting) -> tuple[Stressed, ...]:
    """Of every mismatch whose views are finished."""
    risks = {name: study.preset.risks[name] for name in study.preset.view_risks}
    rows = []
    for name, tasks in study.stress_tasks(setting).items():
        found = [read_scores(task).risks for task in tasks if task.file.exists()]
        if found:
            numbers = {risk: np.stack(found)[:, :, VIEW_RISKS.index(risk)] for risk in risks}
            flags = exceeded(numbers, risks)
            rows.append(
                Stressed(name, STRESSES[name].words, tuple(promise(r, risks[r], flags[r][:, 0]) for r in risks))
            )
    return tuple(rows)


def lower_share(exceeding: int, draws: int) -> float:
    """Lower end of the one-sided Clopper-Pearson interval of a share; 0 of too few draws."""
    if draws < FEWEST_IN_CELL:
        return 0.0
    test = binomtest(exceeding, draws, alternative="greater")
    return float(test.proportion_ci(CELL_CONFIDENCE, "exact").low)


@dataclass(frozen=True, eq=False)
class Certificate:
    """All that the page and the files say."""

    study: Study
    evidence: DrawnEvidence
    choice: Choice
    repetitions: Repetitions
    promises: tuple[Promise, ...]
    """Of the chosen setting, or of the most promising one where none is certified."""
    combinations: tuple[Combination, ...]
    stresses: tuple[Stressed, ...]
    shown: int
    """Number of the setting that promises and combinations are of."""

    @property
    def certified(self) -> bool:
        """Whether there is a setting that keeps all levels."""
        return self.choice.chosen is not None


def shown_setting(study: Study, evidence: DrawnEvidence, choice: Choice) -> int:
    """The chosen setting; where none is certified, the one that comes nearest."""
    risks = study.preset.risks
    return (
        least_beyond(exceeded(evidence.scores, risks, evidence.cameras), risks)
        if choice.chosen is None
        else choice.chosen
    )


def certificate_of(study: Study, evidence: DrawnEvidence, choice: Choice, repetitions: Repetitions) -> Certificate:
    """Gather it."""
    risks, shown = study.preset.risks, shown_setting(study, evidence, choice)
    flags = exceeded(evidence.scores, risks, evidence.cameras)
    tested = {name: flags[name][study.dealt(len(flags[name]))[1], shown] for name in risks}
    promises = tuple(promise(name, risks[name], tested[name]) for name in risks)
    return Certificate(
        study,
        evidence,
        choice,
        repetitions,
        promises,
        combinations(study, evidence, flags, shown),
        stressed(study, evidence.settings[shown]),
        shown,
    )


def least_beyond(flags: Mapping[str, Float[np.ndarray, "_ k"]], risks: Mapping[str, Bearable]) -> int:
    """The setting whose worst risk is least beyond its level, by all draws."""
    return int(
        np.argmin(np.max([np.nan_to_num(known_mean(flags[name])) / risks[name].level for name in risks], axis=0))
    )


def promise(name: str, bearable: Bearable, flags: Float[np.ndarray, "n"]) -> Promise:
    """Of a risk, from draws; NaN says nothing."""
    known = flags[~np.isnan(flags)]
    return Promise(name, bearable.most, bearable.level, len(known), int(known.sum()))


def combinations(
    study: Study, evidence: DrawnEvidence, flags: Mapping[str, Float[np.ndarray, "_ k"]], shown: int
) -> tuple[Combination, ...]:
    """Every part, material and lamp of the domain that was drawn, by all of its draws."""
    preset = study.preset
    found: dict[tuple[str, str, str], dict[str, list[float]]] = {}
    for name in preset.risks:
        drawn = view_draw if name in VIEW_RISKS else run_draw
        for number, flag in zip(evidence.numbers[name], flags[name][:, shown], strict=True):
            draw = drawn(preset.domain, preset.seed, int(number))
            place = found.setdefault((draw.part, draw.material, draw.lamps), {})
            place.setdefault(name, []).append(float(flag))
    return tuple(
        Combination(*where, tuple(promise(name, preset.risks[name], np.array(f)) for name, f in rows.items()))
        for where, rows in sorted(found.items())
    )


def write_settings(out: Path, certificate: Certificate) -> Path | None:
    """`thresholds.yaml` as `reconstruct --config`, `replay --config` and `run --parameters` take it. It says something
    of the camera where that was chosen, too.

    None where nothing is certified; one of an earlier state is then taken away.
    """
    path = out / SETTINGS_FILE
    if not certificate.certified:
        path.unlink(missing_ok=True)
        return None
    setting = certificate.evidence.settings[certificate.shown]
    camera = certificate.study.cameras[setting.camera]
    chosen = {name: value for name, value in setting.values.items() if name not in camera.values}
    stated = {"parameters": setting.parameters.model_dump(mode="json", exclude_defaults=True) | chosen}
    stated |= {"sensor": camera.section} if camera.values else {}
    lines = [f"# {certificate.study.preset.title}", *(f"# {words}" for words in promise_lines(certificate))]
    text = "\n".join([*lines, yaml.safe_dump(stated, sort_keys=True)])
    write_atomically(path, text.encode())
    return path


def promise_lines(certificate: Certificate) -> list[str]:
    """The guarantee in words, a line per risk."""
    confidence = certificate.study.preset.confidence
    return [
        f"{p.risk.replace('_', ' ')}: at most {100 * p.level:g} % of {'views' if p.risk in VIEW_RISKS else 'runs'} "
        f"have more than {p.most:g} ({RISK_MEANINGS[p.risk]}); {p.exceeding} of {p.draws} did"
        for p in certificate.promises
    ] + [f"all of it at once with confidence {confidence:g}, for draws of the declared domain"]


def certificate_json(certificate: Certificate) -> dict[str, Any]:
    """`certificate.json`."""
    preset = certificate.study.preset
    settings = certificate.evidence.settings
    return {
        "format": CERTIFICATE_FORMAT,
        "title": preset.title,
        "certified": certificate.certified,
        "confidence": preset.confidence,
        "settings": settings[certificate.shown].values if certificate.certified else None,
        "certified_settings": [settings[k].values for k in certificate.choice.certified],
        "promises": [{**vars(p), "share": p.share, "meaning": RISK_MEANINGS[p.risk]} for p in certificate.promises],
        "combinations": [
            {"part": c.part, "material": c.material, "lamps": c.lamps, "broken": list(c.broken),
             "exceeding": {p.risk: [p.exceeding, p.draws] for p in c.promises}}
            for c in certificate.combinations
        ],
        "stresses": [
            {"name": s.name, "words": s.words, "verdict": s.verdict,
             "exceeding": {p.risk: [p.exceeding, p.draws] for p in s.promises}}
            for s in certificate.stresses
        ],
        "repetitions": vars(certificate.repetitions),
        "domain": settings[certificate.shown].bank.domain.model_dump(mode="json"),
    }  # fmt: skip


def write_certificate(out: Path, certificate: Certificate, more: Mapping[str, Any]) -> None:
    """Write `certificate.json`. more: further objects of it, by name."""
    content = {**certificate_json(certificate), **more}
    write_atomically(out / CERTIFICATE, strict_json(content, indent=1).encode())


def means(evidence: DrawnEvidence, names: Sequence[str]) -> dict[str, Float[np.ndarray, "k"]]:
    """Mean number of each risk by setting, over the draws that say something."""
    return {name: known_mean(evidence.scores[name]) for name in names}
