"""`dataset show` writes one page beside the dataset, which stays as it was; the card has every figure that it must."""

import json
from pathlib import Path

import numpy as np
import pytest

import studies.dataset
from render.causes import GROUPS
from studies.cli import main
from studies.dataset.check import dataset_problems


def test_the_page_stands_beside_the_dataset(small_dataset: Path, capsys: pytest.CaptureFixture):
    """Nothing is added to the folder, nothing is loaded from elsewhere, and the shares are those of the images."""
    assert main(["dataset", "show", str(small_dataset), "--views", "2", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    page = Path(figures["page"])
    assert page == small_dataset.with_name("small.html")
    text = page.read_text()
    assert "http://" not in text.replace("http://www.w3.org", "")
    assert text.count('<article class="sheet">') == 2
    assert dataset_problems(small_dataset)[1] == []
    assert figures["hole_share"] == pytest.approx(_hole_share(small_dataset))


def _hole_share(root: Path) -> float:
    """Counted pixel by pixel over the masks."""
    holes = pixels = 0
    for view in studies.dataset.open(root):
        seen = view.masks().any(axis=0)
        holes, pixels = holes + np.count_nonzero(seen & (view.depth == 0)), pixels + np.count_nonzero(seen)
    return holes / pixels


def test_the_card_prints_holes_causes_and_incidence(small_dataset: Path):
    """Hole share as counted above, cause shares that add up to it, nine bins of incidence, every declared factor."""
    card = (small_dataset / "README.md").read_text()
    assert f"| **no depth** | {100 * _hole_share(small_dataset):.1f} % | 100.0 % |" in card
    groups = [group for group in GROUPS if f"\n| {group} | " in card]
    assert set(GROUPS) == set(groups)
    shares = [float(card.split(f"\n| {group} | ")[1].split(" % | ")[1].split(" %")[0]) for group in groups]
    assert sum(shares) == pytest.approx(100, abs=0.05 * len(groups) + 1e-9)
    assert card.count(" deg  ") >= 9
    for factor in ("Object", "Metal", "Finish", "Table", "Lamps", "Laser power [mW]", "Elevation [deg]", "Clutter"):
        assert f"\n{factor}:\n" in card


def test_showing_what_is_no_dataset(tmp_path: Path, capsys: pytest.CaptureFixture):
    """Exit status 2, one line."""
    assert main(["dataset", "show", str(tmp_path)]) == 2
    assert "holds no dataset.json" in capsys.readouterr().err
