"""A scene of ours as Blender's Cycles sees it, in a process of its own: it shares neither code nor memory with ours.

Blender's module `bpy` is looked for in this interpreter (`pip install franbv[judge]`) and in the one that the variable
FRANBV_BPY_PYTHON names. It is published under the GPL, for one version of Python; nothing of ours imports it.
"""

import functools
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics
from materials.material import Matte, RoughConductor
from scenes.scene import Body, Scene

INTERPRETER = "FRANBV_BPY_PYTHON"
SCRIPT = Path(__file__).with_name("cycles_scene.py")
PROJECTOR_SIDE = 0.002
"""Side of the square that stands for our point [m]."""
UNLIMITED = 64
"""Bounces after which nothing is left that could be seen [-]."""


@dataclass(frozen=True)
class EvenProjector:
    """A projector whose pattern is even: it lights all planes across its axis alike within its field."""

    T_world_projector: RigidTransform
    """It shines along +z."""
    half_field: tuple[float, float]
    """Tangents of the half field angles."""
    mean: float
    """Radiance of a white wall at 1 m [W m^-2 sr^-1]."""


@functools.cache
def blender_python() -> str | None:
    """The interpreter that has `bpy`, None if there is none."""
    python = os.environ.get(INTERPRETER) or sys.executable
    found = subprocess.run([python, "-P", "-c", "import bpy"], capture_output=True, check=False, env=_environment())
    return None if found.returncode else python


def needs_cycles() -> None:
    """Skip the test that asks where there is no Blender; a variable that is set must hold what it says."""
    if blender_python() is None:
        if os.environ.get(INTERPRETER):
            pytest.fail(f"{INTERPRETER} is {os.environ[INTERPRETER]}, which cannot import bpy")
        pytest.skip(f"no bpy: install the extra `judge` in a Python 3.11, or name one that has it by {INTERPRETER}")


def cycles_radiance(
    scene: Scene,
    intrinsics: Intrinsics,
    T_world_cam: RigidTransform,
    folder: Path,
    projector: EvenProjector | None = None,
    samples: int = 128,
) -> np.ndarray:
    """Radiance (h, w) of the lamps or, if a projector is given, of its light alone [W m^-2 sr^-1].

    folder: for the files that go to and fro. samples: paths per pixel. ValueError for what the script knows nothing of.
    """
    lamps = () if projector else scene.lamps
    description = {
        "bodies": [_surface(body) for body in scene.bodies],
        "lamps": [
            {"corners": _corners(lamp.T_world_lamp, lamp.width, lamp.height), "radiance": lamp.radiance}
            for lamp in lamps
        ],
        "projectors": [_even(projector)] if projector else [],
        "camera": _camera(intrinsics, T_world_cam),
        "render": {"samples": samples, "bounces": UNLIMITED, "threads": int(os.environ.get("FRANBV_THREADS", "1"))},
    }
    if scene.ambient_radiance or intrinsics.fx != intrinsics.fy:
        raise ValueError("Cycles is given closed rooms and square pixels alone")
    meshes = {f"vertices_{number}": body.mesh.vertices for number, body in enumerate(scene.bodies)}
    meshes |= {f"faces_{number}": body.mesh.faces for number, body in enumerate(scene.bodies)}
    folder.mkdir(parents=True, exist_ok=True)
    given, image = folder / "scene.npz", folder / "image.npy"
    np.savez(given, description=json.dumps(description), **meshes)
    python = blender_python()
    if python is None:
        raise RuntimeError("no bpy: ask needs_cycles() first")
    command = [python, "-P", SCRIPT, given, image]  # -P: Blender is not to find its own names in this folder
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=_environment())
    if done.returncode or not image.exists():
        raise RuntimeError(f"Blender failed: {done.stderr[-2000:]}")
    return np.load(image)


def _environment() -> dict[str, str]:
    """Ours without what would lead Blender's Python to our packages."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


def _surface(body: Body) -> dict[str, Any]:
    if body.mesh.normals is not None:
        raise ValueError(f"{body.name}: Cycles is given flat faces alone")
    match body.material:
        case Matte(reflectance=reflectance):
            return {"name": body.name, "kind": "matte", "reflectance": reflectance}
        case RoughConductor(n=n, k=k, alpha_u=alpha, alpha_v=same, oxide_share=0.0) if alpha == same:
            return {"name": body.name, "kind": "metal", "n": n, "k": k, "alpha": alpha}
    raise ValueError(f"{body.name}: Cycles is given matte bodies and isotropic bare metal alone")


def _corners(pose: RigidTransform, width: float, height: float) -> list[list[float]]:
    """Of a rectangle around the pose's origin that faces along its +z."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * [width / 2, height / 2, 0.0]
    return pose.apply(corners).tolist()


def _even(projector: EvenProjector) -> dict[str, Any]:
    pose = projector.T_world_projector
    return {
        "corners": _corners(pose, PROJECTOR_SIDE, PROJECTOR_SIDE),
        "axes": pose.rotation.as_matrix().T.tolist(),
        "half_field": list(projector.half_field),
        "mean": projector.mean,
        "area": PROJECTOR_SIDE**2,
    }


def _camera(intrinsics: Intrinsics, T_world_cam: RigidTransform) -> dict[str, Any]:
    values = {name: getattr(intrinsics, name) for name in ("width", "height", "fx", "cx", "cy")}
    return values | {"T_world_cam": T_world_cam.as_matrix().tolist()}
