"""Scenes made so that one known thing, and nothing else, costs depth on a known set of pixels.

The camera stands at the origin and looks along +x; the world's +y is to its left. Profile 424x240: f = 213 px.
"""

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from jaxtyping import Bool
from scipy.spatial.transform import RigidTransform

from franbv.frames import look_at
from materials.catalog import material
from materials.material import Material, Matte
from render.d435i import Measurement, SensorSettings, SimulatedD435i
from render.imager.settings import ImagerSettings
from render.labels.labels import Labels, label_frame
from scenes.scene import Body, Lamp, Mesh, Scene
from tests.physics.simple_scenes import facing_x, lamp_at, rectangle

F, CX, CY, W, H = 213.0, 211.5, 119.5, 424, 240
GREY = Matte("grey", 0.5)
WHOLE = SensorSettings(profile="424x240", crop=None)
FIXED = SensorSettings(profile="424x240", crop=None, auto_exposure=False)
"""8.5 ms at gain 16, librealsense's default."""


@dataclass(frozen=True, eq=False)
class Case:
    """A labelled frame and the pixels whose fate is known beforehand."""

    measurement: Measurement
    labels: Labels
    meant: Bool[np.ndarray, "h w"]

    @property
    def invalid(self) -> Bool[np.ndarray, "h w"]:
        """Pixels without depth in the (only) frame."""
        return self.measurement.z16[0] == 0


def labelled(scene: Scene, meant: Bool[np.ndarray, "h w"], settings: SensorSettings = WHOLE) -> Case:
    """Measure one frame and label it."""
    camera = SimulatedD435i(scene, settings)
    measurement = camera.measure(facing_x(), 1)
    return Case(measurement, label_frame(camera, facing_x(), measurement), meant)


def columns(first: float, last: float, rows: tuple[int, int] = (40, 200)) -> Bool[np.ndarray, "h w"]:
    """Pixels whose centres lie between two columns, in the middle rows unless told otherwise."""
    mask = np.zeros((H, W), bool)
    mask[rows[0] : rows[1], int(np.ceil(first)) : int(np.floor(last)) + 1] = True
    return mask


def facing_plate(distance: float, y: float, width: float, height: float, what: Material, name="plate") -> Body:
    """A rectangle that faces the camera."""
    mesh = rectangle([distance, y, 0], [0, y, 0], width, height)
    return Body(name, mesh, what, True)


def scene_of(*bodies: Body, lamps: tuple[Lamp, ...] = (), ambient: float = 0.0) -> Scene:
    """Bodies before the camera."""
    return Scene("hand-made", bodies, lamps, ambient)


def behind_camera(radiance: float = 20.0) -> Lamp:
    """A lamp behind and above the camera."""
    return lamp_at([-1.0, 0.0, 1.0], [0.5, 0, 0], 0.4, radiance)


def looking_at_the_table(elevation_deg: float, distance: float = 0.35) -> RigidTransform:
    """A camera that looks at the middle of a part on the table, 4 cm above it."""
    turn, middle = np.radians(elevation_deg), np.array([0.0, 0.0, 0.04])
    return look_at(middle + distance * np.array([np.cos(turn), 0.0, np.sin(turn)]), middle)


def wall_at(distance: float, what: Material = GREY) -> Body:
    """A wall that fills the image."""
    return facing_plate(distance, 0.0, 6 * distance, 6 * distance, what, "wall")


@cache
def too_near() -> Case:
    """A wall at 70 mm, where Min-Z = f B / 126 = 84.5 mm."""
    return labelled(scene_of(wall_at(0.07), lamps=(behind_camera(),)), np.ones((H, W), bool))


@cache
def nothing_there() -> Case:
    """A plate of 0.2 m at 0.4 m and nothing beside it: 213 * 0.1 / 0.4 = 53 px to either side."""
    meant = np.ones((H, W), bool)
    meant[:, 110:310] = False
    return labelled(scene_of(facing_plate(0.4, 0.0, 0.2, 4.0, GREY)), meant)


@cache
def left_band() -> Case:
    """A wall at 0.3 m: the leftmost f B / Z = 35.5 columns fall outside the right image."""
    return labelled(scene_of(wall_at(0.3), lamps=(behind_camera(),)), columns(0, 34.9, (0, H)))


@cache
def half_hidden() -> Case:
    """A plate at 0.3 m before a wall at 0.6 m hides f B (1 / 0.3 - 1 / 0.6) = 17.75 columns left of its own edge."""
    plate = facing_plate(0.3, 0.0, 0.1, 2.0, GREY)
    edge = CX - F * 0.05 / 0.3
    meant = columns(edge - 17.25, edge - 0.5)
    return labelled(scene_of(plate, wall_at(0.6), lamps=(behind_camera(),)), meant)


@cache
def before_the_projector() -> Case:
    """A post right before the projector, 29 mm to the right of the left imager: both imagers look past it.

    The post, 16 mm wide at Z = 50 mm, lies 123 px right of the middle for the left imager and 89 px left of it for the
    right one, where it hides the wall at 0.6 m in what the left one sees 72 px left of the middle. Its shadow on the
    wall lies f 0.029 / 0.6 = 10.3 px right of the middle. All three are 68 px wide, so 14 px of the wall, more than the
    matcher's support, lie between the shadow and what is hidden.
    """
    post = facing_plate(0.05, -0.029, 0.016, 0.4, GREY, "post")
    middle, half = CX + F * 0.029 / 0.6, F * 0.008 / 0.05
    scene = scene_of(post, wall_at(0.6), lamps=(behind_camera(5.0),))
    return labelled(scene, columns(middle - half + 1, middle + half - 1), FIXED)


@cache
def over_exposed() -> Case:
    """A wall at 0.4 m under a bright lamp, exposed for 33 ms, about ten times as long as the camera chooses: white
    all over. Right of the left band, 213 * 0.05 / 0.4 = 26.6 columns, nothing else is wrong with it."""
    settings = FIXED.model_copy(update={"imager": ImagerSettings(exposure_us=33_000.0)})
    return labelled(scene_of(wall_at(0.4), lamps=(behind_camera(40.0),)), columns(45, W), settings)


def tilted_plate(what: Material, incidence_deg: float, side: float = 0.16, distance: float = 0.35) -> Body:
    """A plate across the optical axis whose normal is turned upwards from the camera by the angle."""
    turn = np.radians(incidence_deg)
    mesh = rectangle([distance, 0, 0], [distance - np.cos(turn), 0, np.sin(turn)], side, side)
    return Body("plate", mesh, what, True)


def inner(plate: Body, margin: float = 0.25) -> Bool[np.ndarray, "h w"]:
    """Pixels inside the plate's image, `margin` of its size away from its rims."""
    corners = plate.mesh.vertices
    centre = corners.mean(axis=0)
    shrunk = centre + (1 - 2 * margin) * (corners - centre)
    u, v = CX - F * shrunk[:, 1] / shrunk[:, 0], CY - F * shrunk[:, 2] / shrunk[:, 0]
    mask = np.zeros((H, W), np.uint8)
    cv2.fillConvexPoly(mask, np.rint(np.stack([u, v], axis=1)).astype(np.int32), 1)
    return mask > 0


@cache
def without_dots() -> Case:
    """A bare wall in lamp light with the projector off."""
    imager = ImagerSettings(laser_power_mw=0.0)
    settings = WHOLE.model_copy(update={"imager": imager})
    return labelled(scene_of(wall_at(0.5), lamps=(behind_camera(),)), columns(60, 400), settings)


@cache
def in_darkness() -> Case:
    """A bare wall with lamps and projector off: the camera exposes as long as it can and sees nothing."""
    settings = WHOLE.model_copy(update={"imager": ImagerSettings(laser_power_mw=0.0)})
    return labelled(scene_of(wall_at(0.4)), columns(60, 400), settings)


@cache
def steep_plate() -> Case:
    """A matte plate at 82 deg: its disparity changes by B / Z tan(82 deg) = 1.0 px from row to row, 4 px over half of a
    census window."""
    plate = tilted_plate(GREY, 82.0, side=0.4)
    return labelled(scene_of(plate, wall_at(0.8), lamps=(behind_camera(),)), inner(plate))


@cache
def dark_mirror() -> Case:
    """A mirror at 35 deg before a wall in a dark room: it sends the projector's light up, and nothing comes back
    from there."""
    plate = tilted_plate(material("stainless_austenitic:mirror"), 35.0)
    return labelled(scene_of(plate, wall_at(0.6)), inner(plate), FIXED)


@cache
def mirrored_lamp() -> Case:
    """A plate at 35 deg that mirrors a lamp 70 deg above the axis, wide enough for all of it. The metal shows most of
    the lamp's radiance, a matte surface at this distance a tenth of it."""
    plate = tilted_plate(material("stainless_austenitic:bright"), 35.0)
    out = np.array([0.35 - np.cos(np.radians(70)), 0, np.sin(np.radians(70))])
    lamp = lamp_at(out, [0.35, 0, 0], 1.0, 1.5)
    return labelled(scene_of(plate, wall_at(0.6), lamps=(lamp,)), inner(plate))


LEAN = np.radians(15.0)
"""How far the twisted mirror leans back, so that it does not show the projector to the imagers."""


def twisted(what: Material, distance: float = 0.35, side: float = 0.16, twist: float = 1.0) -> Body:
    """A plate that leans back by LEAN, twisted by `twist` y z: its normal leans more or less in proportion to y, by one
    radian a metre."""
    at = np.linspace(-side / 2, side / 2, 81)
    y, z = np.meshgrid(at, at)
    index = np.arange(at.size**2).reshape(at.size, at.size)
    a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, 1:].ravel(), index[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)])
    x = distance + np.tan(LEAN) * z + twist * y * z
    normals = np.stack([-np.ones_like(y), twist * z, np.tan(LEAN) + twist * y], axis=-1).reshape(-1, 3)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    return Body("twisted", Mesh(np.stack([x, y, z], axis=-1).reshape(-1, 3), faces, normals=normals), what, True)


@cache
def twisted_mirror() -> Case:
    """A twisted mirror that shows the two imagers a board of small lamps above them.

    The imagers' half-vectors lie 25 mm apart on the mirror, where its normal leans 25 mrad more or less: the right
    image of the lamps is 50 mrad, about 8 px, higher or lower than the left one.
    """
    plate = twisted(material("silver:mirror"))
    centre = np.array([0.35 - np.cos(2 * LEAN), 0, np.sin(2 * LEAN)])
    across, up = np.array([0.0, 1, 0]), np.array([np.sin(2 * LEAN), 0, np.cos(2 * LEAN)])
    rng = np.random.default_rng(0)
    places = np.stack(np.meshgrid(np.arange(-0.4, 0.41, 0.1), np.arange(-0.3, 0.31, 0.1)), axis=-1).reshape(-1, 2)
    places = places + rng.uniform(-0.025, 0.025, places.shape)
    lamps = tuple(lamp_at(centre + y * across + z * up, [0.35, 0, 0], 0.04, 0.15) for y, z in places)
    flat = Body("", rectangle([0.35, 0, 0], [0, 0, 0], 0.16, 0.16), GREY, True)
    return labelled(scene_of(plate, wall_at(0.6), lamps=lamps), inner(flat), FIXED)


@cache
def lit_by_a_screen() -> Case:
    """Rough metal that mirrors a white screen, under a lamp that lights the screen and turns its back on the metal.

    The metal shows the projector's dots and, much brighter, the screen. Paths of one surface leave only the dots.
    """
    plate = tilted_plate(material("aluminium:coarse_blasted"), 30.0)
    screen = Body("screen", rectangle([0.1, 0, 0.433], [0.35, 0, 0], 0.6, 0.5), Matte("white", 0.9), False)
    lamp = lamp_at([0.6, 0, 0.3], [0.2, 0, 1.217], 0.1, 250.0)
    return labelled(scene_of(plate, screen, lamps=(lamp,)), inner(plate), FIXED)
