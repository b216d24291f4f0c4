"""Where plane and convex mirrors show things, by the mirror equation and by exact rays: what a stereo pair that sees
only mirrored things must measure."""

import numpy as np
from jaxtyping import Float

FIXED_POINTS = 60
"""Steps of the search for a reflection point. Each shrinks the error by about R / (2 d cos), d to the nearer end."""


def virtual_image_depth(object_distance: float, radius: float) -> float:
    """Distance of the virtual image behind the pole of a convex mirror [m], near the axis.

    Mirror equation 1/s + 1/s' = -2/R with s' < 0 behind the mirror: |s'| = s R / (2 s + R), R/2 for things far away.
    """
    return object_distance * radius / (2 * object_distance + radius)


def reflection_point(
    eye: Float[np.ndarray, "3"], things: Float[np.ndarray, "n 3"], centre: Float[np.ndarray, "3"], radius: float
) -> Float[np.ndarray, "n 3"]:
    """Where on a sphere an eye sees each thing mirrored (Alhazen's problem), by fixed points of the law of reflection:
    the normal halves the angle between the directions to eye and thing."""
    normal = _unit(_unit(eye - centre) + _unit(things - centre))
    for _ in range(FIXED_POINTS):
        point = centre + radius * normal
        normal = _unit(_unit(eye - point) + _unit(things - point))
    return centre + radius * normal


def sphere_hit(
    rays: Float[np.ndarray, "n 3"], centre: Float[np.ndarray, "3"], radius: float
) -> Float[np.ndarray, "n 3"]:
    """Where unit rays from the origin meet the sphere's near side; NaN where they miss."""
    along = rays @ centre
    inside = along**2 - centre @ centre + radius**2
    with np.errstate(invalid="ignore"):
        return (along - np.sqrt(inside))[:, None] * rays


def mirrored_stereo_depth(
    rays: Float[np.ndarray, "n 3"],
    centre: Float[np.ndarray, "3"],
    radius: float,
    object_distance: float,
    baseline: float,
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Z-depth of the sphere itself, and the Z-depth that a stereo pair triangulates from things mirrored in it [m].

    rays: unit rays of the left eye, which is the origin; the right one stands at +x by `baseline`. Each thing lies
    `object_distance` from the sphere along the left eye's reflected ray. Rows of both images are taken as the same,
    as a matcher does.
    """
    surface = sphere_hit(rays, centre, radius)
    normal = (surface - centre) / radius
    mirrored = rays - 2 * np.sum(rays * normal, axis=1, keepdims=True) * normal
    right_eye = np.array([baseline, 0.0, 0.0])
    in_right = reflection_point(right_eye, surface + object_distance * mirrored, centre, radius) - right_eye
    disparity = rays[:, 0] / rays[:, 2] - in_right[:, 0] / in_right[:, 2]
    return surface[:, 2], baseline / disparity


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
