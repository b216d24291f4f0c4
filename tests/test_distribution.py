"""What is shipped: the wheel holds all that the code reads, and nothing tells whose machine it came from."""

import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from tests.conftest import PACKAGES, ROOT

GENERATED = {"__pycache__"}
TEXT = {
    ".py", ".md", ".toml", ".lock", ".yaml", ".yml", ".json", ".js", ".css", ".cff", ".j2", ".txt", ".csv", ".svg", "",
}  # fmt: skip
"""Suffixes of the files that a person or a script wrote."""
TOP = (
    "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", "Makefile", "pyproject.toml",
    "requirements.lock", ".gitignore",
)  # fmt: skip
HOME = re.compile(r"/(?:root|home/\w+|Users/\w+)/|[A-Z]:\\Users\\")
"""A folder of one person's machine."""


def shipped_files() -> list[Path]:
    """Every file of the five packages, relative to the root."""
    files = (path.relative_to(ROOT) for package in PACKAGES for path in (ROOT / package).rglob("*") if path.is_file())
    return sorted(path for path in files if GENERATED.isdisjoint(path.parts))


def test_the_wheel_holds_the_packages_and_their_data(tmp_path: Path):
    """Meshes, templates and scripts lie beside the modules that read them, so the wheel must hold the same files."""
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(next(tmp_path.glob("*.whl"))) as wheel:
        held = {name for name in wheel.namelist() if ".dist-info/" not in name}
        entry_points = next(name for name in wheel.namelist() if name.endswith("entry_points.txt"))
        assert "franbv = studies.cli.main:main" in wheel.read(entry_points).decode()
    assert held == {path.as_posix() for path in shipped_files()}


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="no clone: what is under version control is not known")
def test_the_source_archive_holds_all_that_its_tests_read(tmp_path: Path):
    """Tests read pages, examples, the Makefile and the lock: everything that is under version control is there."""
    command = [sys.executable, "-m", "hatchling", "build", "--target", "sdist", "--directory", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split(
        "\n"
    )
    assert {name for name in listed if name and (ROOT / name).exists()} - held == set()


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_says_that_it_is_typed(package: str):
    """PEP 561: type checkers read the annotations of an installed package only beside a `py.typed`; the wheel holds all
    shipped files, this one among them."""
    assert ROOT / package / "py.typed" in map(ROOT.joinpath, shipped_files())


@pytest.mark.parametrize("folder", [*PACKAGES, "tests", "examples", "docs", ".ci", "."])
def test_no_file_names_a_personal_folder(folder: str):
    """Paths of the machine on which a file was made are of no use on another, and say whose it was."""
    paths = map(ROOT.joinpath, TOP) if folder == "." else (ROOT / folder).rglob("*")
    files = [path for path in paths if path.is_file() and path.suffix in TEXT and GENERATED.isdisjoint(path.parts)]
    guilty = [str(path) for path in files if path != Path(__file__) and HOME.search(path.read_text(errors="replace"))]
    assert guilty == []
