"""What a study of readings runs: parts, starts and bench, read from a preset or a file."""

from typing import Annotated

from pydantic import Field, model_validator

from franbv.parameters import Count, Parameters
from render.d435i import SensorSettings
from scenes.build import BenchName
from studies.base.config import Preset
from studies.comparison.paper import PAPER_PARTS
from studies.comparison.preset import ComparisonPreset
from studies.readings.decisions import DECIDED_FIELDS, decided

READ_PLANNERS = ("pb", "fra")
"""What each reading is tried with; FRA after PB, from which it differs only after the first recovery, so that it finds
PB's bursts."""


class ReadingsPreset(Preset):
    """A whole study of readings."""

    title: str
    """Headline of the report."""
    parts: Annotated[tuple[str, ...], Field(min_length=1)] = ("C", "D")
    """Of the paper's. Choice: those of shiny metal, where its methods differ most."""
    starts: Count = 3
    """Starts around the part of each reading; start i of n stands at azimuth 360 i / n."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Root of all randomness; the starts have those of a comparison with the same root."""
    bench: BenchName = "paper"
    """What the parts stand on and in."""
    lamps: str | None = None
    """Lamp preset; None = the bench's own."""
    sensor: SensorSettings = SensorSettings()
    """The camera."""
    parameters: Parameters = Parameters()
    """Of the method, all but the decisions."""

    @model_validator(mode="after")
    def _known(self) -> "ReadingsPreset":
        for part in self.parts:
            if part not in PAPER_PARTS:
                raise ValueError(f"parts: the paper has no {part}; its parts are {', '.join(PAPER_PARTS)}")
        if len(set(self.parts)) < len(self.parts):
            raise ValueError(f"parts: {max(self.parts, key=self.parts.count)} stands there twice")
        first = decided(self.parameters, frozenset())
        own = [name for name in sorted(DECIDED_FIELDS) if getattr(self.parameters, name) != getattr(first, name)]
        if own:
            raise ValueError(f"parameters: {', '.join(own)}: the study itself decides that; leave it out")
        self.as_comparison(frozenset())
        return self

    def as_comparison(self, second: frozenset[str]) -> ComparisonPreset:
        """The comparison whose runs are those of the reading that has these decisions at their second level."""
        return ComparisonPreset(
            title=self.title,
            starts=self.starts,
            runs=self.starts,
            parts=self.parts,
            planners=READ_PLANNERS,
            seed=self.seed,
            bench=self.bench,
            lamps=self.lamps,
            sensor=self.sensor,
            parameters=decided(self.parameters, second),
            speed=False,
        )
