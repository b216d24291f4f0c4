"""What the finished cases of a study of mitigations say: tables, summary and page, made anew from its folder."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studies.advise.advice import RemedyScore
from studies.base.atomic_file import write_atomically
from studies.base.console import strict_json
from studies.mitigations.answers import CaseAnswer, stored_answers
from studies.mitigations.cases import MitigationCase
from studies.mitigations.columns import CASE_REMEDY_COLUMNS, MITIGATION_VIEW_COLUMNS
from studies.mitigations.findings import MitigationsFindings
from studies.mitigations.preset import MitigationsPreset
from studies.mitigations.sentences import advice_verdict_words
from studies.mitigations.tallies import is_winner, told_verdict
from studies.run.stored_run import REPORT
from studies.store.tables import write_rows
from studies.work.workers import Failure

MITIGATIONS_SUMMARY = "summary.json"
"""All figures, in the output folder."""
MITIGATION_TABLES = ("views.parquet", "remedies.parquet")
"""Counts of every view; every remedy on every case."""


def evaluate_mitigations(
    out: Path,
    preset: MitigationsPreset,
    cases: Sequence[MitigationCase],
    failures: Sequence[Failure],
    wall_s: float,
) -> tuple[MitigationsFindings, dict[str, Any]]:
    """Write tables, summary and page; returns the findings, and the summary without the map, for `--json`."""
    from studies.mitigations.report.page import mitigations_html

    found = MitigationsFindings.of(stored_answers(out, cases), len(cases))
    views, remedies = (out / name for name in MITIGATION_TABLES)
    write_rows(views, MITIGATION_VIEW_COLUMNS, (row for answer in found.answers for row in _view_rows(answer)))
    write_rows(remedies, CASE_REMEDY_COLUMNS, (row for answer in found.answers for row in _remedy_rows(answer)))
    summary = {**findings_json(found), "failed": len(failures), "wall_s": wall_s}
    stored = {**summary, "map": list(map(map_entry, found.answers)), "failures": [asdict(one) for one in failures]}
    write_atomically(out / MITIGATIONS_SUMMARY, strict_json(stored, indent=1).encode())
    write_atomically(out / REPORT, mitigations_html(preset, found).encode())
    return found, summary


def findings_json(found: MitigationsFindings) -> dict[str, Any]:
    """Figures over all cases."""
    kinds = [answer.advice.kind for answer in found.answers]
    return {
        "cases": len(found.answers),
        "planned": found.planned,
        "kinds": {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)},
        "headline": found.paragraph,
        "remedies": [asdict(one) for one in found.remedies],
        "common_advice": [{**asdict(one), "sentence": advice_verdict_words(one)} for one in found.advice],
        "polarisation": [asdict(one) for one in found.polarised],
    }


def map_entry(answer: CaseAnswer) -> dict[str, Any]:
    """One cell of the map."""
    winner, spray = answer.winner, answer.advice.ceiling
    return {
        **_case_keys(answer),
        "kind": answer.advice.kind,
        "base": answer.advice.base.right_share,
        "winner": f"{winner.name}: {winner.level}" if winner else None,
        "right": winner.right_share if winner else None,
        "gain": winner.gain if winner else None,
        "gain_lo": winner.gain_lo if winner else None,
        "gain_hi": winner.gain_hi if winner else None,
        "spray": spray.right_share if spray else None,
    }


def _case_keys(answer: CaseAnswer) -> dict[str, Any]:
    case = answer.case
    return {
        "case": case.digest,
        "coupon": case.coupon,
        "material": case.material,
        "metal": case.metal if case.finish else None,
        "finish": case.finish,
    }


def _view_rows(answer: CaseAnswer) -> Iterator[dict[str, Any]]:
    for tried in answer.tried:
        (remedy,) = tried.remedies or (None,)
        names = {"factor": remedy.factor.name, "level": remedy.level.name} if remedy else AS_SET
        for index, pose in enumerate(answer.case.settings.pose):
            for place, seed in enumerate(answer.case.seeds):
                shares = tried.shares
                areas = {name: float(getattr(shares, name)[index, place]) for name in ("seen", "right", "false")}
                yield {**_case_keys(answer), **names, "pose": pose, "seed": seed, **areas}


AS_SET = {"factor": "as set", "level": "as set"}
"""What tables call the camera without any remedy."""


def _remedy_rows(answer: CaseAnswer) -> Iterator[dict[str, Any]]:
    base = answer.advice.base
    yield {**_case_keys(answer), **AS_SET, **_figures(base), "verdict": "level", "wins": answer.winner is None}
    for score in answer.advice.remedies:
        names = {"factor": score.name, "level": score.level}
        told = {"verdict": told_verdict(score), "wins": is_winner(answer, score)}
        yield {**_case_keys(answer), **names, **_figures(score), **told}


def _figures(score: RemedyScore) -> dict[str, Any]:
    own = asdict(score)
    left_out = ("case", "coupon", "material", "metal", "finish", "factor", "level", "verdict", "wins")
    return {column.name: own[column.name] for column in CASE_REMEDY_COLUMNS if column.name not in left_out}
