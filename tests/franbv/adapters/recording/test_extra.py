"""The extra `record` brings what the code of recordings imports, and no more than that need be looked for."""

import ast
import sys
import tomllib
from importlib.metadata import packages_distributions

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import PACKAGES, ROOT

ROOM = ROOT / "franbv" / "adapters" / "recording"


def imported() -> set[str]:
    """Names of the packages of others that modules of the room import, anywhere in them."""
    names: set[str] = set()
    for path in ROOM.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                names.add(node.module or "")
    return {name.split(".")[0] for name in names} - sys.stdlib_module_names - set(PACKAGES)


def test_the_extra_has_what_is_imported():
    """What comes along with another package may be gone with its next version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    asked = [*project["dependencies"], *project["optional-dependencies"]["record"]]
    brought = {canonicalize_name(Requirement(line).name) for line in asked}
    homes = packages_distributions()
    wanted = {name: {canonicalize_name(home) for home in homes[name]} for name in imported()}
    assert {name: found for name, found in wanted.items() if not found & brought} == {}
    assert {"apsw", "mcap", "rosbags", "zstandard"} <= wanted.keys()  # so that the search finds anything
