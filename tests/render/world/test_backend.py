"""The backend finds an LLVM or says, in one line and before anything renders, what to do."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from render.world import backend


def outcome(code: str, **environment: str) -> str:
    """What a fresh process prints that runs `code` and prints the BackendError, if it raises one."""
    program = f"""
from render.world import backend
try:
    {code}
except backend.BackendError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(backend.__file__).parents[1],
    )
    return done.stdout.strip()


def test_one_channel_is_set_on_an_llvm_that_works():
    """The variant is one of the monochrome ones (850 nm is the one channel) and the LLVM is not one that aborts."""
    mi = backend.mitsuba()
    assert mi.variant() in ("llvm_ad_mono", "cuda_ad_mono")
    assert len(mi.Color3f()) == 3
    assert len(mi.Spectrum()) == 1
    if mi.variant() == "llvm_ad_mono":
        assert backend.llvm_version() >= (19,)


def test_the_module_is_the_same_every_time():
    """Asking twice changes nothing: the second answer is the module that was set up first."""
    assert backend.mitsuba() is backend.mitsuba()


def test_a_library_that_is_not_there_is_named(tmp_path: Path):
    """The line names the variable, its value and the mend."""
    missing = tmp_path / "libLLVM.so"
    line = outcome("backend.mitsuba()", DRJIT_LIBLLVM_PATH=str(missing))
    assert line == f"DRJIT_LIBLLVM_PATH={missing}: no such file; unset it or name a libLLVM >= 19"


def test_a_file_that_is_no_library_is_refused_before_rendering(tmp_path: Path):
    """Dr.Jit cannot load a text file, so it has no LLVM; it would raise far away, at the first render."""
    text = tmp_path / "libLLVM.so"
    text.write_text("not a library")
    line = outcome("backend.mitsuba()", DRJIT_LIBLLVM_PATH=str(text), FRANBV_VARIANT="llvm_ad_mono")
    assert line.startswith(f"Dr.Jit loaded no LLVM from DRJIT_LIBLLVM_PATH={text}")
    assert "unset DRJIT_LIBLLVM_PATH" in line


def test_an_old_llvm_is_refused_before_rendering():
    """LLVM 15 would abort the process on the first render. Few machines have it, so Dr.Jit's answer is replaced."""
    code = "backend.llvm_version = lambda: (15, 0, 6); backend.mitsuba()"
    line = outcome(code, FRANBV_VARIANT="llvm_ad_mono")
    assert line.startswith("Dr.Jit loaded LLVM 15")
    assert "LLVM 19 or newer" in line


def test_drjit_imported_too_early_is_said(tmp_path: Path):
    """Dr.Jit loads LLVM while it is imported: afterwards the backend can only say so, each time it is asked."""
    text = tmp_path / "libLLVM.so"
    text.write_text("not a library")
    code = """
    import drjit
    for _ in range(2):
        try:
            backend.mitsuba()
        except backend.BackendError as error:
            print(error)"""
    lines = outcome(code, DRJIT_LIBLLVM_PATH=str(text), FRANBV_VARIANT="llvm_ad_mono").splitlines()
    assert len(lines) == 2
    assert lines[0] == lines[1]
    assert lines[0].endswith("call render.world.backend.mitsuba() before anything imports drjit or mitsuba")


def test_a_foreign_variant_is_refused():
    """A colour variant would render 850 nm as three channels of visible light."""
    line = outcome("backend.mitsuba()", FRANBV_VARIANT="llvm_ad_rgb")
    assert line == "FRANBV_VARIANT=llvm_ad_rgb: not a variant of this tool; set llvm_ad_mono or cuda_ad_mono"


def test_the_newest_library_of_the_system_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Names as Debian (libLLVM-19.so.1, libLLVM.so.19.1), Fedora (libLLVM.so.20.1) and Homebrew give them."""
    old = ["libLLVM-14.so.1", "libLLVM-15.so", "libLLVM.so.18.1", "libLLVMCore.a", "libLLVM.so", "libLLVM-C.dylib"]
    for name in [*old, "libLLVM-19.so", "libLLVM-19.so.1", "libLLVM.so.19.1"]:
        (tmp_path / name).touch()
    monkeypatch.setattr(backend, "SYSTEM_FOLDERS", (str(tmp_path),))
    found = backend.system_llvm()
    assert found is not None
    assert "19" in found.name
    (tmp_path / "libLLVM.so.20.1").touch()
    assert backend.system_llvm() == tmp_path / "libLLVM.so.20.1"
    monkeypatch.setattr(backend, "SYSTEM_FOLDERS", (str(tmp_path / "nowhere"),))
    assert backend.system_llvm() is None


def test_threads_are_counted_as_asked():
    """Dr.Jit reports the count that was set; none is refused."""
    before = backend.thread_count()
    try:
        assert backend.thread_count(1) == 1
        assert backend.thread_count() == 1
    finally:
        assert backend.thread_count(before) == before
    with pytest.raises(backend.BackendError, match="0 is no thread count"):
        backend.thread_count(0)
