"""requirements.lock holds names, versions and hashes, for everything that pyproject.toml asks for, and nothing else."""

import re
import tomllib

import pytest
from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.conftest import ROOT

PIN = re.compile(r"(?P<name>[a-z0-9][a-z0-9._-]*)==(?P<version>\S+)(?: ; (?P<marker>.+?))? \\")
HASH = re.compile(r"    --hash=sha256:[0-9a-f]{64}(?: \\)?")
NOTE = re.compile(r"    #(?: via)?(?:   ?| )[a-zA-Z0-9_. ()-]*")

LINES = (ROOT / "requirements.lock").read_text().splitlines()
PINS = [pin for line in LINES if (pin := PIN.fullmatch(line))]


def test_every_line_is_a_pin_a_hash_or_a_note():
    """So no index, no path and no account of the machine that resolved it can be in there."""
    strange = [line for line in LINES if not (PIN.fullmatch(line) or HASH.fullmatch(line) or NOTE.fullmatch(line))]
    assert strange == []


def test_every_pin_has_a_hash():
    """pip refuses a requirement without one."""
    for line, following in zip(LINES, [*LINES[1:], ""], strict=True):
        if PIN.fullmatch(line):
            assert HASH.fullmatch(following), line


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13"])
def test_the_lock_answers_the_project(python: str):
    """For each Python version on Linux: all that project, tests and figures ask for is pinned once and fits."""
    environment = {"python_version": python, "python_full_version": f"{python}.0", "sys_platform": "linux"}
    environment |= {"platform_machine": "x86_64", "extra": ""}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    here = [pin for pin in PINS if pin["marker"] is None or Marker(pin["marker"]).evaluate(environment)]
    versions = {canonicalize_name(pin["name"]): pin["version"] for pin in here}
    assert len(versions) == len(here), "pinned twice"
    for line in [*project["dependencies"], *extras["studies"], *extras["test"], *extras["docs"]]:
        wanted = Requirement(line)
        name = canonicalize_name(wanted.name)
        assert name in versions, f"{line}: not in requirements.lock; run `make lock`"
        assert wanted.specifier.contains(versions[name]), f"{line}: locked at {versions[name]}; run `make lock`"
