"""What a thresholds study is asked: the declared domain, the risks that can be borne, the settings, the budget."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from franbv.parameters import Count, Parameters
from materials.suggestion import suggest
from render.d435i import SensorSettings
from scenes.build import COUPONS, BenchName
from scenes.parts import ALL_PARTS
from studies.base.config import Config, Preset
from studies.dataset.config import Weights
from studies.sensitivity.preset import OWN
from studies.thresholds.sensors import SENSOR_CHOICES, check_sensor_names, sensor_names

VIEW_RISKS = ("false_recoveries", "missed_reflective_area", "false_depth_believed")
"""A draw is a view of a scene."""
RUN_RISKS = ("coverage_shortfall", "acquisitions")
"""A draw is a reconstruction of a scene."""
RESCORED = (
    "n_frames", "invalid_share", "located_on", "silhouette_of", "cluster_radius_voxels", "cluster_min_samples",
)  # fmt: skip
"""Parameters that a stored burst can be scored with anew; all others need reconstructions."""
RISK_MEANINGS = {
    "false_recoveries": "regions that would be recovered although less than half of their pixels are reflective holes",
    "missed_reflective_area": "share of the reflective holes' pixels that are in no region",
    "false_depth_believed": "share of the part's pixels with depth whose depth is false",
    "coverage_shortfall": "share of the visible surface that the map does not hold within 5 mm at the end",
    "acquisitions": "acquisitions of a reconstruction",
}
"""What of a draw is held against what is borne, by risk."""


class Bearable(Config):
    """What can be borne of one risk."""

    most: Annotated[float, Field(ge=0)]
    """A draw exceeds if its number is above this; the numbers are those of RISK_MEANINGS."""
    level: Annotated[float, Field(gt=0, lt=1)]
    """Largest probability that a draw exceeds [-]."""


class DomainMesh(Config):
    """A CAD file of the domain, as `franbv reconstruct --mesh` takes it."""

    file: Path
    units: str | None = None
    up: Literal["x", "y", "z"] | None = None
    material: tuple[str, ...]
    """Of the real thing."""


class Domain(Config):
    """What scenes are drawn from. Weights are relative; ranges are [lowest, highest]."""

    parts: Weights
    """Parts and coupons of ours, and the names of `meshes`."""
    meshes: dict[str, DomainMesh] = Field(default={})
    """CAD files by a name of yours."""
    materials: Weights = Field(default={OWN: 1})
    """`own`, or what the whole part is made of, as `--material` takes it."""
    materials_file: Path | None = None
    """YAML file with materials of your own."""
    bench: BenchName = "workshop"
    """What it stands on and in."""
    lamps: Weights
    """Lamp presets of the bench."""
    distance_m: tuple[Annotated[float, Field(ge=0.1, le=1.0)], Annotated[float, Field(ge=0.1, le=1.0)]] = (0.28, 0.38)
    """Of a view from the middle of the part, uniform [m]."""
    polar_deg: tuple[Annotated[float, Field(ge=0, le=85)], Annotated[float, Field(ge=0, le=85)]] = (20.0, 75.0)
    """Angle of a view from the vertical, uniform on the sphere [deg]; its azimuth is uniform."""
    sensor: SensorSettings = SensorSettings()
    """The camera, its preset, exposure and mount."""

    @model_validator(mode="after")
    def _known(self) -> "Domain":
        taken = [name for name in self.meshes if name in (*ALL_PARTS, *COUPONS)]
        if taken:
            raise ValueError(f"meshes: {taken[0]} is a part of ours; give the file another name")
        known = (*ALL_PARTS, *COUPONS, *self.meshes)
        for name in self.parts:
            if name not in known:
                raise ValueError(f"parts: there is no {name}; {suggest(name, known)}")
        for name, (low, high) in (("distance_m", self.distance_m), ("polar_deg", self.polar_deg)):
            if low > high:
                raise ValueError(f"{name}: the lower end {low:g} is above the upper end {high:g}; swap them")
        return self


class Budget(Config):
    """How much is drawn. What is drawn is kept; a larger budget adds to it."""

    views: Annotated[int, Field(ge=30)] = 600
    """Views of as many scenes."""
    reconstructions: Annotated[int, Field(ge=0)] = 60
    """Scenes that are reconstructed with each setting that is taken that far."""
    finalists: Count = 2
    """Settings that are taken that far: the best by the views that the order is learned on."""
    learn_share: Annotated[float, Field(gt=0, lt=1)] = 0.35
    """Share of the draws on which the order of the settings is learned; the rest certifies."""
    stress_views: Annotated[int, Field(ge=0)] = 40
    """Views under each mismatch between the declared cell and a real one; 0 = no such table."""
    repetitions: Annotated[int, Field(ge=0)] = 200
    """Times that the whole choice is repeated on other splits of the same draws, to count how often it is wrong."""


class ThresholdsPreset(Preset):
    """A whole study."""

    title: str
    """Headline of the certificate."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root of all randomness."""
    domain: Domain
    risks: Annotated[dict[str, Bearable], Field(min_length=1)]
    """Of VIEW_RISKS and RUN_RISKS, those that count; one that is left out is not promised."""
    confidence: Annotated[float, Field(gt=0.5, lt=1)] = 0.9
    """Probability that all risks of the chosen setting are within their levels at once."""
    prefer: str = "missed_reflective_area"
    """Among settings that are certified alike: the one whose mean of this is lowest; of RISK_MEANINGS."""
    settings: dict[str, Annotated[tuple[Any, ...], Field(min_length=1)]] = Field(default={})
    """Values to choose among, by the planner's parameter or by SENSOR_CHOICES; every combination is a setting."""
    parameters: Parameters = Parameters()
    """Of the method, what is not chosen."""
    budget: Budget = Budget()

    @model_validator(mode="after")
    def _sensible(self) -> "ThresholdsPreset":
        for name in (*self.risks, self.prefer):
            if name not in RISK_MEANINGS:
                raise ValueError(f"risks or prefer: there is no {name}; {suggest(name, RISK_MEANINGS)}")
        check_sensor_names(self.settings, self.domain.sensor)
        planner = [name for name in self.settings if name not in sensor_names(self.settings)]
        for name in planner:
            if name not in Parameters.model_fields:
                known = (*Parameters.model_fields, *SENSOR_CHOICES)
                raise ValueError(f"settings: the planner has no {name}; {suggest(name, known)}")
        if self.prefer in RUN_RISKS and not self.run_risks:
            raise ValueError(f"prefer: {self.prefer} shows in reconstructions alone; state it as a risk as well")
        dear = [name for name in planner if name not in RESCORED]
        if dear and not self.run_risks:
            raise ValueError(
                f"settings: {dear[0]} shows in reconstructions alone; state coverage_shortfall or leave it"
            )
        if self.run_risks and self.budget.reconstructions < 1:
            raise ValueError(f"risks: {self.run_risks[0]} needs reconstructions; raise budget.reconstructions")
        return self

    @property
    def view_risks(self) -> tuple[str, ...]:
        """Stated risks of views."""
        return tuple(name for name in VIEW_RISKS if name in self.risks)

    @property
    def run_risks(self) -> tuple[str, ...]:
        """Stated risks of reconstructions."""
        return tuple(name for name in RUN_RISKS if name in self.risks)
