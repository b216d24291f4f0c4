"""Files of the corpus, damaged by chance: none makes a traceback, none changes its size or volume without a word.

A damaged file is cut off, has some bytes changed, or has a piece of itself or of another file of its format in its
midst, a piece left out, or a piece twice. What may follow:

- an `InputError` in one line;
- the true geometry;
- a notice that the whole file does not give;
- with changed bytes or pieces, not with a cut: as many triangles as before, all closed, with other coordinates. A
  changed digit of a coordinate, of a place or of a unit makes a file that truly describes another part.

A text STL or an OBJ that is cut exactly between two bodies, and two binary STLs cut between them, are whole files of
fewer bodies; nothing marks the end of these formats. `whole_in_front` tells them, from the bytes that were cut off.
"""

import importlib.util
import resource
import subprocess
import sys
import time
import tracemalloc
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from scenes.cad_files import read_cad_file
from scenes.part_materials import part_materials
from scenes.topology import open_edge_count, signed_volume
from scenes.user_mesh import UserPart, load_user_part
from tests.conftest import ROOT
from tests.corpus.make_corpus import CORPUS
from tests.corpus.table import Case

IRON = part_materials(["iron:ground"])
SECONDS = 20.0
"""One file may take this long (choice: a STEP file takes half a second, and the machine may be busy)."""
BYTES = 64 * 2**20
"""Peak memory that Python and numpy may take for one file (choice: the largest file has 20 kB)."""
CHILD_BYTES = 2**30
"""Peak resident memory of the process that meshes STEP (choice: four times what it takes for whole files)."""
KINDS = ("cut", "changed", "spliced", "left out", "twice")


@dataclass(frozen=True)
class Damaged:
    """A file of the corpus after an accident."""

    case: Case
    kind: str
    data: bytes
    cut_off: bytes = b""


@dataclass
class Worst:
    """What a file took at most so far."""

    seconds: float = 0.0
    bytes: int = 0


@dataclass(frozen=True)
class Shape:
    """What counts of a part."""

    box: np.ndarray
    volume: float
    bodies: int
    closed: bool

    def equals(self, other: "Shape") -> bool:
        """Same place, size, volume, bodies, within the rounding of 32-bit numbers."""
        return (
            self.bodies == other.bodies
            and np.allclose(self.box, other.box, atol=1e-7)
            and np.isclose(self.volume, other.volume, rtol=1e-4, atol=1e-12)
        )


def accident(rng: np.random.Generator) -> Damaged:
    """A file and what happened to it; mostly small things to whole files: they slip through best."""
    usable = [case for case in CORPUS if not case.file.endswith("step") or importlib.util.find_spec("cascadio")]
    whole = [case for case in usable if case.bodies]
    case = _one_of(rng, whole if rng.random() < 0.85 else usable)
    data = case.make()
    kind = _one_of(rng, KINDS)
    if kind == "changed":
        return Damaged(case, kind, _changed(rng, data))
    start, stop = _lines(rng, data) if rng.random() < 0.5 else _piece(rng, data)
    if kind == "cut":
        return Damaged(case, kind, data[:start], data[start:])
    if kind == "spliced":
        ending = case.file.rpartition(".")[2]
        other = _one_of(rng, [one for one in usable if one.file.endswith(ending)]).make()
        begin, end = _lines(rng, other) if rng.random() < 0.5 else _piece(rng, other)
        return Damaged(case, kind, data[:start] + other[begin:end] + data[stop:])
    return Damaged(case, kind, data[:start] + data[stop:] if kind == "left out" else data[:stop] + data[start:])


def _one_of(rng: np.random.Generator, things):
    return things[rng.integers(len(things))]


def _changed(rng: np.random.Generator, data: bytes) -> bytes:
    """One to three bytes replaced, one bit of them turned, or a digit made another."""
    changed = bytearray(data)
    digits = [at for at, byte in enumerate(data) if byte in b"0123456789"]
    for _ in range(rng.integers(1, 4)):
        at, dice = int(rng.integers(len(data))), rng.random()
        if digits and dice < 0.4:
            changed[_one_of(rng, digits)] = b"0123456789"[rng.integers(10)]
        else:
            changed[at] = rng.integers(256) if dice < 0.7 else changed[at] ^ (1 << rng.integers(8))
    return bytes(changed)


def _piece(rng: np.random.Generator, data: bytes) -> tuple[int, int]:
    """Where a piece begins and ends; mostly a short one."""
    start = int(rng.integers(len(data) + 1))
    length = rng.geometric(0.02) if rng.random() < 0.8 else rng.integers(len(data))
    return start, min(start + int(length), len(data))


def _lines(rng: np.random.Generator, data: bytes) -> tuple[int, int]:
    """The same with whole lines, one to three of them."""
    ends = [0, *(at + 1 for at, byte in enumerate(data) if byte == 10), len(data)]
    first = int(rng.integers(len(ends) - 1))
    return ends[first], ends[min(first + int(rng.integers(1, 4)), len(ends) - 1)]


def whole_in_front(damaged: Damaged) -> bool:
    """Whether a file was cut exactly between two of its bodies, in a format that has no end mark."""
    rest = damaged.cut_off
    text = rest.lstrip(b" \r\n").startswith((b"o ", b"solid")) and not damaged.data.endswith(b"end")
    binary = damaged.case.file == "binary_after_binary.stl" and len(rest) == 84 + 12 * 50
    return damaged.case.file.endswith((".stl", ".obj")) and (text or binary)


def shape(part: UserPart) -> Shape:
    """Of a loaded part."""
    corners = np.concatenate([body.mesh.vertices for body in part.bodies])
    volumes = [signed_volume(body.mesh.vertices, body.mesh.faces) for body in part.bodies]
    return Shape(
        np.stack([corners.min(axis=0), corners.max(axis=0)]),
        sum(volumes),
        len(part.bodies),
        all(open_edge_count(body.mesh) == 0 for body in part.bodies),
    )


def loaded(folder: Path, case: Case, data: bytes, worst: Worst) -> UserPart | None:
    """The part in a file with these bytes, None if it is refused; in one line, in bounded time and memory."""
    path = folder / case.file
    path.write_bytes(data)
    part, message = None, f"{path}: "
    tracemalloc.start()
    begin = time.perf_counter()
    try:
        part = load_user_part(path, case.units, IRON, up="z")
    except InputError as error:
        message = str(error)
    took, peak = time.perf_counter() - begin, tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert took < SECONDS, f"{path}: {took:.1f} s"
    assert peak < BYTES, f"{path}: {peak} bytes"
    worst.seconds, worst.bytes = max(worst.seconds, took), max(worst.bytes, peak)
    return part


def outcome(folder: Path, damaged: Damaged, part: UserPart | None, before: UserPart | None) -> str:
    """What became of the file, which was `before`; a word with `SILENT` in it breaks the law."""
    if part is None:
        return "refused"
    found = shape(part)
    if before is not None and found.equals(shape(before)):
        return "true geometry"
    if len(part.notices) > (0 if before is None else len(before.notices)) or not found.closed:
        return "notice" if part.notices else "SILENT: open"
    if before is None:  # the damage took away what made the file unreadable, such as a NaN
        return "readable by chance"
    if any(damaged.data == case.make() for case in CORPUS):
        return "another whole file"
    if damaged.kind == "cut":
        return "whole file of fewer bodies" if whole_in_front(damaged) else "SILENT: cut off"
    counts = {triangle_count(folder, damaged.case, data) for data in (damaged.data, damaged.case.make())}
    return "other coordinates" if len(counts) == 1 else "SILENT: other surface"


def triangle_count(folder: Path, case: Case, data: bytes) -> int:
    """Triangles that the file has, those included that collapse where two corners fall together."""
    path = folder / case.file
    path.write_bytes(data)
    return sum(len(body.faces) for body in read_cad_file(path).bodies)


def run(folder: Path, count: int, seed: int) -> None:
    """Damage `count` files and judge what becomes of them."""
    rng = np.random.default_rng(seed)
    whole: dict[str, UserPart | None] = {}
    counts: Counter[str] = Counter()
    silent = []
    worst, child_before = Worst(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    for number in range(count):
        damaged = accident(rng)
        case = damaged.case
        if case.file not in whole:
            whole[case.file] = loaded(folder, case, case.make(), worst)
        word = outcome(folder, damaged, loaded(folder, case, damaged.data, worst), whole[case.file])
        counts[word] += 1
        if "SILENT" in word:
            (folder / f"{number}_{case.file}").write_bytes(damaged.data)
            silent.append(f"{number}_{case.file}, {damaged.kind}: {word}")
    listed = ", ".join(f"{counts[word]} {word}" for word in sorted(counts))
    child = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss  # [kB], of all processes so far
    took = f"at most {worst.seconds:.1f} s, {worst.bytes / 1e6:.1f} MB, and {child / 1e3:.0f} MB to mesh STEP"
    print(f"{sum(counts.values())} of {count} files judged: {listed}; {took}")  # noqa: T201 (shown with -s)
    assert not silent, (folder, silent)
    assert child == child_before or child * 1024 < CHILD_BYTES


def run_alone(folder: Path, count: int, seed: int) -> None:
    """`run` in a process of its own: what its children take is counted from its own size on, and here it is small."""
    call = (
        f"from pathlib import Path; from tests.corpus.test_fuzz import run; run(Path({str(folder)!r}), {count}, {seed})"
    )
    done = subprocess.run([sys.executable, "-c", call], cwd=ROOT, capture_output=True, text=True, check=False)
    print(done.stdout, end="")  # noqa: T201 (shown with -s)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_hundred_damaged_files(tmp_path):
    """No traceback, no silent change, bounded time and memory."""
    run_alone(tmp_path, 100, seed=1)


@pytest.mark.slow
def test_a_thousand_damaged_files(tmp_path):
    """The same with other accidents."""
    run_alone(tmp_path, 1000, seed=2)
