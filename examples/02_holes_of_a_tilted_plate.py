"""Which share of a steel plate has no depth, by roughness and tilt: one frame each, at the sensor's full resolution."""

from dataclasses import replace

import numpy as np

from franbv.frames import look_at
from materials.catalog import material
from materials.material import RoughConductor
from render.d435i import SensorSettings, SimulatedD435i
from scenes.build import coupon_scene
from scenes.coupons import plate_centre_height

ALPHAS = (0.03, 0.1, 0.4)
TILTS_DEG = (0, 40)
SETTINGS = SensorSettings(decimation=1, crop=None)

steel = material("stainless_austenitic:polished")
assert isinstance(steel, RoughConductor)
target = np.array([0.0, 0.0, plate_centre_height(0.1)])
camera_pose = look_at(target + np.array([0.0, -0.30, 0.30]), target)

print(f"{'alpha':>6}" + "".join(f"{f'tilt {tilt} deg':>14}" for tilt in TILTS_DEG))
for alpha in ALPHAS:
    shares = []
    for tilt in TILTS_DEG:
        finish = replace(steel, alpha_u=alpha, alpha_v=alpha)
        camera = SimulatedD435i(coupon_scene("plate", finish, tilt=np.radians(tilt)), SETTINGS)
        plate = camera.truth(camera_pose).body == 0
        depth = camera.measure(camera_pose, n_frames=1).depths[0]
        shares.append(np.mean(depth[plate] == 0))
    print(f"{alpha:6.2f}" + "".join(f"{share:14.1%}" for share in shares))
