"""A small study of two coupons."""

from pathlib import Path

from studies.thresholds.command import resolved_preset
from studies.thresholds.config import ThresholdsPreset
from studies.thresholds.study import Study

STATED = {
    "title": "Balls <and> plates",
    "domain": {"parts": {"ball": 1, "plate": 1}, "materials": {"iron:blasted": 1}, "lamps": {"dim": 1, "off": 1}},
    "risks": {"false_recoveries": {"most": 0, "level": 0.3}, "missed_reflective_area": {"most": 0.9, "level": 0.3}},
    "settings": {"n_frames": [1, 3], "cluster_min_samples": [5, 400]},
    "budget": {"views": 60, "reconstructions": 0, "stress_views": 0, "repetitions": 50},
}
"""As its YAML file has it. With 400 pixels to a cluster nothing is ever found."""
PRESET = resolved_preset(ThresholdsPreset.model_validate(STATED))
STUDY = Study.of(Path("nowhere"), PRESET)
