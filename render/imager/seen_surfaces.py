"""What an imager's pixels see, as far as its image depends on more than the radiance that arrives."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32


@dataclass(frozen=True, eq=False)
class SeenSurfaces:
    """The surface behind each pixel of one imager: how far it is, and how much of the dots' light it leaves unspeckled.

    A pixel has one surface: what else it sees beside an edge, or mirrored, is left out.
    """

    inverse_depth: Float32[np.ndarray, "h w"]
    """One over the Z-depth in the imager's frame [1/m]; 0 where there is nothing."""
    specular_share: Float32[np.ndarray, "h w"]
    """Share of the projector's light that a surface smooth to the wavelength sends there coherently [0, 1]; 0 on rough
    ones (`render.imager.surface_speckle`)."""
