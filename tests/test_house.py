"""The house's own rules beside the import rules: rooms of a size that a person takes in, one home for every name."""

import ast
from collections import Counter, defaultdict
from pathlib import Path

from tests.conftest import PACKAGES, ROOT

MOST_LINES = 300
"""Of a module: what is longer holds two concepts."""
MOST_MODULES = 20
"""In a folder."""
PROTOCOL = {"run", "rebuild"}
"""What commands and reports are asked for by name, one in each."""


def modules() -> list[Path]:
    """All modules of ours."""
    return [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]


def public_names(path: Path) -> set[str]:
    """What a module defines at its top, privately meant names left out."""
    names: set[str] = set()
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        names |= {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}
    return {name for name in names if not name.startswith("_")}


def test_modules_are_short():
    """Nobody scrolls for a minute to learn what a file holds."""
    long = {str(path.relative_to(ROOT)): n for path in modules() if (n := path.read_text().count("\n")) > MOST_LINES}
    assert long == {}


def test_folders_hold_few_modules():
    """A face (`__init__.py`) is no module."""
    counts = Counter(path.parent.relative_to(ROOT) for path in modules() if path.name != "__init__.py")
    assert {str(folder): n for folder, n in counts.items() if n > MOST_MODULES} == {}


def test_every_public_name_has_one_home():
    """A name that stands in two modules means two things, or the same thing twice."""
    homes = defaultdict(list)
    for path in modules():
        for name in public_names(path) - PROTOCOL:
            homes[name].append(str(path.relative_to(ROOT)))
    assert {name: places for name, places in homes.items() if len(places) > 1} == {}


def test_tests_mirror_the_rooms():
    """A test of a room stands in the folder of the same name; folders without a counterpart are tests of their own."""
    own = {"benchmarks", "physics", "corpus", "judges"}
    folders = {path.parent.relative_to(ROOT / "tests") for path in (ROOT / "tests").rglob("test_*.py")}
    strange = {str(folder) for folder in folders if folder.parts and folder.parts[0] not in own}
    assert {folder for folder in strange if not (ROOT / folder).is_dir()} == set()
