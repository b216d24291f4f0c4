"""`dataset show` writes one page beside the dataset, which stays as it was; the card has every figure that it must."""

import itertools
import json
import re
from pathlib import Path

import numpy as np
import pytest

import studies.dataset
from render.labels.causes import GROUPS, HOLES, LEGEND, Cause
from studies.cli.main import main
from studies.dataset.card.factors import factors, finish_shares
from studies.dataset.check.command import dataset_problems
from studies.dataset.config import Materials
from studies.dataset.format.finished_scenes import gather_scenes
from studies.dataset.format.statistics import FALSE_DEPTH
from studies.dataset.show.command import made_of


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


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("own", "own"),
        ("iron:blasted@alpha=0.3512", "iron:blasted, alpha 0.35"),
        ("brass:brushed@alpha=0.0512,0.2034", "brass:brushed, alpha 0.051 and 0.2"),
    ],
)
def test_materials_are_named_for_people(name: str, said: str):
    """Roughness to two figures, along and across the lay."""
    assert made_of(name) == said


def _hole_share(root: Path) -> float:
    """Counted pixel by pixel over the masks."""
    holes = pixels = 0
    for view in studies.dataset.open(root):
        seen = view.masks().any(axis=0)
        holes, pixels = holes + np.count_nonzero(seen & (view.depth == 0)), pixels + np.count_nonzero(seen)
    return holes / pixels


def test_shares_of_whole_images_stand_beside_those_of_objects(
    small_dataset: Path, tmp_path: Path, capsys: pytest.CaptureFixture
):
    """Counted pixel by pixel over whole depth images, in the figures and in the card."""
    depths = np.stack([view.depth for view in studies.dataset.open(small_dataset)])
    main(["dataset", "show", str(small_dataset), "--out", str(tmp_path / "page.html"), "--json"])
    figures = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert figures["image_hole_share"] == pytest.approx(np.mean(depths == 0))
    row = (small_dataset / "README.md").read_text().split("\n| **no depth** |")[1].split("\n")[0]
    assert f" {100 * np.mean(depths == 0):.1f} % | 100.0 % |" in row


def test_the_card_prints_holes_causes_and_incidence(small_dataset: Path):
    """Hole share as counted above, cause shares that add up to it, nine bins of incidence, every declared factor."""
    card = (small_dataset / "README.md").read_text()
    assert f"| **no depth** | {100 * _hole_share(small_dataset):.1f} % | 100.0 % |" in card
    shares = [float(card.split(f"\n| {group}: code")[1].split(" % | ")[1].split(" %")[0]) for group in GROUPS]
    assert sum(shares) == pytest.approx(100, abs=0.05 * len(GROUPS) + 1e-9)
    assert card.count(" deg  ") >= 9
    for factor in (
        *("Object", "Metal", "Finish", "Table", "Lamps", "Laser power [mW]", "Elevation [deg]", "Clutter"),
        *(
            "Resting pose",
            "Roll [deg]",
            "Aim beside the middle along x, y and z [m]",
            "Sides and diameters of clutter [m]",
        ),
        *("Distance of a pile's parts from the table's middle [m]", "Roughness of metals, place in the finish's range"),
    ):
        assert f"\n{factor}:\n" in card


def test_the_card_explains_itself(small_dataset: Path):
    """Every code with its meaning, K, baseline and factor of this camera, what is false, how to split, versions."""
    card = (small_dataset / "README.md").read_text()
    for cause in (Cause.MEASURED, *HOLES, *FALSE_DEPTH):
        assert f"| {int(cause)} | {LEGEND[cause].name} | {LEGEND[cause].meaning} |" in card
    assert "424 x 240 pixels: fx = fy = 213, cx = 211.5, cy = 119.5 px" in card
    for words in (
        "50 mm to the right",
        "Decimated by 8 to 53 x 30",
        "more than 5 mm",
        "split by scene",
        "numpy 2",
        "MIT",
    ):
        assert words in card
    assert not re.search(r"\b1 (views|scenes|objects|pixels|piles|things)\b", card)


def test_declared_shares_stand_beside_the_observed(small_dataset: Path):
    """Weights over their sum; parts of a range alike, elevation by the area of its ring on the sphere."""
    found = {factor.name: factor for factor in factors(gather_scenes(small_dataset))}
    assert found["arrangement"].declared == pytest.approx({"pile": 0.7, "single": 0.3})
    assert list(found["distance [m]"].declared.values()) == pytest.approx([1 / 8] * 8)
    edges = np.sin(np.radians(np.linspace(35, 70, 9)))
    rings = [(b - a) / (edges[-1] - edges[0]) for a, b in itertools.pairwise(edges)]
    assert list(found["elevation [deg]"].declared.values()) == pytest.approx(rings)
    assert sum(found["aim beside the middle along x, y and z [m]"].levels.values()) == 4 * 3


def test_a_finish_that_a_metal_cannot_have_is_not_declared_for_it():
    """Gold grows no oxide: of gold and iron alike, each oxidised as often as polished, half of iron is oxidised."""
    materials = Materials(
        metals={"gold": 1, "iron": 1}, finishes={"oxidised": 1, "polished": 1}, non_metals={"rubber": 1}
    )
    assert finish_shares(materials) == pytest.approx({"oxidised": 0.25, "polished": 0.75})


def test_a_metal_of_the_user_has_its_own_finishes():
    """One without an oxide cannot be oxidised: all of it is polished, whatever the weights."""
    steel = {"kind": "metal", "n": 3.0, "k": 4.5, "valid_nm": (800, 900), "source": "a lab"}
    materials = Materials(
        metals={"my_steel": 1},
        finishes={"oxidised": 1, "polished": 1},
        non_metals={"rubber": 1},
        user={"my_steel": steel},
    )
    assert finish_shares(materials) == pytest.approx({"oxidised": 0.0, "polished": 1.0})


def test_showing_what_is_no_dataset(tmp_path: Path, capsys: pytest.CaptureFixture):
    """Exit status 2, one line."""
    assert main(["dataset", "show", str(tmp_path)]) == 2
    assert "holds no dataset.json" in capsys.readouterr().err
