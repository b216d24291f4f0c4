"""A furnished room of matte surfaces at 0.5 to 4 m, seen by a D415 from several places, as frames for statistics.

Real frames whose noise is published show such rooms: walls, a floor, furniture with edges, boxes and boards at many
tilts. Sizes, places and materials are choices; what counts is that every incidence up to grazing, edges of both sides
and depths from half a metre on occur. Nothing in it is tuned to a number that is measured on it.
"""

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from franbv.frames import look_at
from materials.catalog import material
from render.d435i import SensorSettings, SimulatedD435i
from render.light.pattern import PROJECTORS
from render.world.rig import Rig
from render.world.truth import Truth
from scenes.lamps import lighting
from scenes.primitives import box, moved
from scenes.scene import Body, Scene
from scenes.surroundings import room, table
from tests.physics.depth_statistics import Frame

D415 = SensorSettings(model="d415", profile="1280x720", crop=None, decimation=1)
"""The camera of the real frames: full resolution, projector on."""
DEPTHS = (0.5, 4.0)
"""That count [m] (of the published numbers)."""
LAMPS = {"dim": 200.0, "workshop": 500.0}
"""Light on the table [lx]: how bright the real rooms were is not known. 200 is the least of EN 12464-1 for rooms in
which people stay, 500 what the studies have."""

_BOXES = (
    # name, material, centre [m], size [m], turn about z and tilt about the box's own x [deg]; the table top is z = 0
    ("carton", "wood_table", (-0.25, 0.10, 0.15), (0.35, 0.25, 0.30), 25, 0),
    ("crate", "primer", (0.30, -0.05, 0.10), (0.25, 0.30, 0.20), -15, 0),
    ("small_box", "white_paint", (0.05, 0.20, 0.06), (0.15, 0.10, 0.12), 50, 0),
    ("tower", "matte_paint", (0.45, 0.25, 0.22), (0.10, 0.10, 0.44), 10, 0),
    ("board_leaning", "matte_paint", (-0.45, -0.15, 0.19), (0.40, 0.02, 0.45), 70, -25),
    ("ramp", "wood_table", (0.0, -0.25, 0.06), (0.30, 0.40, 0.01), 20, 15),
    ("slats", "dark_paint", (0.15, 0.32, 0.25), (0.03, 0.03, 0.50), 0, 0),
    ("chair_seat", "wood_table", (-0.95, -0.60, -0.40), (0.42, 0.42, 0.04), 30, 0),
    ("chair_back", "wood_table", (-1.13, -0.71, -0.10), (0.03, 0.42, 0.50), 30, 0),
    ("chair_leg_a", "wood_table", (-0.85, -0.42, -0.63), (0.04, 0.04, 0.44), 30, 0),
    ("chair_leg_b", "wood_table", (-0.75, -0.68, -0.63), (0.04, 0.04, 0.44), 30, 0),
    ("stool", "primer", (0.95, -0.75, -0.60), (0.35, 0.35, 0.50), 40, 0),
    ("screen", "matte_paint", (1.15, 0.55, 0.00), (0.90, 0.03, 1.70), 60, 0),
    ("screen_back", "white_paint", (-1.05, 0.95, 0.00), (0.80, 0.03, 1.70), -50, 0),
    ("plank", "wood_table", (0.75, 1.10, 0.10), (0.25, 0.03, 1.90), 10, -12),
    ("shelf_board_low", "wood_table", (-0.20, 1.62, 0.20), (1.00, 0.30, 0.03), 0, 0),
    ("shelf_board_high", "white_paint", (-0.20, 1.62, 0.60), (1.00, 0.30, 0.03), 0, 0),
    ("bin_on_shelf", "primer", (-0.40, 1.60, 0.31), (0.25, 0.20, 0.19), 12, 0),
    ("sloping_panel", "matte_paint", (1.35, -0.20, -0.35), (0.60, 0.02, 0.80), 95, 35),
)
_TABLE_LEGS = ((-0.55, -0.35), (-0.55, 0.35), (0.55, -0.35), (0.55, 0.35))

_VIEWS = (
    # eye and target [m]
    ((-0.10, -1.30, 0.45), (0.00, 0.10, 0.10)),
    ((-1.30, -0.55, 0.60), (0.20, 0.15, 0.00)),
    ((1.60, -1.40, 0.35), (0.00, 0.40, 0.00)),
    ((0.30, 1.15, 0.55), (-0.60, -0.80, -0.20)),
    ((0.20, -0.75, 0.40), (0.10, 0.25, 0.05)),
    ((1.65, -0.60, 0.50), (-0.60, 0.60, 0.00)),
    ((0.00, -1.45, 0.90), (0.10, 1.60, -0.30)),
    ((-1.50, -1.30, 0.50), (1.00, 0.20, -0.05)),
)


def furnished_room() -> Scene:
    """The room of the studies with a laid table and more furniture, under the lamps of a workshop."""
    legs = [
        (f"table_leg_{i}", "primer", (x, y, -0.44), (0.05, 0.05, 0.82), 0, 0) for i, (x, y) in enumerate(_TABLE_LEGS)
    ]
    bodies = (*(_body(*row) for row in (*_BOXES, *legs)), table(), *room())
    return Scene("furnished room", bodies, lighting("workshop").lamps, 0.0)


def room_views() -> tuple[RigidTransform, ...]:
    """Eight poses of the left imager, from 0.5 m before the table to the length of the room."""
    return tuple(look_at(np.array(eye), np.array(target)) for eye, target in _VIEWS)


def room_frames(lamps: tuple[str, ...] = tuple(LAMPS), settings: SensorSettings = D415) -> Iterator[dict[str, Frame]]:
    """Per view the frame under each of these lamps (`LAMPS`), rendered once."""
    camera = SimulatedD435i(furnished_room(), settings, seed=1)
    for pose in room_views():
        left, right = camera.render(pose)
        truth, frames = camera.truth(pose), {}
        for name in lamps:
            level = LAMPS[name] / LAMPS["workshop"]
            layers = (left.with_ambient_scaled(level), right.with_ambient_scaled(level))
            measured = camera.expose(pose, *layers, 1)
            frames[name] = measured_frame(measured.lefts[0], measured.depths[0], truth, camera.rig)
        yield frames


def measured_frame(left: np.ndarray, depth: np.ndarray, truth: Truth, rig: Rig) -> Frame:
    """Depth (h, w) [m] beside the truth, as disparities. What the projector's field does not reach is not counted: real
    surfaces have a texture where no dots fall, the catalogue's have none."""

    def disparity(z: np.ndarray) -> np.ndarray:
        return np.where(z > 0, rig.focal_baseline / np.maximum(z, 1e-3), 0.0).astype(float)

    k, half = rig.intrinsics, PROJECTORS[rig.model].half_field
    v, u = np.mgrid[: k.height, : k.width]
    across = (u - k.cx) / k.fx - rig.projector_offset / np.maximum(truth.depth, 1e-3)
    lit = (np.abs(across) < half[0]) & (np.abs((v - k.cy) / k.fy) < half[1])
    counted = lit & (truth.depth >= DEPTHS[0]) & (truth.depth <= DEPTHS[1])
    seen = truth.in_right_image, truth.visible_from_right
    return Frame(left, disparity(depth), disparity(truth.depth), truth.incidence, *seen, counted)


def _body(name: str, spec: str, centre: tuple, size: tuple, turn_deg: float, tilt_deg: float) -> Body:
    rotation = Rotation.from_euler("xz", [tilt_deg, turn_deg], degrees=True)
    pose = RigidTransform.from_components(np.array(centre, float), rotation)
    return Body(name, moved(box(size), pose), material(spec), is_part=False)
