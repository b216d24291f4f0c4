"""STEP (ISO 10303-21) through Open CASCADE: checked as text, meshed in a process of its own, read back as GLB [m].

Open CASCADE ends its process on some damaged files, and drops what it cannot make; so the text is checked before, and
the faces are counted after.
"""

import json
import re
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from materials.input_error import InputError
from scenes.cad.cad_file import CadFile, damaged, shown
from scenes.cad.gltf import read_gltf_file
from scenes.cad.step_text import doubts, read_step_text

SECONDS = 600
"""The meshing may take this long [s] (choice: assemblies of thousands of faces take one minute)."""
MEMORY = 16 * 2**30
"""Address space of the meshing [bytes] (choice: several times what the largest mesh that is taken needs)."""
QUOTED = 3
"""Complaints of Open CASCADE that are passed on (choice: they repeat themselves)."""
_ORNAMENT = re.compile(r"\x1b\[[0-9;]*m|\*{2,}")
_MESHING = f"""
import sys
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, ({MEMORY}, {MEMORY}))
except (ImportError, ValueError, OSError):
    pass  # no such limits here
sys.modules["trimesh"] = None  # which cascadio would load to no end here: half of the time
import cascadio
cascadio.step_to_glb(sys.argv[1], sys.argv[2], merge_primitives=False)
"""


def read_step_file(path: Path, data: bytes) -> CadFile:
    """The bodies of a STEP file, in metres: one for every place that a part has in its assembly."""
    text = read_step_text(path, data)
    glb, complaints = _meshed(path, data)
    read = read_gltf_file(path, glb)
    tree = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    faces = sum(len(mesh["primitives"]) for mesh in tree.get("meshes", []))
    notices = (*doubts(text, faces, len(tree.get("nodes", []))), *complaints, *read.notices)
    return replace(read, notices=notices, unit=text.unit)


def _meshed(path: Path, data: bytes) -> tuple[bytes, list[str]]:
    """GLB of the shapes, with one primitive per face, and what Open CASCADE complained of."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "shape.step"), Path(folder, "shape.glb")
        source.write_bytes(data)
        command = [sys.executable, "-P", "-c", _MESHING, str(source), str(target)]
        try:
            run = subprocess.run(command, capture_output=True, timeout=SECONDS, check=False)
        except subprocess.TimeoutExpired as error:
            raise InputError(f"{path}: meshing takes more than {SECONDS} s; export it simpler, or as STL") from error
        if run.returncode == 0 and target.is_file() and target.stat().st_size:
            return target.read_bytes(), _complaints(run.stdout)
    lines = run.stderr.decode("utf-8", "replace").strip().splitlines()
    why = shown(lines[-1]) if lines else "Open CASCADE finds no shape in it"
    raise damaged(path, why if run.returncode >= 0 else "Open CASCADE gives up on it")


def _complaints(said: bytes) -> list[str]:
    """Lines of Open CASCADE that tell of something that it left out, without colours and stars; the first few."""
    lines = [_ORNAMENT.sub("", line).strip() for line in said.decode("utf-8", "replace").splitlines()]
    bad = [line for line in lines if line.startswith("ERR ") or " skipped " in line]
    return [f"Open CASCADE says: {shown(line)}; mend the part in CAD if something is missing" for line in bad[:QUOTED]]
