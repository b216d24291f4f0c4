"""The infrared imager in physical units: an OmniVision OV9282 behind an f/2 lens, as in the D435i.

Electron budget that the defaults give: 150 mW over 86 x 57 deg put 0.30 W/m^2 on a wall at 0.5 m (field of
0.51 m^2). A matte wall of albedo 0.5 answers with 0.047 W m^-2 sr^-1, which makes E = pi L T / (4 N^2) = 8.3 mW/m^2 on
the sensor: in 8.5 ms 2,730 photons or 1,040 electrons on one 3 um pixel, about 58 DN.
"""

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, model_serializer

from render.imager.band_pass import BandPass
from render.imager.polarisers import Polarisers

WAVELENGTH = 850e-9
"""Of the projector [m] (D400 datasheet: 850 +- 10 nm)."""
LEAST_GAIN = 16.0
"""The gain setting that means 1x (librealsense: 16 is the lowest, and recommended, gain)."""
MOST_GAIN = 248.0
"""The highest gain setting, 15.5x (librealsense: gain 16-248)."""
LONGEST_EXPOSURE_US = 165_000.0
"""[us] (librealsense, D435i: exposure 1-165000, default 8500)."""
MOST_LASER_POWER_MW = 360.0
"""Highest laser power [mW] (librealsense: 0-360)."""
REFERENCE_LASER_POWER_MW = 150.0
"""Laser power for which the projector layer is rendered [mW] (librealsense's default setting)."""
WHITE_LEVEL = 255.0
"""Largest 8-bit value [DN]."""


class ImagerSettings(BaseModel):
    """One imager and its exposure; both imagers of a camera share them.

    Electrons of a native pixel = E a t q / (h c / lambda), with E = pi L T / (4 N^2) of radiance L, pixel area a,
    exposure time t, quantum efficiency q, transmission T and f-number N; grey value = pedestal + dn_per_electron *
    electrons, with shot and read noise, cut to 0-255 and rounded. The response is linear up to white.
    `render.imager.expose` names what is left out. Unknown keys and numbers out of range raise pydantic's
    ValidationError.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    exposure_us: float = Field(default=8500.0, ge=1.0, le=LONGEST_EXPOSURE_US)
    """Exposure time [us] (librealsense, default of the D435i)."""
    gain: float = Field(default=LEAST_GAIN, ge=LEAST_GAIN, le=MOST_GAIN)
    """Gain in librealsense's units, 16 = 1x."""
    laser_power_mw: float = Field(default=REFERENCE_LASER_POWER_MW, ge=0.0, le=MOST_LASER_POWER_MW)
    """Average optical power while the projector is on [mW] (librealsense: 0-360, default 150)."""
    laser_pulse_us: float | None = Field(default=None, gt=0.0)
    """Longest time that the projector is on within one exposure [us]; None: as long as the exposure, with which the
    D435i's projector pulses (librealsense maintainers)."""
    f_number: float = Field(default=2.0, gt=0.0)
    """D400 datasheet, D430 module."""
    transmission: float = Field(default=0.9, gt=0.0, le=1.0)
    """Of lens and cover glass at 850 nm [-] (choice: coated module lens)."""
    quantum_efficiency: float = Field(default=0.38, gt=0.0, le=1.0)
    """Electrons per photon at 850 nm [-] (choice: typical of a 3 um silicon pixel without infrared enhancement)."""
    full_well: float = Field(default=6000.0, gt=0.0)
    """Electrons that one native pixel holds (choice: usual for a 3 um global-shutter pixel). It sets the noise: at
    848x480 the quietest patches of a real D435 frame have second-difference noise of 0.5 DN at 42 DN and 0.7 DN at
    105 DN, these settings give 0.4 and 0.6. The D415's smaller pixels get the same (choice: it is then 4.6 times less
    sensitive, the ratio of the pixels' areas; Intel's paper on moving cameras says about 5 times)."""
    read_noise: float = Field(default=2.5, ge=0.0)
    """Root mean square of one native pixel in the dark [e-] (choice: usual for such pixels; 0.1 DN at gain 16)."""
    pedestal: float = Field(default=17.0, ge=0.0, lt=WHITE_LEVEL)
    """8-bit value in the dark [DN] (measured on real frames)."""
    set_point: float = Field(default=96.0, gt=0.0, lt=WHITE_LEVEL)
    """Mean that auto-exposure aims at [DN]: 1536 in the D435's default preset, read as 12 bits since librealsense
    states no unit. A real D435 frame averages 100 DN over its middle 80 %."""
    lens_sigma_um: float = Field(default=2.25, ge=0.0)
    """Standard deviation of the lens's Gaussian point spread in focus [um]. Choice: contrast 0.5 at half the native
    Nyquist frequency; with pixel and rectification it gives edges of 0.70 px at 848x480, the sharpest in a real frame
    are 0.72-0.77 px."""
    focus_distance: float | None = Field(default=None, gt=0.0, le=1000.0)
    """Distance at which the fixed lenses are focused [m]; None: the hyperfocal distance of one native pixel, f^2 / (N
    p) = 0.62 m (D415: 1.27 m). Choice: Intel publishes none. From there on all things farther than half of it, 0.31 m,
    are sharp to a pixel, and Intel has the D435's ideal range begin at 0.3 m."""
    veiling_glare: float = Field(default=0.02, ge=0.0, lt=1.0)
    """Share of the light that lens and cover glass spread wide over the image [-]: the veiling glare index that ISO
    9358 measures. Choice: ten surfaces of a module's five lenses that send back 1 % each, far from the visible light
    that their coating is for, before a chip that reflects a fifth."""
    glare_width_um: float = Field(default=500.0, gt=0.0)
    """Width b of the stray light on the chip [um], half of which stays within sqrt(3) b of where it belongs (choice: an
    eighth of the chip's width, so that it fogs the whole image, more so near bright things)."""
    band_pass: BandPass | None = None
    """A filter before both lenses; None as in the camera, which has none (D400 datasheet). On the command line it takes
    a YAML file to put one there."""
    polarisers: Polarisers | None = None
    """Polarisers before lenses, projector and lamps; None as in the camera, which has none. They change the light that
    is rendered (`render.light.polarisation`). On the command line it takes a YAML file to put them there."""
    vignetting_exponent: float = Field(default=4.0, ge=0.0)
    """Irradiance falls with cos(field angle) to this power (natural vignetting of a rectilinear lens)."""
    laser_modes: float = Field(default=10.0, ge=1.0)
    """Mutually incoherent transverse modes that light one dot (choice for a multimode VCSEL: speckle contrast then is
    0.052 at 848x480, where the dots of a real D435 pair differ by 0.04-0.06 left from right)."""
    laser_linewidth_nm: float = Field(default=1.0, ge=0.0)
    """Full width at half maximum of the projector's spectrum [nm] (typical of multimode VCSELs)."""
    surface_height_um: float = Field(default=3.0, ge=0.0)
    """Standard deviation of the heights of rough surfaces inside one resolved spot [um] (choice: a machined metal
    surface); with it the spectrum's width blurs speckle. How smooth ones lose theirs, `render.imager.surface_speckle`
    says."""

    @model_serializer(mode="wrap")
    def _without_what_is_absent(self, serialize: Callable[..., dict[str, Any]]) -> dict[str, Any]:
        """Cases of cameras without polarisers keep the names that they had before there were any."""
        fields = serialize(self)
        if self.polarisers is None:
            fields.pop("polarisers", None)
        return fields

    @property
    def dn_per_electron(self) -> float:
        """Conversion gain [DN/e-]: at gain 16 the full well is white."""
        return (WHITE_LEVEL - self.pedestal) / self.full_well * self.gain / LEAST_GAIN

    @property
    def laser_on_us(self) -> float:
        """Time within one exposure that the projector is on [us]."""
        return self.exposure_us if self.laser_pulse_us is None else min(self.exposure_us, self.laser_pulse_us)
