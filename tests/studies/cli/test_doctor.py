"""The doctor finds what is wrong, says what to do, and never breaks itself."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement

from materials.input_error import InputError
from studies.cli import doctor


def test_this_machine_is_looked_at_in_full():
    """The tests run in an environment that fits: its packages and its renderer are as required, and it has a speed."""
    checks = {check.name: check for check in doctor.diagnose()}
    assert list(checks) == ["python", "packages", "processor", "memory", "disk", "matcher", "renderer", "rays"]
    assert checks["python"].mend is None
    assert checks["packages"].mend is None
    assert "mitsuba 3.9.1" in checks["packages"].found
    assert checks["matcher"].mend is None
    assert checks["renderer"].mend is None
    assert float(checks["rays"].found.split()[0]) > 0


def test_a_broken_renderer_ends_with_status_1_and_a_mend(tmp_path: Path):
    """As a user meets it: a wrong LLVM path, the whole command, no traceback, and the speed is not asked."""
    done = subprocess.run(
        [sys.executable, "-c", "import sys; from studies.cli.main import main; sys.exit(main(['doctor', '--json']))"],
        env=os.environ | {"DRJIT_LIBLLVM_PATH": str(tmp_path / "libLLVM.so")},
        cwd=Path(doctor.__file__).parents[1],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "Traceback" not in done.stdout + done.stderr
    assert "MEND  renderer" in done.stdout
    summary = json.loads(done.stdout.splitlines()[-1])
    assert not summary["ok"]
    failed = [check for check in summary["checks"] if check["mend"]]
    assert "unset it" in next(check["mend"] for check in failed if check["name"] == "renderer")
    assert "rays" not in [check["name"] for check in summary["checks"]]


@pytest.mark.parametrize(
    ("requirement", "problem"),
    [
        ("numpy>=1.0", None),
        ("numpy<1.0", r"numpy is \d+\.\d+\.\d+\S*, wanted <1.0"),
        ("no-such-package-of-ours>=1", "no-such-package-of-ours is missing"),
    ],
)
def test_versions_are_compared_as_pip_does(requirement: str, problem: str | None):
    """numpy is installed in some version above 1; the other package does not exist."""
    found = doctor._mismatch(Requirement(requirement))
    if problem is None:
        assert found is None
    else:
        assert found is not None
        assert re.fullmatch(problem, found)


def test_too_little_memory_and_disk_are_said(monkeypatch: pytest.MonkeyPatch):
    """No machine has 2^60 bytes of either."""
    monkeypatch.setattr(doctor, "DISK_NEEDED", 2**60)
    monkeypatch.setattr(doctor, "_available_memory", lambda: 2**20)
    assert "free some" in (doctor.disk().mend or "")
    assert "close other programs" in (doctor.memory().mend or "")


def test_a_matcher_that_is_off_is_said(monkeypatch: pytest.MonkeyPatch):
    """Compiled wrongly it would still give disparities: half a pixel off everywhere is not the shift of the pair."""

    class Off:
        def match(self, left: np.ndarray, right: np.ndarray) -> np.ndarray:
            return np.full(left.shape, doctor.TEST_SHIFT_PX + 0.5, np.float32)

    monkeypatch.setattr(doctor, "D4Matcher", Off)
    assert "reinstall numba" in (doctor.matcher().mend or "")


def test_an_aborted_render_is_a_failed_check(monkeypatch: pytest.MonkeyPatch):
    """A process that aborts (-6) leaves no Python error behind; its status and its last word are reported."""
    aborted = subprocess.CompletedProcess([], -6, stdout="", stderr="LLVM ERROR: Cannot select: fminimum\n")
    monkeypatch.setattr(subprocess, "run", lambda *args, **kwargs: aborted)
    check = doctor.rays()
    assert check.mend is not None
    assert "status -6: LLVM ERROR: Cannot select: fminimum" in check.found


def test_a_check_that_breaks_is_a_failed_check():
    """Input errors bring their own mend, on one line; a broken package asks for a new installation, a fault of
    ours does not: it would be there again."""

    def mendable() -> doctor.Check:
        raise InputError("no LLVM:\n install one")

    def broken() -> doctor.Check:
        raise OSError("libfoo.so: cannot open shared object file")

    def ours() -> doctor.Check:
        return doctor.no_such_name  # type: ignore[attr-defined]

    assert "fault of franbv" in (doctor._guarded(ours).mend or "")
    assert doctor._guarded(mendable) == doctor.Check("mendable", "not usable", "no LLVM: install one")
    check = doctor._guarded(broken)
    assert check.found == "OSError: libfoo.so: cannot open shared object file"
    assert check.mend is not None
    assert "reinstall" in check.mend
