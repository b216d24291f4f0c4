"""What makes results in this process: the versions and the instruction set that decide their bytes.

The same configuration and seed give the same bytes where these agree. Compilers choose other instructions for other
processors: sums are then rounded otherwise, and a reconstruction may take other views.
"""

import importlib.metadata
import platform
from collections.abc import Iterable, Mapping
from functools import cache

import llvmlite.binding

from materials.input_error import InputError
from render.world import backend

VERSIONED = (
    "franbv", "mitsuba", "drjit", "numpy", "scipy", "scikit-learn", "opencv-python-headless", "numba", "llvmlite",
    "cascadio",
)  # fmt: skip
"""Packages whose version can change a result."""
INSTRUCTION_SETS = {"avx512f": "AVX-512", "avx2": "AVX2", "avx": "AVX", "sse4.2": "SSE4.2", "neon": "NEON"}
"""Features of a processor, the widest vectors first, and the names that people know them by."""

Maker = Mapping[str, str]
"""Names of what can change a result, and what they are here."""


@cache
def versions() -> dict[str, str]:
    """Of Python, of every package that can change a result, of the renderer's LLVM; and the instruction set."""
    return (
        {"python": platform.python_version()}
        | {name: installed_version(name) for name in VERSIONED}
        | {"llvm": renderer_llvm(), "instruction set": instruction_set()}
    )


def installed_version(name: str) -> str:
    """Of a package; `none` where it is not installed, as those of extras may be."""
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "none"


def maker() -> dict[str, str]:
    """What makes results in this process: its renderer, and `versions`."""
    return {"renderer": backend.mitsuba_variant()} | versions()


def renderer_llvm() -> str:
    """Version of the LLVM that renders; `none` where nothing can be rendered, as on a robot's computer."""
    try:
        backend.mitsuba_variant()
    except (backend.BackendError, ImportError):
        return "none"
    return ".".join(map(str, backend.llvm_version()))


def instruction_set() -> str:
    """The widest vector instructions of this processor."""
    features = llvmlite.binding.get_host_cpu_features()
    return next((name for feature, name in INSTRUCTION_SETS.items() if features.get(feature)), platform.machine())


def agreed_maker(makers: Iterable[tuple[str, Maker]]) -> Maker | None:
    """The one that all of them are, None without any; InputError where two differ: their results would, too.

    makers: who it is, for people, and what.
    """
    first: tuple[str, Maker] | None = None
    for who, one in makers:
        first = first or (who, one)
        if what := unlikeness(first[1], one):
            raise InputError(
                f"{first[0]} has {what} of {who}; results would differ: use the same everywhere, or another folder"
            )
    return first[1] if first else None


def unlikeness(one: Maker, other: Maker) -> str | None:
    """The first thing in which two makers differ, in words; None if there is none."""
    for name in (*one, *other):
        if one.get(name) != other.get(name):
            return f"{name} {one.get(name)}, not the {other.get(name)}"
    return None
