"""All that a study of mitigations tells, gathered from the answers of its cases."""

from dataclasses import dataclass

from studies.mitigations.answers import CaseAnswer
from studies.mitigations.common_advice import JudgedAdvice, judged_advice
from studies.mitigations.polarised import PolarisedMaterial, polarised_materials
from studies.mitigations.sentences import study_paragraph
from studies.mitigations.tallies import RemedyTally, tallies


@dataclass(frozen=True, eq=False)
class MitigationsFindings:
    """All that is told."""

    answers: list[CaseAnswer]
    planned: int
    """Cases."""
    remedies: list[RemedyTally]
    advice: list[JudgedAdvice]
    polarised: list[PolarisedMaterial]
    paragraph: str

    @classmethod
    def of(cls, answers: list[CaseAnswer], planned: int) -> "MitigationsFindings":
        """Of the cases that are finished."""
        found = tallies(answers)
        words = study_paragraph(answers, found)
        return cls(answers, planned, found, judged_advice(answers), polarised_materials(answers), words)
