"""What a study of mitigations will cost, before it is begun."""

from collections.abc import Sequence
from pathlib import Path

from studies.advise.scoring import frames_needed
from studies.base.case_folder import finished_case
from studies.base.numbers_as_text import counted
from studies.mitigations.cases import MitigationCase, tried_remedies
from studies.sensitivity.measurement import CASES

RENDERING_S = 1.0
"""Processor time of a rendering of a coupon with its truth [s], measured at 640x360: 1.0 to 1.6."""
COUNTING_S = 0.06
"""Processor time of a frame that is exposed, matched and counted [s], measured at 640x360: 0.08 for one, 0.03 for
each of nine."""


def case_seconds(case: MitigationCase) -> float:
    """Processor time that a case takes, roughly [s]."""
    setups = [setup for _, setup in tried_remedies(case, True).values()]
    looks = [look for setup in setups for look in (setup.first_look, setup.second_look) if look]
    lights = {look.light.model_dump_json() for look in looks}
    frames = sum(frames_needed(look) * (1 if look.hdr_us is None else 2) for look in looks)
    poses = len(case.settings.pose)
    return poses * (RENDERING_S * len(lights) + COUNTING_S * frames * len(case.seeds))


def cost_line(out: Path, cases: Sequence[MitigationCase]) -> str:
    """How many cases are missing, and about what they cost."""
    missing = [case for case in cases if finished_case(out / CASES, case.digest) is None]
    each = case_seconds(cases[0])
    return (
        f"{counted(len(cases), 'case')}, {len(cases) - len(missing)} of them finished in {out}. The others take about "
        f"{len(missing) * each / 60:.0f} minutes of processor time, {each:.0f} s each; two free cores need half of it."
    )
