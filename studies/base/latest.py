"""Links at the top of an output folder to the files of the case that was asked for last: DIR/report.html just opens.

`DIR/latest` points to the case and every `DIR/<file>` to `latest/<file>`, so one rename moves them all at once.
"""

import contextlib
import os
import re
from collections.abc import Iterable
from pathlib import Path

from studies.base.atomic_file import DIGEST_BYTES

LATEST = "latest"
CASE_NAME = re.compile(rf"[0-9a-f]{{{2 * DIGEST_BYTES}}}")
"""Of a case's folder."""


def point_latest(case: Path, files: Iterable[str]) -> None:
    """Make the links beside the case folder; files and links of the user are never replaced, and without links we do
    without."""
    out = case.parent
    with contextlib.suppress(OSError):  # file systems without symbolic links
        _link(out / LATEST, case.name)
        for name in files:
            if (case / name).exists():
                _link(out / name, f"{LATEST}/{name}")


def _link(link: Path, target: str) -> None:
    if not _is_ours(link):
        return
    temporary = link.with_name(f".{link.name}.{os.getpid()}.tmp")
    temporary.unlink(missing_ok=True)
    temporary.symlink_to(target)
    os.replace(temporary, link)


def _is_ours(link: Path) -> bool:
    """Whether nothing is there but a link as made here: LATEST to a case beside it, others into LATEST."""
    if not link.is_symlink():
        return not link.exists()
    target = os.readlink(link)
    return CASE_NAME.fullmatch(target) is not None if link.name == LATEST else target == f"{LATEST}/{link.name}"
