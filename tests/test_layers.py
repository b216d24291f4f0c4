"""The packages know only whom they may know, as a fresh interpreter sees it; lint-imports reads the sources instead."""

import json
import subprocess
import sys
import tomllib

import pytest

from tests.conftest import PACKAGES, ROOT

LOADED = """
import importlib, json, pathlib, sys
for path in sorted(pathlib.Path(sys.argv[1]).rglob("*.py")):
    if "authoring" not in path.parts:
        importlib.import_module(".".join(path.with_suffix("").parts).removesuffix(".__init__"))
print(json.dumps(sorted({name.split(".")[0] for name in sys.modules})))
"""


def loaded_with(package: str) -> set[str]:
    """Top-level modules that a fresh interpreter holds after importing every module of `package`."""
    command = [sys.executable, "-c", LOADED, package]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout))


@pytest.mark.parametrize(
    ("package", "foreign"),
    [
        ("franbv", {"render", "scenes", "materials", "studies", "mitsuba", "trimesh", "cv2"}),
        ("materials", {"franbv", "render", "scenes", "studies", "mitsuba"}),
        ("scenes", {"franbv", "render", "studies", "mitsuba"}),
        ("render", {"studies", "sklearn"}),
    ],
)
def test_a_package_loads_nothing_foreign(package: str, foreign: set[str]):
    """A robot computer runs franbv alone; and no layer reaches up, not even from within a function's import."""
    loaded = loaded_with(package)
    assert package in loaded
    assert loaded & foreign == set()


def test_every_package_is_shipped_linted_and_typed():
    """The five packages stand in the wheel, under the layer rules and under the type checker."""
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]
    assert set(tools["hatch"]["build"]["targets"]["wheel"]["packages"]) == set(PACKAGES)
    assert set(tools["importlinter"]["root_packages"]) == set(PACKAGES)
    assert set(tools["pyright"]["include"]) >= set(PACKAGES)
    with_modules = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests", "examples"}
    assert with_modules == set(PACKAGES)
