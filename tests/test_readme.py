"""What the README shows works as it is shown."""

import os
import re
import subprocess
import sys

import pytest

from docs.figures.demo import COMMAND
from docs.figures.page_picture import with_figures
from studies.cli.main import COMMANDS
from tests.conftest import ROOT

TEXT = (ROOT / "README.md").read_text()


def test_its_commands_and_links_exist():
    """Every `franbv X` is a command, every `make X` a target, every link into the repository a file or folder."""
    named = set(re.findall(r"\bfranbv ([a-z-]+)", TEXT))
    assert named <= {name.split()[0] for name in COMMANDS}
    assert set(re.findall(r"\bfranbv ((?:study|dataset) [a-z]+)", TEXT)) <= set(COMMANDS)
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert set(re.findall(r"^    make ([a-z-]+)", TEXT, re.MULTILINE)) <= targets
    links = [link for link in re.findall(r"\]\(([^)]+)\)", TEXT) if not link.startswith("https://")]
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_its_demo_is_what_make_demo_runs():
    """The command that draws the picture makes the same run."""
    recipe = re.search(r"^demo:.*\n\t\$\(BIN\)/franbv (.*)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert recipe is not None
    assert recipe[1].split() == COMMAND


@pytest.mark.parametrize("script", ["docs.figures.demo", "docs.figures.advice"])
def test_a_sentence_with_figures_stands_between_the_marks_of_its_script(script: str):
    """And nothing else changes when it is written anew."""
    told = with_figures(TEXT, "one line\n", script)
    assert f"<!-- of `python -m {script}` -->\none line\n<!-- end -->\n" in told
    assert told.replace("one line\n", "") == with_figures(TEXT, "", script)
    with pytest.raises(ValueError, match="README lacks"):
        with_figures(TEXT.replace("<!-- end -->", ""), "", script)


@pytest.mark.slow
def test_its_python_example_runs(tmp_path):
    """The block as it stands, in a process of its own; it prints one line."""
    (block,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    command = [sys.executable, "-W", "error", "-c", block]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert re.fullmatch(r"\d+ views, \d+ points, stopped by \w+\n", done.stdout)
