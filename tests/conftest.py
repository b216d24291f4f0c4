"""What all tests share: the shapes and types of the annotations are executed, except where times are taken.

Of several test processes each has its share of the processors; what a test starts inherits it.
"""

import os
from pathlib import Path

THREADS = max(1, (os.cpu_count() or 1) // int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1")))
"""Of each test process."""
for variable in ("FRANBV_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # read when the libraries are loaded
    os.environ.setdefault(variable, str(THREADS))

import jaxtyping  # noqa: E402
import pytest  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("franbv", "render", "scenes", "materials", "studies")
CHECKER = "beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))"
"""Where a float is wanted an int will do, as for every type checker (PEP 484)."""
UNCHECKED = ("studies.base.flags", "studies.safe_angles.flags", "studies.advise.flags")
"""Tyro fills fields with its own mark for what is missing."""


def pytest_configure(config: pytest.Config) -> None:
    """Check every call against its annotations, as long as no benchmark is asked for."""
    if config.getoption("markexpr") != "benchmark":
        jaxtyping.install_import_hook(checkable_modules(), CHECKER)


def checkable_modules() -> list[str]:
    """All modules of ours but UNCHECKED and those of bare numba kernels.

    numba cannot compile a wrapper: a module marks its kernels with `@no_type_check`, or is left out as a whole.
    """
    sources = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py") if path.stem != "__init__")
    texts = {".".join(path.relative_to(ROOT).with_suffix("").parts): path.read_text() for path in sources}
    return [
        name
        for name, text in texts.items()
        if name not in UNCHECKED and ("njit" not in text or "no_type_check" in text)
    ]
