"""The whole loop from Python: simulated camera and arm, FRA-NBV, and coverage against the CAD surface."""

import sys

from franbv.acquisition import Acquisition
from franbv.evaluation.quality import quality
from franbv.parameters import Parameters
from franbv.planners import fra
from franbv.reconstruction import reconstruct
from render.arm.arm import SimulatedArm
from render.d435i import SimulatedD435i
from render.world.visibility import seen_from_above
from scenes.build import part_scene
from studies.run.reference import reference_surface


def tell(view: Acquisition) -> None:
    """One line per acquisition, while the loop runs."""
    regions = f", {len(view.detection.boxes)} reflective regions" if view.detection else ""
    print(f"{view.index:2d} {view.kind:8} {len(view.points):5d} points{regions}", flush=True)


part, iterations = (sys.argv[1], int(sys.argv[2])) if len(sys.argv) > 2 else ("D", 3)
scene = part_scene(part)
camera = SimulatedD435i(scene, seed=0)
arm = SimulatedArm.around(scene.part_mesh())
run = reconstruct(camera, arm, fra(), Parameters(max_iterations=iterations), seed=0, observe=tell)

reference = reference_surface(scene, lambda points, normals: seen_from_above(camera.world, points, normals))
raw, mapped = quality(reference, run.cloud), quality(reference, run.cloud[run.is_mapped])
print(f"stopped: {run.stop.value}; {sum(a.motion_s for a in run.acquisitions):.0f} s of motion")
print(f"coverage at 5 mm {raw.coverage[0.005]:.1%}, of the map-filtered cloud {mapped.coverage[0.005]:.1%}")
print(f"F-score {raw.f_score:.2f}, accuracy {raw.accuracy_median * 1e3:.1f} mm (median)")
