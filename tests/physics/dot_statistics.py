"""Statistics of projected dots in an infrared image: density, spacing, width, height over background.

Dots are local maxima of the band-passed image; each is fitted with a round Gaussian on a level background.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, UInt8
from scipy.ndimage import gaussian_filter, maximum_filter
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

REFERENCE_FOCAL_PX = 642.0
"""Focal length of the 1280x720 stream; lengths are given in pixels of this stream, so that profiles compare."""
EXPECTED_WIDTH = 4.5
"""Full width at half maximum that the band-pass is made for; real and rendered dots have 3.7 to 5."""
SEPARATION = 4.0
"""Two maxima nearer than this are one dot; the nearest dots are 10 px apart."""
FIT_RADIUS = 5.0
"""Pixels fitted around a dot: half way to the nearest neighbour."""
CLEAR_OF_DOTS = 6.0
"""Distance from every dot at which a pixel counts as background."""
LEAST_SHARE = 0.3
"""Least height of a maximum, in units of the 90th percentile. Noise reaches 0.05, the faintest real dots 0.45."""
WHITE = 255
_FWHM_PER_SIGMA = 2 * np.sqrt(2 * np.log(2))


@dataclass(frozen=True)
class DotStatistics:
    """Lengths in pixels of the 1280x720 stream; triples are the 10th, 50th and 90th percentile."""

    count: int
    density: float
    """Dots per 1000 px."""
    spacing: tuple[float, float, float]
    """Distance to the nearest neighbour [px], dots near the region's border left out."""
    width: tuple[float, float, float]
    """Full width at half maximum of the fitted Gaussian [px]."""
    background: float
    """Grey value between the dots [DN]."""
    peak_over_background: float
    """Median ratio of a dot's highest grey value to the background, the pedestal taken off both."""
    raw_peak_over_background: float
    """The same with the pedestal left in."""
    spread: float
    """Standard deviation of the dots' heights over their mean."""
    clipped: float
    """Share of the dots that hold a white pixel."""
    white: float
    """Share of white pixels in the region."""


def dot_statistics(
    image: UInt8[np.ndarray, "h w"], region: Bool[np.ndarray, "h w"], focal_px: float, pedestal: float = 17.0
) -> DotStatistics:
    """Measure the dots inside `region`, a smooth surface; focal_px: of the image's stream; pedestal [DN]."""
    scale = focal_px / REFERENCE_FOCAL_PX
    dots = find_dots(image, region, scale)
    fits = np.array([_fit(image, dot, scale) for dot in dots])  # (n, 4): x, y, height, sigma
    background = _background(image, region, dots, scale)
    rows, columns = dots[:, 1], dots[:, 0]
    under = background[rows, columns]
    peaks = np.minimum(under + fits[:, 2], WHITE)
    nearest = cKDTree(fits[:, :2]).query(fits[:, :2], 2)[0][:, 1] / scale
    border = cv2.distanceTransform(np.pad(region, 1).astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    inside = border[rows, columns] > nearest * scale
    return DotStatistics(
        len(dots),
        1000 * len(dots) / float(np.count_nonzero(region)) * scale**2,
        _percentiles(nearest[inside]),
        _percentiles(fits[:, 3] * _FWHM_PER_SIGMA / scale),
        float(np.median(under)),
        float(np.median((peaks - pedestal) / (under - pedestal))),
        float(np.median(peaks / under)),
        float(np.std(fits[:, 2]) / np.mean(fits[:, 2])),
        float(np.mean([_patch(image, dot, scale)[0].max() == WHITE for dot in dots])),
        float(np.mean(image[region] == WHITE)),
    )


def find_dots(image: UInt8[np.ndarray, "h w"], region: Bool[np.ndarray, "h w"], scale: float) -> np.ndarray:
    """Columns and rows (n, 2) of the dots in `region`, whole pixels; scale: pixels per pixel of 1280x720."""
    sigma = EXPECTED_WIDTH * scale / _FWHM_PER_SIGMA
    grey = image.astype(float)
    band = gaussian_filter(grey, 0.5 * sigma) - gaussian_filter(grey, 1.8 * sigma)
    apart = 2 * round(SEPARATION * scale) + 1
    reach = int(np.ceil(FIT_RADIUS * scale))
    allowed = np.zeros_like(region)
    allowed[reach:-reach, reach:-reach] = region[reach:-reach, reach:-reach]
    rows, columns = np.nonzero((band == maximum_filter(band, apart)) & allowed)
    height = band[rows, columns]
    kept = height > LEAST_SHARE * np.percentile(height, 90)
    return np.column_stack([columns, rows])[kept]


def _patch(image: np.ndarray, dot: np.ndarray, scale: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Grey values around a dot and their offsets from it in x and y, flat."""
    reach = int(np.ceil(FIT_RADIUS * scale))
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    near = x**2 + y**2 <= (FIT_RADIUS * scale) ** 2
    rows, columns = slice(dot[1] - reach, dot[1] + reach + 1), slice(dot[0] - reach, dot[0] + reach + 1)
    return image[rows, columns][near].astype(float), x[near], y[near]


def _fit(image: np.ndarray, dot: np.ndarray, scale: float) -> Float[np.ndarray, "4"]:
    """Place, height and standard deviation of the Gaussian; white pixels do not count, their value is not known."""
    grey, x, y = _patch(image, dot, scale)
    known = grey < WHITE
    grey, x, y = grey[known], x[known], y[known]

    def residual(q: np.ndarray) -> np.ndarray:
        return q[0] + q[1] * np.exp(-((x - q[2]) ** 2 + (y - q[3]) ** 2) / (2 * q[4] ** 2)) - grey

    start = [grey.min(), np.ptp(grey), 0.0, 0.0, EXPECTED_WIDTH * scale / _FWHM_PER_SIGMA]
    _, height, dx, dy, sigma = least_squares(residual, start).x
    return np.array([dot[0] + dx, dot[1] + dy, height, abs(sigma)])


def _background(image: np.ndarray, region: np.ndarray, dots: np.ndarray, scale: float) -> Float[np.ndarray, "h w"]:
    """Grey value between the dots, averaged over about three spacings [DN]."""
    dark = np.ones(image.shape, np.uint8)
    dark[dots[:, 1], dots[:, 0]] = 0
    between = region & (cv2.distanceTransform(dark, cv2.DIST_L2, 5) > CLEAR_OF_DOTS * scale)
    weight = gaussian_filter(between.astype(float), 15 * scale)
    return gaussian_filter(np.where(between, image, 0).astype(float), 15 * scale) / np.maximum(weight, 1e-9)


def _percentiles(values: np.ndarray) -> tuple[float, float, float]:
    low, middle, high = np.percentile(values, [10, 50, 90])
    return float(low), float(middle), float(high)
