"""Links at the top of an output folder to the files of the case that was asked for last: DIR/report.html just opens.

`DIR/latest` points to the case and every `DIR/<file>` to `latest/<file>`, so one rename moves them all at once.
"""

import contextlib
import os
from collections.abc import Iterable
from pathlib import Path

LATEST = "latest"


def point_latest(case: Path, files: Iterable[str]) -> None:
    """Make the links beside the case folder; files of the user are never replaced, and without links we do without."""
    out = case.parent
    with contextlib.suppress(OSError):  # file systems without symbolic links
        _link(out / LATEST, case.name)
        for name in files:
            if (case / name).exists():
                _link(out / name, f"{LATEST}/{name}")


def _link(link: Path, target: str) -> None:
    if link.exists() and not link.is_symlink():
        return
    temporary = link.with_name(f".{link.name}.{os.getpid()}.tmp")
    temporary.unlink(missing_ok=True)
    temporary.symlink_to(target)
    os.replace(temporary, link)
