"""`docs/comparison.md`: its commands can be given, and its table does not contradict itself."""

import re
from itertools import chain

import pytest

from studies.base.flags import parse
from studies.comparison.command import ComparisonCommand
from studies.comparison.links import LINKS
from studies.comparison.preset import ComparisonPreset
from studies.run.ablation import ABLATIONS
from tests.conftest import ROOT

TEXT, ROBUST_TEXT = ((ROOT / "docs" / f"{name}.md").read_text() for name in ("comparison", "fra_robust"))
ROUNDING = 0.1 + 1e-9
"""Of the difference of two figures with one decimal."""


def test_its_commands_can_be_given():
    """Presets, ablations and links by names that there are."""
    of_pages = [
        re.findall(r"^    franbv study comparison (.*?)(?:\s+#.*)?$", text, re.MULTILINE)
        for text in (TEXT, ROBUST_TEXT)
    ]
    assert [len(commands) for commands in of_pages] == [5, 2]
    for command in chain(*of_pages):
        given = parse(ComparisonCommand, command.split(), "franbv study comparison", "")
        assert given.preset in ComparisonPreset.of_ours()
        assert set(given.ablations) <= set(ABLATIONS)
        assert set(given.links) - {"all"} <= set(LINKS)


def rows():
    """Part, coverages of FRA, PB and RE, and how far FRA is ahead of the others at the end."""
    for line in TEXT.splitlines():
        cells = [cell.strip().replace("\u2212", "-") for cell in line.strip("|").split("|")]
        if len(cells) == 9 and re.fullmatch(r"[\d.]+", cells[1]):
            ahead = [float(cells[k].split(" (")[0]) for k in (4, 6)]
            yield cells[0], [float(cell) for cell in cells[1:4]], ahead


@pytest.mark.parametrize(("part", "covered", "ahead"), list(rows()), ids=[row[0] for row in rows()])
def test_its_differences_are_those_of_its_means(part, covered, ahead):
    """All methods have the same starts, so the mean of the differences is the difference of the means."""
    fra, pb, re_ = covered
    assert ahead[0] == pytest.approx(fra - pb, abs=ROUNDING)
    assert ahead[1] == pytest.approx(fra - re_, abs=ROUNDING)


def test_its_table_has_every_part():
    """Four parts and the corner."""
    assert len(list(rows())) == 5
