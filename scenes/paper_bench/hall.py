"""The hall around the paper's bench: a closed shell with a gate, windows in it, machines, and rows of lights above.

The photographs show a plain light wall near the bench on one side, and on the other, out of focus, a grey floor, a dark
gate with two strips of bright windows, pillars and machines some metres away. What is out of focus is a choice.
"""

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from materials.catalog import material
from materials.lights import black_body, imager_radiance_per_luminance
from scenes.paper_bench.table import TABLE_TOP
from scenes.scene import Body, Lamp
from scenes.surroundings import TABLE_HEIGHT, box_on_floor, shell

HALL_SIZE = (10.0, 10.0, 5.0)
"""Length, depth and height of the hall [m] (choice: a small hall of a laboratory)."""
HALL_CENTRE = (0.0, 2.4)
"""x and y of its middle [m]: the near wall is 2.6 m before the object, 1.2 m before the table."""
FLOOR = TABLE_TOP - TABLE_HEIGHT
"""World z of the floor [m]."""
GATE_FRONT = HALL_CENTRE[1] + HALL_SIZE[1] / 2 - 0.10
"""y of the gate's face [m]: a gate of 6 cm, 4 cm before the wall (choice)."""
GATE_X = 1.0
"""x of the gate's middle [m]."""
WINDOW_SIZE = (3.4, 0.35)
"""Of the strip of windows in the gate [m] (the photograph has two beside each other, taken as one)."""
WINDOW_HEIGHT = 2.1
"""Of its middle above the floor [m]."""
OUTDOOR_ILLUMINANCE = 10_000.0
"""Under an overcast sky [lux] (choice: a common day; 5,000 in winter, 20,000 in summer)."""
WINDOW_TRANSMITTANCE = 0.7
"""Of double glazing to visible light [-] (choice within 0.6 to 0.8)."""
DAYLIGHT_TEMPERATURE = 6504.0
"""Correlated colour temperature of daylight [K] (CIE D65)."""

_FURNITURE = (
    # name, material, centre (x, y) [m], size (x, y, z) [m]; all on the floor
    ("gate", "dark_paint", (GATE_X, GATE_FRONT + 0.03), (4.2, 0.06, 3.8)),
    ("pillars", "matte_paint", (3.4, 6.9), (0.35, 0.35, 4.8)),
    ("machine", "white_paint", (4.0, 4.2), (1.8, 1.2, 1.9)),
    ("cabinet", "primer", (-4.6, 3.0), (0.5, 1.6, 1.9)),
    ("bench", "wood_table", (4.4, 0.6), (0.8, 2.2, 0.9)),
    ("rack", "dark_paint", (-4.5, -0.6), (0.6, 1.4, 2.0)),
)
"""Boxes of different albedo: the low-frequency structure of a real background (choice)."""


def hall() -> tuple[Body, ...]:
    """Floor, walls, ceiling, gate and machines, closed on all sides and looking inward. The robot itself is left out:
    it would stand differently at every pose, and the simulated arm has no joints."""
    materials = material("concrete"), material("matte_paint"), material("matte_paint")
    return (
        *shell(HALL_SIZE, HALL_CENTRE, FLOOR, materials),
        *(box_on_floor(*entry, FLOOR) for entry in _FURNITURE),
    )


def rows_of_lights() -> tuple[Lamp, ...]:
    """Two rows of LED luminaires of 8 x 0.12 m, 0.3 m under the ceiling, as halls have them, radiance 1 (choice)."""
    down, z = Rotation.from_euler("x", 180, degrees=True), FLOOR + HALL_SIZE[2] - 0.3
    return tuple(
        Lamp(f"row_{i}", RigidTransform.from_components([x, HALL_CENTRE[1], z], down), 0.12, 8.0, 1.0)
        for i, x in enumerate((-2.5, 2.5))
    )


def window() -> Lamp:
    """The strip of windows as an emitter, as bright as an overcast sky through them.

    A wall cannot be brighter than its light makes it, so windows shine. Luminance of CIE's standard overcast sky at
    elevation g (ISO 15469): L_zenith (1 + 2 sin g) / 3, with horizontal illuminance 7 pi / 9 L_zenith; g as the object
    sees the strip. It is as bright to the imager as daylight is (Planck's at D65's temperature; that coatings of glass
    dim the infrared is left out), while all surfaces reflect it as they reflect LEDs: a scene has one kind of light.
    """
    height = FLOOR + WINDOW_HEIGHT
    elevation = np.arctan2(height, GATE_FRONT)
    zenith = OUTDOOR_ILLUMINANCE * 9 / (7 * np.pi)
    luminance = WINDOW_TRANSMITTANCE * zenith * (1 + 2 * np.sin(elevation)) / 3
    radiance = luminance * imager_radiance_per_luminance(black_body(DAYLIGHT_TEMPERATURE))
    to_bench = Rotation.from_euler("x", 90, degrees=True)  # +z to -y
    pose = RigidTransform.from_components([GATE_X, GATE_FRONT - 0.005, height], to_bench)
    return Lamp("window", pose, *WINDOW_SIZE, float(radiance))
