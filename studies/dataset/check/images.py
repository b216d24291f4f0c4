"""What the images of a view must satisfy, whoever made them: ranges, label algebra, agreement of all true maps."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from franbv.frames import Intrinsics
from materials.catalog import material
from materials.user_materials import UserMaterials
from render.labels.causes import HOLES, Cause
from render.labels.outcome import INVALID_SHARE, LEAST_FALSE, SIGMAS, SUBPIXEL_RMS
from render.world.rig import Rig
from studies.dataset.draw.built_scene import material_class, roughness
from studies.dataset.format.layers import NOTHING_16, decoded_layer
from studies.dataset.format.statistics import FALSE_DEPTH
from studies.store.images import MM

LayerFault = tuple[str, str]
"""Layer, and what is wrong with it."""
DEPTH_TRUE_ROUNDING = 6e-5
"""True depth is stored to 0.05 mm, of a float32 [m]."""
ROUNDING = 0.6e-3
"""Depth is stored to half a millimetre and true depth to 0.05 mm [m]."""
ANGLE_ROUNDING_DEG = 0.06
"""Of stored incidence and of the normals it follows from [deg]."""
MOST_MEDIAN_ERROR = 0.02
"""Relative error of depth that is not called false, in the median: more means another unit or another view [-] (the
camera's own specification is 2 %)."""

Images = Mapping[str, np.ndarray]


def view_faults(
    images: Images, bodies: list[dict[str, Any]], user: UserMaterials, rig: Rig, n_frames: int
) -> Iterator[LayerFault]:
    """All faults of one view's images, which have the right sizes and types."""
    for suffix in ("", "_decimated"):
        yield from label_faults(images, suffix)
    yield from depth_faults(images, rig, n_frames)
    yield from truth_faults(images, bodies, user, rig.intrinsics)


def label_faults(images: Images, suffix: str) -> Iterator[LayerFault]:
    """A pixel has depth or exactly one cause, and only depth can be false."""
    depth, cause, wrong = (images[f"{name}{suffix}"] for name in ("depth", "cause", "false_depth"))
    if not np.isin(cause, [int(c) for c in (Cause.MEASURED, *HOLES)]).all():
        yield f"cause{suffix}", "holds a code that is no cause"
    if not np.isin(wrong, [0, *map(int, FALSE_DEPTH)]).all():
        yield f"false_depth{suffix}", "holds a code that is none of false depth"
    if np.any((cause > 0) != (depth == 0)):
        yield f"cause{suffix}", "a pixel has depth and a cause, or neither"
    if np.any((wrong > 0) & (depth == 0)):
        yield f"false_depth{suffix}", "a pixel without depth is called false"


def depth_faults(images: Images, rig: Rig, n_frames: int) -> Iterator[LayerFault]:
    """Depth within the range of the search; false where, and only where, it is off the truth; in the same unit."""
    depth, true = (decoded_layer(name, images[name]).astype(float) for name in ("depth", "depth_true"))
    measured, wrong = depth > 0, images["false_depth"] > 0
    if measured.any() and depth[measured].min() < rig.min_z - ROUNDING:
        yield "depth", f"is nearer than Min-Z, {MM * rig.min_z:.0f} mm"
    if measured.any() and depth[measured].max() > rig.max_z + ROUNDING:
        yield "depth", f"is beyond Max-Z, {MM * rig.max_z:.0f} mm"
    limit = false_limit(true, rig)
    error = np.abs(depth - true)
    if np.any(measured & wrong & (true > 0) & (error < limit - ROUNDING)):
        yield "false_depth", "calls depth false that is right"
    if np.any(measured & ~wrong & ((true == 0) | (error > limit + ROUNDING))):
        yield "false_depth", "calls depth right that is false"
    right = measured & ~wrong & (limit < MOST_MEDIAN_ERROR * true)  # farther away noise alone is more
    if right.any() and np.median(error[right] / true[right]) > MOST_MEDIAN_ERROR:
        yield "depth", "is in another unit than the true depth, or of another view"
    if n_frames > 1:
        missing = images["missing_frames"]
        if missing.max() > n_frames or np.any((missing >= INVALID_SHARE * n_frames) != ~measured):
            yield "missing_frames", "does not agree with depth"


def false_limit(true: Float[np.ndarray, "h w"], rig: Rig) -> Float[np.ndarray, "h w"]:
    """Error beyond which depth is false [m], as `render.labels.outcome.is_false_depth` has it. true: [m]."""
    return np.maximum(LEAST_FALSE, SIGMAS * SUBPIXEL_RMS * true**2 / rig.focal_baseline)


def truth_faults(
    images: Images, bodies: list[dict[str, Any]], user: UserMaterials, k: Intrinsics
) -> Iterator[LayerFault]:
    """All true maps say the same of every pixel."""
    body = images["body"]
    there = body > 0
    if body.max() > len(bodies):
        yield "body", "counts a body that the scene does not have"
        return
    for name, present in (
        ("depth_true", images["depth_true"] > 0),
        ("incidence", images["incidence"] != NOTHING_16),
        ("normal", np.any(images["normal"] != NOTHING_16, axis=-1)),
    ):
        if np.any(present != there):
            yield name, "says that something is there where the body map says nothing, or the other way round"
            return
    made_of = [material(entry["material"], user) for entry in bodies]
    classes = np.array([0, *(material_class(m, user) for m in made_of)])
    if np.any(images["material"] != classes[body]):
        yield "material", "is not that of the body"
    for place, name in enumerate(("roughness_u", "roughness_v")):
        alphas = [a[place] if (a := roughness(m)) else NOTHING_16 / 1e4 for m in made_of]
        if np.any(images[name] != np.rint(np.array([NOTHING_16 / 1e4, *alphas]) * 1e4)[body]):
            yield name, "is not that of the body"
    yield from normal_faults(images, there, k)


def normal_faults(images: Images, there: Bool[np.ndarray, "h w"], k: Intrinsics) -> Iterator[LayerFault]:
    """Normals are of unit length and make the stored angle with the view ray."""
    normal: Float[np.ndarray, "n 3"] = decoded_layer("normal", images["normal"])[there].astype(float)
    if not len(normal):
        return
    if np.any(np.abs(np.linalg.norm(normal, axis=1) - 1) > 1e-3):
        yield "normal", "is not of unit length"
        return
    rays = k.pixel_directions()[there]
    cosine = -np.einsum("ij,ij->i", normal, rays) / np.linalg.norm(rays, axis=1) / np.linalg.norm(normal, axis=1)
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    stored = images["incidence"][there] / 100
    # Near 0 deg the angle follows only from the square root of what the cosine's last digits hold.
    if np.any(np.abs(angle - stored) > np.where(stored < 2, 0.5, ANGLE_ROUNDING_DEG)):
        yield "incidence", "is not the angle between normal and view ray"
