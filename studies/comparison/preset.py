"""What the comparison of planners runs: parts, planners, repetitions and ablations, read from a preset or a file."""

from typing import Annotated

from pydantic import Field, model_validator

from franbv.known_planners import PlannerName
from franbv.parameters import Count, Parameters
from materials.suggestion import suggest
from render.d435i import SensorSettings
from scenes.build import COUPONS, BenchName
from scenes.parts import ALL_PARTS, PART_NAMES
from studies.base.config import Preset
from studies.comparison.links import LINKS
from studies.comparison.paper import PAPER_PARTS, PAPER_RUNS
from studies.run.ablation import ABLATIONS
from studies.run.scene_settings import check_sensor, mounted

CORNER = "inside_corner"
"""The subject whose faces mirror each other."""


class ComparisonPreset(Preset):
    """A whole comparison."""

    title: str
    """Headline of the report."""
    starts: Count = PAPER_RUNS
    """Starts around the part; start i of n stands at azimuth 360 i / n (paper, section VI)."""
    runs: Count = PAPER_RUNS
    """How many of the starts each planner runs from on each part, in even steps: a study of few runs is a piece of the
    one of all."""
    parts: tuple[str, ...] = PAPER_PARTS
    """Of our parts."""
    corner: str | None = None
    """Material of the inside corner, None = without it."""
    planners: tuple[PlannerName, ...] = ("fra", "pb", "re")
    """Planners, each on every part."""
    ablations: tuple[str, ...] = ()
    """Ablations by name, each with its planner on `ablated_parts`."""
    ablated_parts: tuple[str, ...] = ("C", "D")
    """Any part or coupon that can be reconstructed; on those that are not among `parts` the planners run from the
    starts of the ablations. Choice: the parts of shiny metal, on which the paper counts most recoveries."""
    coupon_material: str = "stainless_austenitic:bright"
    """Material of the coupons among them, but for the inside corner where `corner` names one (choice: the corner's)."""
    links: tuple[str, ...] = ()
    """Links before the planner that are changed, by name, each with FRA and PB on `ablated_parts`."""
    ablation_runs: Count = 5
    """Runs of each ablation and of each changed link on each of these parts, of those above in even steps (choice: a
    third of the paper's)."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root of all randomness."""
    bench: BenchName = "paper"
    """What the parts stand on."""
    lamps: str | None = None
    """Lamp preset, None = the bench's own."""
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
            (self.ablated_parts, (*ALL_PARTS, *COUPONS)),
            (self.ablations, tuple(ABLATIONS)),
            (self.links, tuple(LINKS)),
        ):
            for word in words:
                if word not in known:
                    raise ValueError(f"parts, ablations or links: there is no {word}; {suggest(word, known)}")
            if len(set(words)) < len(words):
                raise ValueError(f"parts, ablations or links: {max(words, key=words.count)} stands there twice")
        if self.runs > self.starts:
            raise ValueError(f"{self.runs} runs from {self.starts} starts: give as many starts")
        if not (self.parts or self.corner):
            raise ValueError("nothing to reconstruct; name parts, or a material for the corner")
        check_sensor(self.sensor)
        mounted(self.parameters, self.sensor)
        return self

    @property
    def start_numbers(self) -> tuple[int, ...]:
        """Of the starts that the planners run from."""
        return tuple(k * self.starts // self.runs for k in range(self.runs))

    @property
    def whole_parts(self) -> tuple[str, ...]:
        """Parts on which the planners run from all starts."""
        return (*self.parts, CORNER) if self.corner else self.parts

    @property
    def other_ablated_parts(self) -> tuple[str, ...]:
        """Parts of ablations and links on which they run from the starts of these alone."""
        changes = self.ablations or self.links
        return tuple(part for part in self.ablated_parts if part not in self.whole_parts) if changes else ()

    def material_of(self, part: str) -> tuple[str, ...]:
        """Material of a part; none where it comes with its own."""
        if part == CORNER and self.corner:
            return (self.corner,)
        return (self.coupon_material,) if part in COUPONS else ()

    @property
    def changed_start_numbers(self) -> tuple[int, ...]:
        """Of those among them from which ablations and changed links run."""
        n = min(self.ablation_runs, self.runs)
        return tuple(self.start_numbers[k * self.runs // n] for k in range(n))
