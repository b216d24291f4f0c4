"""How much of the projector's light metals send back, and where: reflectance and lobe width, without rendering."""

import math

from materials.catalog import material, metal_names
from materials.fresnel import normal_reflectance
from materials.material import RoughConductor

print(f"{'metal':22}{'n':>7}{'k':>7}{'R0':>7}   half of all facets tilt less than")
for name in metal_names():
    polished, blasted = material(f"{name}:polished"), material(f"{name}:blasted")
    assert isinstance(polished, RoughConductor)
    assert isinstance(blasted, RoughConductor)
    reflectance = normal_reflectance(polished.n, polished.k)
    # The median slope of GGX facets is alpha itself.
    tilts = [math.degrees(math.atan(finish.alpha_u)) for finish in (polished, blasted)]
    print(
        f"{name:22}{polished.n:7.3f}{polished.k:7.3f}{reflectance:7.3f}"
        f"   {tilts[0]:.1f} deg polished, {tilts[1]:.0f} deg blasted"
    )
