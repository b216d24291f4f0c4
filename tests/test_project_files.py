"""`CONTRIBUTING.md`, `CHANGELOG.md` and `CITATION.cff` say what is so."""

import re
import tomllib

import pytest
import yaml

from studies.cli.main import COMMANDS
from tests.conftest import ROOT

CHANGELOG = (ROOT / "CHANGELOG.md").read_text()
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
"""Keep a Changelog 1.1.0."""
AUTHOR_KEYS = {"given-names", "family-names", "affiliation"}


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "CHANGELOG.md"])
def test_what_it_links_and_runs_exists(name: str):
    """Links into the repository, targets of make, commands."""
    text = (ROOT / name).read_text()
    links = [link for link in re.findall(r"\]\(([^)]+)\)", text) if not link.startswith("https://")]
    assert [link for link in links if not (ROOT / link).exists()] == []
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    assert set(re.findall(r"(?:`|^    )make ([a-z-]+)", text, re.MULTILINE)) <= targets
    assert set(re.findall(r"franbv ((?:study|dataset) [a-z]+|doctor)", text)) <= set(COMMANDS)


def test_versions_are_in_order_and_the_last_is_ours():
    """Unreleased first, then the version of pyproject.toml; sections are those of Keep a Changelog."""
    heads = re.findall(r"^## \[(.*?)\](?: - (\d{4}-\d{2}-\d{2}))?$", CHANGELOG, re.MULTILINE)
    assert heads[0] == ("Unreleased", "")
    assert heads[1][0] == VERSION
    assert all(date for _, date in heads[1:])
    assert set(re.findall(r"^### (\w+)$", CHANGELOG, re.MULTILINE)) <= KINDS


def test_modules_have_moved_to_where_it_says():
    """As many new names as old ones in each row; every new one is a file, and no old one is."""
    rows = re.findall(r"^\| (`.*?) \| (.*?) \|$", CHANGELOG, re.MULTILINE)
    assert len(rows) > 10
    for before, now in rows:
        old, new = (re.findall(r"`([\w.]+)`", words) for words in (before, now))
        if now.startswith("the same in"):
            new = [f"{new[0]}.{name.rpartition('.')[2]}" for name in old]
        assert len(new) == len(old), before
        assert [name for name in new if not is_module(name)] == []
        assert [name for name in old if is_module(name)] == []


def is_module(name: str) -> bool:
    """Whether a file holds it; a folder of that name is a package."""
    return (ROOT / f"{name.replace('.', '/')}.py").exists()


def test_the_citation_is_valid():
    """What the Citation File Format 1.2.0 requires; the version is ours; nobody's identifier is made up."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert {"cff-version", "message", "title", "authors"} <= set(citation)
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == VERSION
    assert citation["license"] == "MIT"
    assert all(set(author) == {"name"} for author in citation["authors"])
    (paper,) = citation["references"]
    assert {"type", "title", "authors"} <= set(paper)
    assert all(set(author) <= AUTHOR_KEYS for author in paper["authors"])
    assert "doi" not in (ROOT / "CITATION.cff").read_text()
