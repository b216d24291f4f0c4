"""The projector's static dot pattern, in the plane at unit distance, and its blurred copies.

Dots are isotropic Gaussians at the points of a saturated-minimum-distance process: uniform throws that are rejected
within `MINIMUM_SPACING` of an earlier dot. Measured on real D435 frames at 1280x720 (f = 642 px): 4.5 dots per 1000 px,
nearest neighbour 10.6 / 12.1 / 13.4 px (10th, 50th, 90th percentile), 3.7 to 5 px wide at half their height.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from jaxtyping import Float, Float32
from scipy.ndimage import gaussian_filter

from render.imager.lens import blur_sigma_px
from render.imager.settings import ImagerSettings
from render.world.rig import CAMERA_MODELS

FOCAL_REFERENCE_PX = 642.0
"""Focal length of the profile at which the dots were measured [px]."""
HALF_FIELD = (float(np.tan(np.radians(43.0))), float(np.tan(np.radians(28.5))))
"""Tangents of the half field angles, 86 x 57 deg (D435 projector, D400 datasheet)."""
DOT_DENSITY = 4.5e-3 * FOCAL_REFERENCE_PX**2
"""Dots per unit area of the plane at unit distance (measured: 4.5 per 1000 px)."""
MINIMUM_SPACING = 10.7 / FOCAL_REFERENCE_PX
"""Least distance of two dots; gives nearest neighbours of 10.8 / 11.8 / 13.8 px at the measured density."""
REFERENCE_STREAM = (1280, 720)
"""Stream in whose pixels the width of a dot is given."""
FWHM_PER_SIGMA = 2.0 * np.sqrt(2.0 * np.log(2.0))
"""Of a Gaussian."""


def _point_fwhm_px(model: str) -> float:
    """Width at half height of a point in focus in the reference stream: lens, rectification and pixel."""
    sigma = blur_sigma_px(REFERENCE_STREAM[0], ImagerSettings(), CAMERA_MODELS[model].chip.shown(*REFERENCE_STREAM))
    return float(FWHM_PER_SIGMA * np.sqrt(sigma**2 + 1 / 12))


def dot_width(model: str, fwhm_px: float) -> float:
    """Full width of a dot at half its height, in the plane at unit distance, of one so wide in 1280x720 images [px].

    A point of light is 2.1 px wide in them already (D415: 2.8 px), which is taken out.
    """
    return (
        float(np.sqrt(fwhm_px**2 - _point_fwhm_px(model) ** 2))
        / CAMERA_MODELS[model].focal_lengths_px[REFERENCE_STREAM]
    )


DOT_FWHM_PX = 4.8
"""Full width of a D435's dot at half its height, in 1280x720 images [px]. Choice: real frames have 3.7 to 5."""
DOT_FWHM = dot_width("d435i", DOT_FWHM_PX)
"""The same in the plane at unit distance."""
D415_DOTS = 10_000
"""Dots of the D415 (choice: it has two emitters, and Intel's white paper on projectors says of the D435 that it has
fewer spots, about 5000; taken as twice as many in all)."""
D415_HALF_FIELD = (float(np.tan(np.radians(33.5))), float(np.tan(np.radians(20.5))))
"""67 x 41 deg (D415, D400 datasheet)."""
BACKGROUND_SHARE = 0.2
"""Share of the light outside the dots: zero order and scatter of the diffractive element (choice; real dots stand on a
visible veil, and the measured peak over background of 3.8 holds between it and a lit workshop)."""
BRIGHTNESS_SPREAD = 0.15
"""Standard deviation of the dots' relative power (choice; real dots differ visibly)."""
TEXEL = 1.9e-3
"""Texel of the D435's sharp pattern: about four to a dot's width."""
BLUR_LEVELS = 8
"""Blurred copies; copy l is blurred by sigma_0 2^(l - 1), copy 0 is sharp."""
FIELD_MARGIN = 0.5
"""Margin around the field in the blurred copies, as a share of the half field, so that blurred edges fade out."""


@dataclass(frozen=True)
class ProjectorDots:
    """What a projector's dots are like, in the plane at unit distance."""

    half_field: tuple[float, float]
    """Tangents of the half field angles."""
    density: float
    """Dots per unit area."""
    minimum_spacing: float
    """Least distance of two dots."""
    fwhm: float
    """Full width of a dot at half its height."""
    texel: float
    """Of the sharp pattern: about four to a dot's width."""
    seed: int
    """The pattern is a property of the projector, not of the run."""

    @property
    def field_area(self) -> float:
        """Of the field."""
        return 4 * self.half_field[0] * self.half_field[1]

    @property
    def sigma(self) -> float:
        """Standard deviation of one sharp dot."""
        return float(self.fwhm / FWHM_PER_SIGMA)


def _like_d435(half_field: tuple[float, float], dots: int, seed: int) -> ProjectorDots:
    """As many dots over another field; spacing and width in the D435's proportion to the mean distance (choice)."""
    density = dots / (4 * half_field[0] * half_field[1])
    scale = float(np.sqrt(DOT_DENSITY / density))
    return ProjectorDots(half_field, density, MINIMUM_SPACING * scale, DOT_FWHM * scale, TEXEL * scale, seed)


PROJECTORS = {
    "d435i": ProjectorDots(HALF_FIELD, DOT_DENSITY, MINIMUM_SPACING, DOT_FWHM, TEXEL, seed=435),
    "d415": _like_d435(D415_HALF_FIELD, D415_DOTS, seed=415),
}
"""By camera model. The D415's two emitters count as one."""


def projector_dots(model: str, fwhm_px: float | None = None) -> ProjectorDots:
    """The dots of a camera model's projector; fwhm_px: width in its 1280x720 images, None = as in `PROJECTORS`.

    Their places and powers stay, and so does the light of each.
    """
    dots = PROJECTORS[model]
    if fwhm_px is None:
        return dots
    width = dot_width(model, fwhm_px)
    return replace(dots, fwhm=width, texel=dots.texel * width / dots.fwhm)


@dataclass(frozen=True, eq=False)
class DotPattern:
    """Relative brightness, mean 1 over the field, in coordinates (x / z, y / z) of the projector.

    Gaussian dots on a faint veil, placed at random with the density and spacing of real ones (head of the module): like
    the D435's pattern in its statistics and not dot by dot.
    """

    half_field: tuple[float, float]
    """Tangents of the half field angles."""
    sharp: Float32[np.ndarray, "h w"]
    """Over the field itself, row 0 at the top (negative y); the light ends at its edge."""
    blurred: Float32[np.ndarray, "levels h_wide w_wide"]
    """Over the field and its margin, dark outside the field."""
    sigma: float
    """Standard deviation of one sharp dot; the unit in which blur levels count."""


def dot_positions(rng: np.random.Generator, dots: ProjectorDots = PROJECTORS["d435i"]) -> Float[np.ndarray, "n 2"]:
    """Dot centres in the field at unit distance."""
    half = np.array(dots.half_field)
    wanted = round(dots.density * 4 * half[0] * half[1])
    cell = dots.minimum_spacing / np.sqrt(2.0)
    taken: dict[tuple[int, int], np.ndarray] = {}
    while len(taken) < wanted:
        for point in rng.uniform(-half, half, (4 * wanted, 2)):
            i, j = (int(c) for c in np.floor(point / cell))
            near = (taken.get((i + a, j + b)) for a in range(-2, 3) for b in range(-2, 3))
            if all(q is None or np.hypot(*(q - point)) >= dots.minimum_spacing for q in near):
                taken[i, j] = point
                if len(taken) == wanted:
                    break
    return np.array(list(taken.values()))


@cache
def dot_pattern(dots: ProjectorDots) -> DotPattern:
    """The pattern with these statistics; always the same one."""
    rng = np.random.default_rng(dots.seed)
    centres = dot_positions(rng, dots)
    powers = np.clip(rng.normal(1.0, BRIGHTNESS_SPREAD, len(centres)), 0.3, None)
    width, height = (int(np.ceil(2 * half / dots.texel)) for half in dots.half_field)
    sharp = _drawn(dots, centres, powers, width, height)
    # Half the resolution and a margin are enough for copies that are at least as blurred as a texel is wide.
    margin = [round(FIELD_MARGIN * n / 4) for n in (height, width)]
    coarse = sharp[: height // 2 * 2, : width // 2 * 2].reshape(height // 2, 2, width // 2, 2).mean(axis=(1, 3))
    padded = np.pad(coarse, [(m, m) for m in margin])
    sigma_px = dots.sigma / (2 * dots.texel)
    levels = [padded, *(gaussian_filter(padded, sigma_px * 2.0 ** (n - 1)) for n in range(1, BLUR_LEVELS))]
    return DotPattern(dots.half_field, sharp.astype(np.float32), np.stack(levels).astype(np.float32), dots.sigma)


def d435_pattern() -> DotPattern:
    """The pattern of the D435 and D435i, with the measured statistics."""
    return dot_pattern(PROJECTORS["d435i"])


def _drawn(
    dots: ProjectorDots, centres: Float[np.ndarray, "n 2"], powers: Float[np.ndarray, "n"], width: int, height: int
) -> np.ndarray:
    """The sharp pattern (height, width), mean 1."""
    image = np.zeros((height, width))
    sigma, half_field = dots.sigma, np.array(dots.half_field)
    radius = int(np.ceil(4 * sigma / dots.texel))
    scale = np.array([width, height]) / (2 * half_field)
    for (x, y), power in zip((centres + half_field) * scale - 0.5, powers, strict=True):
        columns = np.arange(max(round(x) - radius, 0), min(round(x) + radius + 1, width))
        rows = np.arange(max(round(y) - radius, 0), min(round(y) + radius + 1, height))
        across = np.exp(-0.5 * ((columns - x) / (sigma * scale[0])) ** 2)
        down = np.exp(-0.5 * ((rows - y) / (sigma * scale[1])) ** 2)
        image[np.ix_(rows, columns)] += power * np.outer(down, across)
    return BACKGROUND_SHARE + (1.0 - BACKGROUND_SHARE) * image / image.mean()
