"""What polarisers do to dots and lamps. `python -m docs.figures.polarisers` prints the tables of the sensor's page;
with `depth`, the rendered one as well: a ball of ground stainless steel on the table, behind films."""

import sys

import numpy as np

from franbv.frames import look_at
from materials.catalog import material
from materials.fresnel import conductor_reflectance_sp, degree_of_polarisation
from materials.lights import Band
from materials.optical_constants import METALS
from render.d435i import SimulatedD435i
from render.imager.polarisers import FILMS, Polarisers
from render.imager.settings import ImagerSettings
from render.sensor import SensorSettings
from scenes.build import coupon_scene

COAT_INDEX = 1.5
"""Of clear coats and binders of paints."""
ANGLES_DEG = (10.0, 45.0, 60.0, 75.0)
WAYS = {
    "none": None,
    "imagers at 0 deg": Polarisers(imagers_deg=0.0),
    "imagers at 90 deg": Polarisers(imagers_deg=90.0),
    "parallel": Polarisers(imagers_deg=0.0, projector_deg=0.0),
    "crossed": Polarisers(imagers_deg=90.0, projector_deg=0.0),
    "crossed, sheet film": Polarisers(imagers_deg=90.0, projector_deg=0.0, film="sheet"),
}
"""Of the rendered table."""


def main() -> None:
    """Print."""
    print_degrees()
    print_films()
    if "depth" in sys.argv[1:]:
        print_depth()


def print_degrees() -> None:
    """Degree of polarisation of mirrored unpolarised light at 850 nm."""
    print("| | " + " | ".join(f"{angle:g} deg" for angle in ANGLES_DEG) + " | R_s, R_p at 45 deg |")
    print("|---" * (len(ANGLES_DEG) + 2) + "|")
    rows = {name: (row.n, row.k) for name, row in METALS.items()} | {f"clear coat, n {COAT_INDEX:g}": (COAT_INDEX, 0.0)}
    for name, (n, k) in rows.items():
        degrees = 100 * degree_of_polarisation(np.radians(ANGLES_DEG), n, k)
        r_s, r_p = (r[0] for r in conductor_reflectance_sp(np.radians([45.0]), n, k))
        print(f"| {name} | " + " | ".join(f"{degree:.1f} %" for degree in degrees) + f" | {r_s:.3f}, {r_p:.3f} |")


def print_films() -> None:
    """Unpolarised light that films let pass, and how well they polarise it."""
    print("\n| film | " + " | ".join(band.value for band in Band) + " |\n|---|---|---|---|")
    for name, film in FILMS.items():
        cells = (f"{film.passed(band):.2f}, {100 * film.degree(band):.1f} %" for band in Band)
        print(f"| {name} | " + " | ".join(cells) + " |")


def print_depth() -> None:
    """The ball from 0.35 m: its light, exposure, and pixels without depth."""
    scene = coupon_scene("ball", material("stainless_austenitic:ground"))
    pose = look_at(np.array([0.25, -0.15, 0.25]), np.array([0.0, 0.0, 0.03]))
    print("\n| films | dots on ball | lamps on ball | dots on table | exposure, gain | ball without depth |")
    print("|---|---|---|---|---|---|")
    plain = None
    for name, polarisers in WAYS.items():
        camera = SimulatedD435i(scene, SensorSettings(crop=None, imager=ImagerSettings(polarisers=polarisers)))
        found = camera.measure(pose, 1)
        body = camera.truth(pose).body
        ball = body == 0
        table = camera.world.reflectances.is_lambertian[body] & (found.left_layers.projector > 0)
        light = np.array(
            [
                found.left_layers.projector[ball].mean(),
                found.left_layers.ambient[ball].mean(),
                found.left_layers.projector[table].mean(),
            ]
        )
        plain = light if plain is None else plain
        shares = " | ".join(f"{100 * share:.1f} %" for share in light / plain)
        holes = 100 * np.mean(found.z16[0][ball] == 0)
        imager = found.imager
        print(f"| {name} | {shares} | {imager.exposure_us / 1000:.1f} ms, {imager.gain:g} | {holes:.0f} % |")


if __name__ == "__main__":
    main()
