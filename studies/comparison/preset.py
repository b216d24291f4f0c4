"""What the comparison of planners runs: parts, planners, repetitions and ablations, read from a preset or a file."""

from typing import Annotated

from pydantic import Field, model_validator

from franbv.parameters import Count, Parameters
from franbv.planners import PlannerName
from materials.suggestion import suggest
from render.d435i import SensorSettings
from scenes.parts import PART_NAMES
from studies.base.config import Preset
from studies.comparison.links import LINKS
from studies.run.ablation import ABLATIONS
from studies.run.scene_settings import check_sensor, mounted

CORNER = "inside_corner"
"""The subject whose faces mirror each other."""


class ComparisonPreset(Preset):
    """A whole comparison."""

    title: str
    """Headline of the report."""
    runs: Count = 15
    """Runs of each planner on each part; run i of n starts at azimuth 360 i / n (paper, section VI)."""
    parts: tuple[str, ...] = PART_NAMES
    """Of parts A to D."""
    corner: str | None = "stainless_austenitic:bright"
    """Material of the inside corner, None = without it. Choice: a bracket bent from cold-rolled stainless sheet."""
    planners: tuple[PlannerName, ...] = ("fra", "pb", "re")
    """Planners, each on every part."""
    ablations: tuple[str, ...] = ()
    """Ablations by name, each with its planner on `ablated_parts`."""
    ablated_parts: tuple[str, ...] = ("C", "D")
    """Choice: the parts of shiny metal, on which the paper counts most recoveries."""
    links: tuple[str, ...] = ()
    """Links before the planner that are changed, by name, each with FRA and PB on `ablated_parts`."""
    ablation_runs: Count = 5
    """Runs of each ablation and of each changed link on each of these parts, of those above in even steps (choice: a
    third)."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root of all randomness."""
    lamps: str = "workshop"
    """Lamp preset."""
    sensor: SensorSettings = SensorSettings()
    """The camera."""
    parameters: Parameters = Parameters()
    """Of the method."""
    speed: bool = True
    """Whether planning times are measured against the sizes of map, image and candidate set."""

    @model_validator(mode="after")
    def _known(self) -> "ComparisonPreset":
        for words, known in (
            (self.parts, PART_NAMES),
            (self.ablated_parts, PART_NAMES),
            (self.ablations, tuple(ABLATIONS)),
            (self.links, tuple(LINKS)),
        ):
            for word in words:
                if word not in known:
                    raise ValueError(f"parts, ablations or links: there is no {word}; {suggest(word, known)}")
            if len(set(words)) < len(words):
                raise ValueError(f"parts, ablations or links: {max(words, key=words.count)} stands there twice")
        if not (self.parts or self.corner):
            raise ValueError("nothing to reconstruct; name parts, or a material for the corner")
        check_sensor(self.sensor)
        mounted(self.parameters, self.sensor)
        return self
