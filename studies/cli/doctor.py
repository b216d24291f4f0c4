"""`franbv doctor`: can this machine render and reconstruct? Every check says what it found and what to do about it."""

import importlib.metadata
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from packaging.requirements import Requirement

from materials.input_error import InputError
from render.matcher.d4.matcher import D4Matcher
from render.world import backend
from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.work.maker import instruction_set
from studies.work.workers import usable_processors

MEMORY_NEEDED = 2 * 2**30
"""[bytes]: the most that a reconstruction may take."""
DISK_NEEDED = 2**30
"""[bytes]: choice, tens of runs; one leaves some tens of megabytes."""
RAYS_NEEDED = 2e5
"""Camera rays per second [1/s]: choice, a tenth of two cores of a common laptop; below it one frame takes minutes."""
RENDER_TIMEOUT = 300.0
"""[s]: choice, far above the 10 s that the slowest machines took."""

TEST_SHIFT_PX = 20
"""Disparity of the matcher's test pair [px]: choice, in the middle of the usual ones."""


BROKEN_INSTALLATION = (ImportError, OSError, subprocess.SubprocessError)
"""What a package raises that is not whole."""
FOREIGN = ("numba", "llvmlite", "drjit", "mitsuba")
"""Packages whose own errors speak of themselves."""
STUDIES_EXTRA = "studies"
"""Of the package, with everything that simulator and studies need."""
REINSTALL = "reinstall the packages: `make setup` in the repository, or pip install --force-reinstall 'franbv[studies]'"


@dataclass(frozen=True)
class Check:
    """One thing that was looked at."""

    name: str
    found: str
    """What is there."""
    mend: str | None = None
    """What to do; None = all is well."""


@dataclass(frozen=True)
class DoctorCommand:
    """The flags of `franbv doctor`."""

    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Print all checks; 0 when all is well, 1 when something must be mended."""
    command = parse(
        DoctorCommand, args, "franbv doctor", "Check that this machine can render and reconstruct.", DoctorCommand()
    )
    checks = diagnose()
    width = max(len(check.name) for check in checks)
    for check in checks:
        say(f"{'ok  ' if check.mend is None else 'MEND'}  {check.name:<{width}}  {check.found}")
        if check.mend is not None:
            say(f"{'':{width + 6}}  -> {check.mend}")
    ok = all(check.mend is None for check in checks)
    if command.json:
        say_json({"ok": ok, "checks": [vars(check) for check in checks]})
    return 0 if ok else 1


def diagnose() -> list[Check]:
    """All checks. One that breaks is one that failed, never a traceback; without a renderer its speed is not asked."""
    checks = [_guarded(check) for check in (python, packages, processor, memory, disk, matcher, renderer)]
    return checks if checks[-1].mend is not None else [*checks, _guarded(rays)]


def python() -> Check:
    """The interpreter, against what the package asks for."""
    found = f"{platform.python_version()} ({platform.system()} {platform.machine()})"
    fits = (3, 11) <= sys.version_info < (3, 14)
    return Check("python", found, None if fits else "make an environment with Python 3.11, 3.12 or 3.13")


def packages() -> Check:
    """Installed versions against the requirements that the package itself states."""
    requirements = [Requirement(line) for line in importlib.metadata.requires("franbv") or []]
    needed = [r for r in requirements if r.marker is None or r.marker.evaluate({"extra": STUDIES_EXTRA})]
    wrong = [problem for r in needed if (problem := _mismatch(r))]
    pins = [f"{r.name} {importlib.metadata.version(r.name)}" for r in needed if "==" in str(r.specifier) and not wrong]
    if wrong:
        return Check(
            "packages",
            "; ".join(wrong),
            f"pip install --upgrade 'franbv[{STUDIES_EXTRA}]', or `make setup` in its repository",
        )
    return Check("packages", f"{len(needed)} as required; {', '.join(pins)}")


def processor() -> Check:
    """Its widest vector instructions: the same seed gives the same bytes only where they are the same."""
    count = usable_processors()
    return Check("processor", f"{instruction_set()}, {count} {'processor' if count == 1 else 'processors'} to use")


def matcher() -> Check:
    """The D4-like matcher on noise that is shifted by a known disparity; its first frame may have to compile it."""
    left = np.random.default_rng(0).integers(0, 256, (360, 640), np.uint8)
    right = np.roll(left, -TEST_SHIFT_PX, axis=1)
    durations, disparity = [], np.zeros(0)
    for _ in range(3):
        start = time.perf_counter()
        disparity = D4Matcher().match(left, right)
        durations.append(time.perf_counter() - start)
    found = f"first frame after {durations[0]:.1f} s, then {min(durations[1:]) * 1e3:.0f} ms each (640 x 360)"
    right_one = np.median(disparity[disparity > 0]) == TEST_SHIFT_PX
    return Check(
        "matcher",
        found,
        None if right_one else f"it misses a shift of {TEST_SHIFT_PX} px: reinstall numba and llvmlite",
    )


def renderer() -> Check:
    """Mitsuba's variant once it is set, the LLVM behind it, and Dr.Jit's threads beside the processors we may use."""
    name = backend.mitsuba().variant()
    if name == "llvm_ad_mono":
        library = backend.find_llvm()
        version = ".".join(map(str, backend.llvm_version()))
        name += f" on LLVM {version} ({library.name if library else 'of the system'})"
    return Check("renderer", f"{name}, {backend.thread_count()} threads on {usable_processors()} processors")


def rays() -> Check:
    """Measured speed of a small scene, in a process of its own since a broken LLVM or driver aborts the process."""
    # The folder of the packages comes first on the path: the tool may run from a checkout that is not installed.
    root = str(Path(backend.__file__).resolve().parents[2])
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, [root, os.environ.get("PYTHONPATH")]))}
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-m", "render.world.ray_rate"],
            capture_output=True,
            text=True,
            timeout=RENDER_TIMEOUT,
            env=environment,
            cwd=folder,
            check=False,
        )
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        return Check(
            "rays",
            f"the test render ended with status {done.returncode}: {reason}",
            f"set {backend.LIBRARY_VARIABLE} to another libLLVM, or {backend.VARIANT_VARIABLE}=llvm_ad_mono",
        )
    rate = float(done.stdout.split()[-1])
    slow = f"slower than {RAYS_NEEDED:.0e} rays/s: close other programs, or give the process more processors"
    return Check("rays", f"{rate / 1e6:.2f} million camera rays/s", None if rate >= RAYS_NEEDED else slow)


def memory() -> Check:
    """Memory that is free for new work."""
    free = _available_memory()
    if free is None:
        return Check("memory", "unknown on this system")
    mend = f"a reconstruction takes up to {MEMORY_NEEDED / 2**30:.0f} GiB: close other programs"
    return Check("memory", f"{free / 2**30:.1f} GiB free", None if free >= MEMORY_NEEDED else mend)


def disk() -> Check:
    """Space where results would go by default, the current folder."""
    free = shutil.disk_usage(Path.cwd()).free
    mend = f"results need up to {DISK_NEEDED / 2**30:.0f} GiB: free some, or work in another folder"
    return Check("disk", f"{free / 2**30:.1f} GiB free here", None if free >= DISK_NEEDED else mend)


def _guarded(check: Callable[[], Check]) -> Check:
    try:
        return check()
    except InputError as error:
        return Check(check.__name__, "not usable", " ".join(str(error).split()))
    except Exception as error:  # nothing may keep the other checks from being made
        broken = isinstance(error, BROKEN_INSTALLATION) or type(error).__module__.partition(".")[0] in FOREIGN
        mend = REINSTALL if broken else "this is a fault of franbv itself: report it, with what FRANBV_DEBUG=1 shows"
        if os.environ.get("FRANBV_DEBUG") == "1":
            traceback.print_exc()
        return Check(check.__name__, f"{type(error).__name__}: {' '.join(str(error).split())}", mend)


def _mismatch(requirement: Requirement) -> str | None:
    """What is wrong with the installed version, None if nothing is."""
    try:
        version = importlib.metadata.version(requirement.name)
    except importlib.metadata.PackageNotFoundError:
        return f"{requirement.name} is missing"
    if requirement.specifier.contains(version, prereleases=True):
        return None
    return f"{requirement.name} is {version}, wanted {requirement.specifier}"


def _available_memory() -> int | None:
    """MemAvailable of Linux [bytes], less where a control group allows less; None elsewhere."""
    meminfo = Path("/proc/meminfo")
    if not meminfo.exists():
        return None
    lines = dict(line.split(":", 1) for line in meminfo.read_text().splitlines())
    available = int(lines["MemAvailable"].split()[0]) * 1024
    limit, used = (Path("/sys/fs/cgroup") / name for name in ("memory.max", "memory.current"))
    if limit.exists() and (text := limit.read_text().strip()).isdigit():
        available = min(available, int(text) - int(used.read_text()))
    return available
