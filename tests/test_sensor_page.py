"""`docs/sensor.md`: what it shows and names is there, and the scripts that draw it can be loaded."""

import importlib
import re

import pytest

from tests.conftest import ROOT

DOCS = ROOT / "docs"
TEXT = (DOCS / "sensor.md").read_text()
COMMANDS = re.compile(r"python -m docs\.figures\.(\w+)")
SCRIPTS = sorted(path.stem for path in (DOCS / "figures").glob("*.py"))


def test_its_figures_exist_and_are_small():
    """Every picture of the page is in the repository and below 150 kB; none lies there that no page shows."""
    shown = set(re.findall(r"!\[[^\]]+\]\(([^)]+)\)", TEXT))
    assert shown
    for name in shown:
        assert 0 < (DOCS / name).stat().st_size < 150_000, name
    drawn = {f"figures/{path.name}" for path in (DOCS / "figures").glob("*.png")}
    others = {
        "figures/advice.png",
        "figures/demo.png",
        "figures/mitigations.png",
        "figures/objects.png",
        "figures/robust.png",
    }  # the README's two, the advice's, the comparison's, fra-robust's
    assert drawn - shown <= others


def test_files_and_commands_that_it_names_exist():
    """Files of the repository in backticks, and the scripts that it says print the numbers."""
    named = re.findall(r"`((?:render|materials|scenes|tests)/[\w/]+\.py)`", TEXT)
    assert named
    assert [name for name in named if not (ROOT / name).exists()] == []
    others = {
        "drawing",
        "page_picture",
        "advice",
        "advice_ranking",
        "mitigations",
        "replayed_models",
        "demo",
        "objects",
        "delays",
        "repetitions",
        "monitored",
    }  # named on other pages
    of_robust = {name for name in SCRIPTS if name.startswith("robust")} | {"unseen_parts"}
    assert set(COMMANDS.findall(TEXT)) == set(SCRIPTS) - others - of_robust
    assert set(COMMANDS.findall((DOCS / "fra_robust.md").read_text())) == of_robust


@pytest.mark.parametrize("script", SCRIPTS)
def test_its_scripts_load(script: str):
    """A script that no longer fits the code it draws fails at import, not when somebody wants the figure."""
    assert importlib.import_module(f"docs.figures.{script}")
