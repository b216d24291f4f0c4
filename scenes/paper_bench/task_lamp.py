"""The paper's task lamp: a strip of LEDs behind a diffuse front, in a flat head on an arm.

Read off the authors' photograph: a luminous strip of about 400 x 50 mm, 0.5 m beside the object and 0.4 m above the
plinth, aimed at it, opposite the robot, the strip's ends one above the other.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import RigidTransform, Rotation

from materials.catalog import material
from materials.lights import imager_radiance_per_luminance, white_led
from scenes.lamps import aimed
from scenes.paper_bench.table import TABLE_TOP, table_corner
from scenes.primitives import box, cylinder, joined, moved
from scenes.scene import Body, Lamp, Mesh

LUMINOUS_FLUX = 1200.0
"""Of the lamp [lm] (choice: 12 W at 100 lm/W; task lamps with LED strips of this length are sold with 10 to 20 W, LED
luminaires with 80 to 130 lm/W)."""
STRIP_SIZE = (0.40, 0.05)
"""Of the luminous front [m]."""
POSITION = (0.50, 0.05, 0.40)
"""Of the front's middle, world [m]."""
AIM = (0.0, 0.0, 0.10)
"""What it shines at, world [m] (choice: the middle of objects of 16 to 25 cm)."""
ROLL_DEG = -45.0
"""Turn of the strip about the way it shines, 0 = level [deg]."""
HEAD_SIZE = (0.46, 0.11, 0.025)
"""Of the housing [m]: a rim of 3 cm around the strip."""
FRONT_LIFT = 5e-4
"""Of the luminous front before the housing [m] (choice: so that it is seen, and its dark back is not)."""
ROD_RADIUS = 0.0125
"""Of the arm's two rods [m] (choice within what the photograph shows, 20 to 30 mm thick)."""
ELBOW_HEIGHT = 0.50
"""Of the arm's elbow above the table [m]."""
ROD_FACETS = 24
"""Around a rod (choice: 0.1 mm off the circle)."""


def task_lamp() -> Lamp:
    """The luminous front: equally bright all over and in all directions before it, so L = flux / (pi area)."""
    luminance = LUMINOUS_FLUX / (np.pi * STRIP_SIZE[0] * STRIP_SIZE[1])
    return Lamp("task lamp", _pose(), *STRIP_SIZE, luminance * imager_radiance_per_luminance(white_led()))


def lamp_on_arm() -> Body:
    """Housing and arm, on the table's far right corner; there whether the lamp is on or not, and in the robot's way."""
    behind = _pose() * RigidTransform.from_translation([0, 0, -FRONT_LIFT - HEAD_SIZE[2] / 2])
    x, y = table_corner()
    foot, elbow = np.array([x, y, TABLE_TOP]), np.array([x, y, TABLE_TOP + ELBOW_HEIGHT])
    joint = behind.apply([0.0, 0.0, -HEAD_SIZE[2] / 2])
    mesh = joined([moved(box(HEAD_SIZE), behind), _rod(foot, elbow), _rod(elbow, joint)])
    return Body("task lamp", mesh, material("white_paint"), is_part=False, is_fixture=True)


def _pose() -> RigidTransform:
    turn = RigidTransform.from_rotation(Rotation.from_euler("z", ROLL_DEG, degrees=True))
    return aimed(np.array(POSITION), np.array(AIM)) * turn


def _rod(start: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"]) -> Mesh:
    way = end - start
    length = float(np.linalg.norm(way))
    turn = Rotation.align_vectors([way / length], [[0.0, 0.0, 1.0]])[0]
    return moved(cylinder(ROD_RADIUS, length, ROD_FACETS), RigidTransform.from_components((start + end) / 2, turn))
