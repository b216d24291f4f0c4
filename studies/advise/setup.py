"""How camera, lamps and part are set up for one measurement, and which light that needs."""

from typing import Literal

from pydantic import Field

from render.d435i import SensorSettings
from render.depth.filters.chain import DepthFilters
from studies.base.config import Config

LampsName = Literal["own", "moved", "diffuse"]
"""As they are; the nearest swung round the part; the nearest behind a diffuser (`studies.advise.changed_scene`)."""


class Stand(Config):
    """Where the camera stands, counted from a pose around the part."""

    azimuth_deg: float = 0.0
    """Farther round the part [deg]."""
    roll_deg: float = 0.0
    """Turned about its optical axis beyond the mount's roll [deg]."""
    distance: float = Field(default=1.0, gt=0.0)
    """Distance to the part's middle, in distances of the pose [-]."""


class LightKey(Config):
    """All that decides which light the imagers get from a pose, but for the lamps' strength: setups that are alike in
    it are measured from one rendering."""

    stand: Stand
    tilt_deg: float
    lamps: LampsName
    sprayed: bool
    sensor: SensorSettings
    """`SensorSettings.light`."""


class Setup(Config):
    """One measurement, but for pose and noise."""

    sensor: SensorSettings
    """Resolved."""
    stand: Stand = Stand()
    tilt_deg: float = 0.0
    """Of the part about the world's x, on the table [deg]."""
    lamps: LampsName = "own"
    lamp_level: float = Field(default=1.0, ge=0.0)
    """Of the lamps' own radiance [-]."""
    sprayed: bool = False
    """The part's bodies as their matte twins."""
    frames: int = Field(default=1, ge=1)
    """Frames of which the median counts."""
    filters: DepthFilters | None = None
    """librealsense's, after decimation."""
    hdr_us: tuple[float, float] | None = None
    """Exposures of a pair in turns that `render.depth.filters.hdr_merge` joins [us]; instead of the sensor's."""
    second: Stand | None = None
    """A second look whose depth fills the holes of the first."""

    @property
    def light(self) -> LightKey:
        """What must be rendered for it."""
        return LightKey(
            stand=self.stand,
            tilt_deg=self.tilt_deg,
            lamps=self.lamps,
            sprayed=self.sprayed,
            sensor=self.sensor.light,
        )

    @property
    def first_look(self) -> "Setup":
        """The same without the second look."""
        return self.model_copy(update={"second": None})

    @property
    def second_look(self) -> "Setup | None":
        """The second look by itself; its stand counts from that of the first."""
        if self.second is None:
            return None
        stand = Stand(
            azimuth_deg=self.stand.azimuth_deg + self.second.azimuth_deg,
            roll_deg=self.stand.roll_deg + self.second.roll_deg,
            distance=self.stand.distance * self.second.distance,
        )
        return self.model_copy(update={"second": None, "stand": stand})

    def with_imager(self, **update: float) -> "Setup":
        """The same with these settings of the imagers."""
        return self.with_sensor(imager=self.sensor.imager.model_copy(update=update))

    def with_sensor(self, **update: object) -> "Setup":
        """The same with these settings of the sensor."""
        return self.model_copy(update={"sensor": self.sensor.model_copy(update=update)})
