"""A CAD file of your own in front of the sensor: what a brass ring measures, and how far it is from the truth."""

import tempfile
from pathlib import Path

import numpy as np
import trimesh

from franbv.frames import look_at
from render.d435i import SensorSettings, SimulatedD435i
from scenes.build import scene_on_table
from scenes.part_materials import part_materials
from scenes.user_mesh import load_user_part

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "ring.stl"
    trimesh.creation.torus(major_radius=40, minor_radius=12).export(file)  # in millimetres
    ring = load_user_part(file, units="mm", materials=part_materials(["brass:bright"]))

scene = scene_on_table(ring.name, ring.bodies)
camera = SimulatedD435i(scene, SensorSettings(decimation=1, crop=None), seed=1)
pose = look_at(np.array([0.0, -0.25, 0.25]), np.array([0.0, 0.0, 0.01]))
depth = camera.measure(pose, n_frames=1).depths[0]
truth = camera.truth(pose)

on_ring = truth.body == 0
measured = on_ring & (depth > 0)
error_mm = 1e3 * (depth - truth.depth)[measured]
print(f"{on_ring.sum()} pixels look at the ring, {np.mean(measured[on_ring]):.1%} of them have depth")
print(f"depth error: median {np.median(error_mm):+.1f} mm, 90 % within {np.quantile(abs(error_mm), 0.9):.1f} mm")
for low in range(0, 90, 30):
    angle = np.degrees(truth.incidence)
    band = on_ring & (angle >= low) & (angle < low + 30)
    print(f"incidence {low:2d}-{low + 30} deg: {np.mean(depth[band] == 0):6.1%} holes of {band.sum()} pixels")
