"""What the light is told of the surfaces."""

from materials.catalog import material
from render.world.mitsuba_scene import load_scene
from render.world.reflectances import NEEDLE, SHARP
from scenes.build import scene_on_table
from scenes.primitives import rectangle
from scenes.scene import Body


def test_lobes_are_told_by_their_peak():
    """1 / (4 pi alpha^2) of alpha 0.04, 0.07 and 0.2: 50, 16 and 2 per steradian; a matte surface has no lobe."""
    finishes = ("iron:bright@alpha=0.04", "iron:bright@alpha=0.07", "iron:bright@alpha=0.2", "matte_paint")
    bodies = tuple(Body(name, rectangle(0.1, 0.1), material(name), is_part=True) for name in finishes)
    sharp = load_scene(scene_on_table("lobes", bodies, room=False)).reflectances.sharp.numpy()
    assert sharp[: len(bodies)].tolist() == [NEEDLE, SHARP, 0, 0]
