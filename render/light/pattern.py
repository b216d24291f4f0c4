"""The projector's static dot pattern, in the plane at unit distance, and its blurred copies.

Dots are isotropic Gaussians at the points of a saturated-minimum-distance process: uniform throws that are rejected
within `MINIMUM_SPACING` of an earlier dot. Measured on real D435 frames at 1280x720 (f = 642 px): 4.5 dots per 1000 px,
nearest neighbour 10.6 / 12.1 / 13.4 px (10th, 50th, 90th percentile), about 5 px wide at half their height.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float, Float32
from scipy.ndimage import gaussian_filter

FOCAL_REFERENCE_PX = 642.0
"""Focal length of the profile at which the dots were measured [px]."""
HALF_FIELD = (float(np.tan(np.radians(43.0))), float(np.tan(np.radians(28.5))))
"""Tangents of the half field angles, 86 x 57 deg (D435 projector, D400 datasheet)."""
DOT_DENSITY = 4.5e-3 * FOCAL_REFERENCE_PX**2
"""Dots per unit area of the plane at unit distance (measured: 4.5 per 1000 px)."""
MINIMUM_SPACING = 10.7 / FOCAL_REFERENCE_PX
"""Least distance of two dots; gives nearest neighbours of 10.8 / 11.8 / 13.8 px at the measured density."""
DOT_FWHM = np.sqrt(5.0**2 - 2.6**2) / FOCAL_REFERENCE_PX
"""Full width of a dot at half its height: 5 px in real images, less the 2.6 px by which lens, pixel and rectification
spread a point (`render.imager.lens`)."""
BACKGROUND_SHARE = 0.2
"""Share of the light outside the dots: zero order and scatter of the diffractive element (choice; real dots stand on a
visible veil, and the measured peak over background of 3.8 holds between it and a lit workshop)."""
BRIGHTNESS_SPREAD = 0.15
"""Standard deviation of the dots' relative power (choice; real dots differ visibly)."""
PATTERN_SEED = 435
"""The pattern is a property of the projector, not of the run."""
TEXEL = 1.9e-3
"""Texel of the sharp pattern: four to a dot's width."""
BLUR_LEVELS = 8
"""Blurred copies; copy l is blurred by sigma_0 2^(l - 1), copy 0 is sharp."""
FIELD_MARGIN = 0.5
"""Margin around the field in the blurred copies, as a share of the half field, so that blurred edges fade out."""
_SIGMA = float(DOT_FWHM / (2.0 * np.sqrt(2.0 * np.log(2.0))))


@dataclass(frozen=True, eq=False)
class DotPattern:
    """Relative brightness, mean 1 over the field, in coordinates (x / z, y / z) of the projector.

    Gaussian dots on a faint veil, placed at random with the density and spacing of real ones (head of the module): like
    the D435's pattern in its statistics and not dot by dot.
    """

    sharp: Float32[np.ndarray, "h w"]
    """Over the field itself, row 0 at the top (negative y); the light ends at its edge."""
    blurred: Float32[np.ndarray, "levels h_wide w_wide"]
    """Over the field and its margin, dark outside the field."""
    sigma: float
    """Standard deviation of one sharp dot; the unit in which blur levels count."""


def dot_positions(rng: np.random.Generator) -> Float[np.ndarray, "n 2"]:
    """Dot centres in the field at unit distance."""
    half = np.array(HALF_FIELD)
    wanted = round(DOT_DENSITY * 4 * half[0] * half[1])
    cell = MINIMUM_SPACING / np.sqrt(2.0)
    taken: dict[tuple[int, int], np.ndarray] = {}
    while len(taken) < wanted:
        for point in rng.uniform(-half, half, (4 * wanted, 2)):
            i, j = (int(c) for c in np.floor(point / cell))
            near = (taken.get((i + a, j + b)) for a in range(-2, 3) for b in range(-2, 3))
            if all(q is None or np.hypot(*(q - point)) >= MINIMUM_SPACING for q in near):
                taken[i, j] = point
                if len(taken) == wanted:
                    break
    return np.array(list(taken.values()))


@cache
def d435_pattern() -> DotPattern:
    """The pattern with the measured statistics; always the same one."""
    rng = np.random.default_rng(PATTERN_SEED)
    centres = dot_positions(rng)
    powers = np.clip(rng.normal(1.0, BRIGHTNESS_SPREAD, len(centres)), 0.3, None)
    width, height = (int(np.ceil(2 * half / TEXEL)) for half in HALF_FIELD)
    sharp = _drawn(centres, powers, width, height)
    # Half the resolution and a margin are enough for copies that are at least as blurred as a texel is wide.
    margin = [round(FIELD_MARGIN * n / 4) for n in (height, width)]
    coarse = sharp[: height // 2 * 2, : width // 2 * 2].reshape(height // 2, 2, width // 2, 2).mean(axis=(1, 3))
    padded = np.pad(coarse, [(m, m) for m in margin])
    sigma_px = _SIGMA / (2 * TEXEL)
    levels = [padded, *(gaussian_filter(padded, sigma_px * 2.0 ** (n - 1)) for n in range(1, BLUR_LEVELS))]
    return DotPattern(sharp.astype(np.float32), np.stack(levels).astype(np.float32), _SIGMA)


def _drawn(centres: Float[np.ndarray, "n 2"], powers: Float[np.ndarray, "n"], width: int, height: int) -> np.ndarray:
    """The sharp pattern (height, width), mean 1."""
    image = np.zeros((height, width))
    radius = int(np.ceil(4 * _SIGMA / TEXEL))
    scale = np.array([width, height]) / (2 * np.array(HALF_FIELD))
    for (x, y), power in zip((centres + HALF_FIELD) * scale - 0.5, powers, strict=True):
        columns = np.arange(max(round(x) - radius, 0), min(round(x) + radius + 1, width))
        rows = np.arange(max(round(y) - radius, 0), min(round(y) + radius + 1, height))
        across = np.exp(-0.5 * ((columns - x) / (_SIGMA * scale[0])) ** 2)
        down = np.exp(-0.5 * ((rows - y) / (_SIGMA * scale[1])) ** 2)
        image[np.ix_(rows, columns)] += power * np.outer(down, across)
    return BACKGROUND_SHARE + (1.0 - BACKGROUND_SHARE) * image / image.mean()
