"""The paper's plinth on its table of perforated panels between aluminium profiles, the plinth's top at z = 0.

Lengths are read off the authors' photographs (about +-15 %) unless they say otherwise.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform

from materials.catalog import material
from materials.input_error import InputError
from materials.material import Material
from materials.suggestion import suggest
from scenes.primitives import box, joined, moved
from scenes.scene import Body, Mesh

PLINTH_SIZE = (0.25, 0.25, 0.045)
"""Of the plinth [m]: about 250 mm wide, 40 to 50 mm thick."""
TABLE_TOP = -PLINTH_SIZE[2]
"""World z of the table under the plinth [m]."""
PLINTH_MATERIALS = {"black": "black_paint", "white": "white_paint"}
"""Materials of a plinth by colour. The paper's is black and matt. It is taken for a black of carbon, as matt black
paints and black rubber are. Many black dyes are bright at 850 nm (samples of aluminium with a black anodised layer
absorb 0.65 to 0.88 of sunlight: J. H. Henninger, NASA RP-1121, 1984), and the sensor would see a grey plinth; white is
the other choice."""
PROFILE_WIDTH = 0.045
"""Side of the table's aluminium profiles [m] (a common system's size)."""
GROOVE = (0.010, 0.015)
"""Width and depth of the groove in a profile's face [m] (choice: what profiles of 45 mm are sold with, 8 to 10 mm wide;
how it widens inside is not seen from above)."""
PANEL_SIZE = (0.70, 1.00, 0.005)
"""Of one panel [m] (thickness: choice)."""
NEAREST_PROFILES = (0.04, 0.20)
"""From the plinth's sides to the profiles on its left (-x) and before it (-y) [m]."""
HOLE_PITCH, HOLE_DIAMETER = 0.060, 0.007
"""Of the holes in the panels [m]."""
HOLE_CORNERS = 12
"""Of a hole's rim (choice: less than a tenth of a pixel off the circle at 0.35 m)."""
HOLE_LIFT = 1e-4
"""Of the dots that stand for holes above the panels [m] (choice: far below a depth step of 1 mm)."""


def plinth_material(colour: str) -> Material:
    """What a plinth of this colour is made of; InputError where there is none."""
    if colour not in PLINTH_MATERIALS:
        raise InputError(f"plinth {colour}: there is none; {suggest(colour, PLINTH_MATERIALS)}")
    return material(PLINTH_MATERIALS[colour])


def plinth(top: Material | None = None) -> Body:
    """The plinth, its upper face at z = 0, centred [m]; black by default."""
    mesh = moved(box(PLINTH_SIZE), RigidTransform.from_translation([0, 0, TABLE_TOP / 2]))
    return Body("plinth", mesh, top or plinth_material("black"), is_part=False)


def perforated_table() -> tuple[Body, ...]:
    """Panels, their holes, and the profiles between and around them; all faces that are seen from above, flush.

    The panels are taken for white matt paint, as white as the photographs show them; their sheen is left out. A hole is
    a dark dot: at 0.35 to 0.7 m one of 7 mm is 3 to 6 px wide in 640x360 images, so its contrast is seen, while the
    5 mm of the panel are 0.2 to 0.6 px of disparity, less than a matcher's window wider than the hole can tell.
    Profiles are etched matt and anodised without colour, taken for diffuse: as metal of alpha 0.3 they cost 40 % more
    time a burst, for what lies outside the mapped box. Their grooves are geometry, since 15 mm are 0.5 to 2 px of
    disparity.
    """
    columns, rows = _lines()
    return (
        Body("panels", joined(_panels(columns, rows)), material("white_paint"), is_part=False),
        Body("holes", _dots(_hole_centres(columns, rows)), material("black_paint"), is_part=False),
        Body("profiles", joined(_profiles(columns, rows)), material("anodised_aluminium"), is_part=False),
    )


def _lines() -> tuple[list[float], list[float]]:
    """x of the axes of the profiles along y, and y of those along x [m]: two panels each way, the plinth on the last
    column and row."""
    pitch = (PANEL_SIZE[0] + PROFILE_WIDTH, PANEL_SIZE[1] + PROFILE_WIDTH)
    nearest = [-(PLINTH_SIZE[k] / 2 + NEAREST_PROFILES[k] + PROFILE_WIDTH / 2) for k in range(2)]
    columns, rows = ([nearest[k] + step * pitch[k] for step in (-1, 0, 1)] for k in range(2))
    return columns, rows


def table_corner() -> tuple[float, float]:
    """x and y of the middle of the table's right (+x) far (+y) corner, where two profiles meet [m]."""
    columns, rows = _lines()
    return columns[-1], rows[-1]


def _panel_centres(columns: Sequence[float], rows: Sequence[float]) -> list[tuple[float, float]]:
    return [((a + b) / 2, (c + d) / 2) for a, b in pairwise(columns) for c, d in pairwise(rows)]


def _panels(columns: Sequence[float], rows: Sequence[float]) -> list[Mesh]:
    z = TABLE_TOP - PANEL_SIZE[2] / 2
    return [
        moved(box(PANEL_SIZE), RigidTransform.from_translation([x, y, z])) for x, y in _panel_centres(columns, rows)
    ]


def _profiles(columns: Sequence[float], rows: Sequence[float]) -> list[Mesh]:
    """Those along y from end to end, those along x between them."""
    whole = rows[-1] - rows[0] + PROFILE_WIDTH
    along_y = [_profile((x, (rows[0] + rows[-1]) / 2), whole, axis=1) for x in columns]
    middles = [(a + b) / 2 for a, b in pairwise(columns)]
    return [*along_y, *(_profile((x, y), PANEL_SIZE[0], axis=0) for x in middles for y in rows)]


def _profile(centre: tuple[float, float], length: float, axis: int) -> Mesh:
    """A profile with a groove in its upper face: a bar, and two rails on it."""
    width, depth = GROOVE
    rail = (PROFILE_WIDTH - width) / 2
    bars = [
        (0.0, PROFILE_WIDTH, -PROFILE_WIDTH, -depth),
        *((s * (width + rail) / 2, rail, -depth, 0.0) for s in (-1, 1)),
    ]
    meshes = []
    for across, side, low, high in bars:
        size, offset = [side, side, high - low], [0.0, 0.0, (low + high) / 2]
        size[axis], offset[1 - axis] = length, across
        place = np.array([*centre, TABLE_TOP]) + offset
        meshes.append(moved(box((size[0], size[1], size[2])), RigidTransform.from_translation(place)))
    return joined(meshes)


def _hole_centres(columns: Sequence[float], rows: Sequence[float]) -> Float[np.ndarray, "n 2"]:
    """A square grid in the middle of each panel, what the plinth covers left out [m]."""
    steps = [(np.arange(n) - (n - 1) / 2) * HOLE_PITCH for n in (int(side / HOLE_PITCH) for side in PANEL_SIZE[:2])]
    grid = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2)
    centres = np.concatenate([grid + centre for centre in _panel_centres(columns, rows)])
    return centres[np.abs(centres).max(axis=1) > (PLINTH_SIZE[0] + HOLE_DIAMETER) / 2]


def _dots(centres: Float[np.ndarray, "n 2"]) -> Mesh:
    """Flat discs just above the panels that look up."""
    angle = 2 * np.pi * np.arange(HOLE_CORNERS) / HOLE_CORNERS
    rim = HOLE_DIAMETER / 2 * np.column_stack([np.cos(angle), np.sin(angle)])
    xy = (centres[:, None] + rim).reshape(-1, 2)
    fan = np.array([[0, k, k + 1] for k in range(1, HOLE_CORNERS - 1)])
    faces = (HOLE_CORNERS * np.arange(len(centres))[:, None, None] + fan).reshape(-1, 3)
    z = np.full(len(xy), TABLE_TOP + HOLE_LIFT)
    return Mesh(np.column_stack([xy, z]), faces, xy, np.tile([0.0, 0.0, 1.0], (len(xy), 1)))
