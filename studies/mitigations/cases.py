"""The cases of a study of mitigations: one coupon of one material, and the remedies that are tried on it."""

from collections.abc import Mapping

from studies.advise.factors import Remedy
from studies.advise.poses import pose_texts
from studies.advise.settings import AdviseSettings, base_setup, checked_settings
from studies.advise.setup import Setup
from studies.base.case_folder import case_digest
from studies.base.config import Config
from studies.mitigations.declared import declared_remedies
from studies.mitigations.preset import MitigationsPreset
from studies.run.scene_settings import build_subject, resolved

MITIGATION_CASE = "mitigations 1"
"""What the hash of a case calls it; the number rises when its counts come to mean something else."""
ALIKE_WHEN_TILTED = ("ball", "lying_cylinder")
"""Coupons that a tilt about the world's x turns about an axis of their own: it would be blamed for changing nothing."""


class MitigationCase(Config):
    """All that decides the counts of a case."""

    settings: AdviseSettings
    """Coupon, material, light, camera, poses and seeds, resolved."""
    remedies: dict[str, tuple[str, ...]]
    """Levels by factor."""

    @property
    def digest(self) -> str:
        """Name of the case's folder."""
        return case_digest(MITIGATION_CASE, self)

    @property
    def coupon(self) -> str:
        """By name."""
        return str(self.settings.part)

    @property
    def material(self) -> str:
        """By name."""
        return self.settings.material[0]

    @property
    def metal(self) -> str:
        """By name; of what is no metal the material's."""
        return self.material.partition(":")[0]

    @property
    def finish(self) -> str | None:
        """By name; None of what is no metal."""
        return self.material.partition(":")[2] or None

    @property
    def title(self) -> str:
        """For people."""
        return f"{self.coupon.replace('_', ' ')}, {self.material}"

    @property
    def base(self) -> Setup:
        """The camera as it is set."""
        return base_setup(self.settings)

    @property
    def seeds(self) -> tuple[int, ...]:
        """Of the noise."""
        return tuple(range(self.settings.seed, self.settings.seed + self.settings.seeds))


def mitigation_cases(preset: MitigationsPreset) -> list[MitigationCase]:
    """Coupon by coupon, material by material; the poses of a coupon are the same for all of its materials."""
    return [
        MitigationCase(settings=settings.model_copy(update={"material": (spec,)}), remedies=dict(preset.remedies))
        for settings in (coupon_settings(preset, coupon) for coupon in preset.coupons)
        for spec in preset.specs()
    ]


def coupon_settings(preset: MitigationsPreset, coupon: str) -> AdviseSettings:
    """Of one coupon, in the first of the materials, with the poses spelt out."""
    asked = AdviseSettings(
        part=coupon,
        material=preset.specs()[:1],
        bench=preset.bench,
        lamps=preset.lamps,
        seed=preset.seed,
        sensor=preset.sensor,
        poses=preset.poses,
        distance=preset.distance,
        seeds=preset.seeds,
    )
    settings = resolved(checked_settings(asked))
    return settings.model_copy(update={"pose": pose_texts(settings, build_subject(settings).scene)})


def tried_remedies(case: MitigationCase, has_lamps: bool) -> Mapping[tuple[str, ...], tuple[tuple[Remedy, ...], Setup]]:
    """What is measured of a case, by its name as it is stored: the camera as it is set first, then every remedy."""
    base = case.base
    found: dict[tuple[str, ...], tuple[tuple[Remedy, ...], Setup]] = {(): ((), base)}
    for remedy in declared_remedies(base, case.remedies, has_lamps):
        if remedy.factor.name == "tilt of the part" and case.coupon in ALIKE_WHEN_TILTED:
            continue
        found[remedy.factor.name, remedy.level.name] = (remedy,), remedy.level.change(base)
    return found
