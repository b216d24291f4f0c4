"""The one door to Mitsuba: finds an LLVM that Dr.Jit can use, checks it, and sets the one-channel variant.

Dr.Jit loads LLVM while it is being imported, from `DRJIT_LIBLLVM_PATH`, and with a version below 17 the first render
aborts the whole process. So the library is chosen before that import, and its version is read before anything renders.
"""

import functools
import importlib.metadata
import os
import re
import sys
from pathlib import Path
from types import ModuleType

from materials.input_error import InputError

LLVM_OLDEST = 19
"""Oldest LLVM that was tried and works, with Mitsuba 3.9.1; 15 aborts, 16 to 18 were not tried."""
LLVM_PACKAGE = "karellen-llvm-core"
"""PyPI package that carries libLLVM for Linux on x86-64."""
LIBRARY_VARIABLE = "DRJIT_LIBLLVM_PATH"
"""Environment variable from which Dr.Jit takes the library."""
VARIANT_VARIABLE = "FRANBV_VARIANT"
"""Environment variable that overrides the choice of variant."""
THREADS_VARIABLE = "FRANBV_THREADS"
"""Environment variable with the CPU threads that Dr.Jit starts with; without it, one for each processor."""
VARIANTS = ("llvm_ad_mono", "cuda_ad_mono")
"""Mitsuba variants that fit: one channel is 850 nm."""
SYSTEM_FOLDERS = (
    "/usr/lib/x86_64-linux-gnu",
    "/usr/lib/aarch64-linux-gnu",
    "/usr/lib64",
    "/usr/lib",
    "/usr/lib/llvm-*/lib",
    "/usr/lib64/llvm*/lib*",
    "/opt/homebrew/opt/llvm*/lib",
    "/usr/local/opt/llvm*/lib",
)
"""Where Debian, Fedora, Arch and Homebrew put LLVM."""


class BackendError(InputError):
    """The renderer cannot run on this machine as it is set up; the message says what to do."""


def mitsuba_variant() -> str:
    """Prepare Dr.Jit and return the Mitsuba variant that runs here: CUDA where there is a GPU, else LLVM.

    Raises BackendError when neither is usable, or when `FRANBV_VARIANT` asks for one that is not.
    """
    outcome = _outcome()
    if isinstance(outcome, BackendError):
        raise outcome
    return outcome


@functools.cache
def _outcome() -> str | BackendError:
    """The variant, or why there is none. Dr.Jit starts once a process, so the first answer stays."""
    try:
        return _started_variant()
    except BackendError as error:
        return error


def _started_variant() -> str:
    wanted = os.environ.get(VARIANT_VARIABLE)
    if wanted is not None and wanted not in VARIANTS:
        raise BackendError(f"{VARIANT_VARIABLE}={wanted}: not a variant of this tool; set {' or '.join(VARIANTS)}")
    imported_before = "drjit" in sys.modules
    if not imported_before:
        _choose_llvm()
    import drjit

    if THREADS_VARIABLE in os.environ:
        drjit.set_thread_count(_wanted_threads(os.environ[THREADS_VARIABLE]))
    has_cuda = bool(drjit.has_backend(drjit.JitBackend.CUDA))
    if wanted == "cuda_ad_mono" and not has_cuda:
        raise BackendError(f"{VARIANT_VARIABLE}=cuda_ad_mono: no CUDA driver was found; unset it to render on the CPU")
    if has_cuda and wanted != "llvm_ad_mono":
        return "cuda_ad_mono"
    _check_llvm(llvm_version(), imported_before)
    return "llvm_ad_mono"


def _wanted_threads(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise BackendError(f"{THREADS_VARIABLE}={text}: is no thread count; set it to 1 or more, or unset it")
    return int(text)


def mitsuba() -> ModuleType:
    """The `mitsuba` module with its variant set; call it as often as you like."""
    variant = mitsuba_variant()
    import mitsuba as module

    if module.variant() != variant:
        module.set_variant(variant)
    return module


def thread_count(n: int | None = None) -> int:
    """Let Dr.Jit use `n` CPU threads (None: leave it as it is); returns the number in use."""
    mitsuba_variant()
    import drjit

    if n is not None:
        if n < 1:
            raise BackendError(f"threads: {n} is no thread count; give 1 or more")
        drjit.set_thread_count(n)
    return drjit.thread_count()


def llvm_version() -> tuple[int, ...]:
    """Version of the LLVM that Dr.Jit has loaded, (-1, -1, -1) if none."""
    import drjit

    return tuple(drjit.detail.llvm_version())


def find_llvm() -> Path | None:
    """The libLLVM to use: the one that the environment names, else the package's, else the newest of the system."""
    named = os.environ.get(LIBRARY_VARIABLE)
    return Path(named) if named else packaged_llvm() or system_llvm()


def packaged_llvm() -> Path | None:
    """The libLLVM that the PyPI package installed, None if it is not installed."""
    try:
        files = importlib.metadata.files(LLVM_PACKAGE) or []
    except importlib.metadata.PackageNotFoundError:
        return None
    libraries = (Path(str(file.locate())) for file in files if file.name.startswith("libLLVM"))
    # The package makes its short names as links on the first start of Python; the full name is always there.
    return next((library.resolve() for library in libraries if library.exists()), None)


def system_llvm() -> Path | None:
    """The newest libLLVM of the system that is new enough, None if there is none."""
    found: list[tuple[int, Path]] = []
    for folder in SYSTEM_FOLDERS:
        for library in Path("/").glob(f"{folder.lstrip('/')}/libLLVM*"):
            version = re.fullmatch(r"libLLVM(?:-|\.so\.|\.)?(\d+)[\d.]*(?:\.so[\d.]*|\.dylib)?", library.name)
            if version and int(version[1]) >= LLVM_OLDEST:
                found.append((int(version[1]), library))
    return max(found)[1] if found else None


def _choose_llvm() -> None:
    """Point Dr.Jit at the library, while it is not imported yet."""
    library = find_llvm()
    if library is None:
        return
    if not library.exists():
        raise BackendError(f"{LIBRARY_VARIABLE}={library}: no such file; unset it or name a libLLVM >= {LLVM_OLDEST}")
    os.environ[LIBRARY_VARIABLE] = str(library)


def _check_llvm(version: tuple[int, ...], imported_before: bool) -> None:
    """Raise BackendError unless Dr.Jit's LLVM is new enough to render."""
    if version[0] >= LLVM_OLDEST:
        return
    named = os.environ.get(LIBRARY_VARIABLE)
    loaded = f"LLVM {version[0]}" if version[0] > 0 else "no LLVM"
    origin = f" from {LIBRARY_VARIABLE}={named}" if named else ""
    if imported_before:
        mend = "call render.world.backend.mitsuba() before anything imports drjit or mitsuba"
    elif named:
        mend = f"unset {LIBRARY_VARIABLE}, or set it to a libLLVM of version {LLVM_OLDEST} or newer"
    else:
        mend = f"pip install {LLVM_PACKAGE}, or set {LIBRARY_VARIABLE} to a libLLVM of version {LLVM_OLDEST} or newer"
    raise BackendError(f"Dr.Jit loaded {loaded}{origin}, rendering needs LLVM {LLVM_OLDEST} or newer: {mend}")
