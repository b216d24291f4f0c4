"""The page of a study of mitigations: silent, without network, true to the numbers; tables and summary beside it."""

import json
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from studies.advise.paired_shares import SurfaceShares
from studies.advise.search import Tried
from studies.base.stored_preset import write_preset_file
from studies.mitigations.cases import MitigationCase, mitigation_cases
from studies.mitigations.command import MITIGATIONS, MITIGATIONS_FORMAT, rebuild
from studies.mitigations.evaluation import MITIGATIONS_SUMMARY
from studies.sensitivity.measurement import CASES, RESULT
from tests.studies.browser import CHROMIUM, visit
from tests.studies.mitigations.made_up_study import measured, preset

LASER, OFF, TILT, SPRAY = ("laser", "60 mW"), ("lamps", "off"), ("tilt of the part", "30 deg"), ("spray", "matte")
FILLED, FILMS = ("filters", "hole filling, largest disparity"), ("polarisers", "on the imagers")


def write_made_up_case(out: Path, case: MitigationCase, tried: list[Tried]) -> None:
    """As a worker would have left it."""
    rows = [{"remedy": name_of(one), "views": views_of(one.shares)} for one in tried]
    folder = out / CASES / case.digest
    folder.mkdir(parents=True)
    (folder / RESULT).write_text(json.dumps({"counts": rows}))


def name_of(tried: Tried) -> list[str]:
    """Factor and level; nothing of the camera as it is set."""
    return [name for remedy in tried.remedies for name in (remedy.factor.name, remedy.level.name)]


def views_of(shares: SurfaceShares) -> list[list[dict]]:
    """Counts by pose and seed."""
    areas = zip(shares.seen, shares.right, shares.false, strict=True)
    return [
        [{"seen": s, "right": r, "false": f, "error_mm": 1.0} for s, r, f in zip(*view, strict=True)] for view in areas
    ]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two metals and a plastic on two coupons, one case short: lamps off win on polished surfaces, tilt on the plastic,
    spray alone helps on blasted aluminium, blasted brass needs nothing."""
    out = tmp_path_factory.mktemp("mitigations")
    asked = preset(coupons=("upright_cylinder", "plate"), materials=("black_plastic",), title="Made <up>")
    write_preset_file(out / MITIGATIONS, asked, MITIGATIONS_FORMAT)
    for case in mitigation_cases(asked)[:-1]:
        wins = {"polished": (0.5, 0.2, 0.0, 0.4), "blasted": (0.5, 0.0, 0.0, 0.3), None: (0.5, 0.1, 0.2, 0.4)}
        base, off, tilt, spray = (0.97, 0.0, 0.0, 0.0) if case.material == "brass:blasted" else wins[case.finish]
        gains = {LASER: -0.05, OFF: off, TILT: tilt, FILLED: (0.1, 0.3), FILMS: 0.001, SPRAY: spray}
        write_made_up_case(out, case, measured(base, gains, 0.0 if base > 0.9 else 0.1))
    return rebuild(out)


def test_the_page_says_what_was_found(page: Path):
    """Map, verdicts, polarisers, what is missing; titles are escaped."""
    html = page.read_text().replace("\u00a0", " ")
    for words in (
        "Made &lt;up&gt;", "9 of 10 cases are measured so far", ">lamps off</text>", ">tilt 30 deg</text>",
        "only spray", "nothing needed", "right nearly everywhere", "wrong nearly everywhere", "83.1 %", "filters: hole",
        "Switch the lamps off", "In 5 of 9 cases a remedy helps",
    ):  # fmt: skip
        assert words in html
    assert html.count('role="img"') == 3  # a map for each coupon, and the verdicts
    assert "Few poses" not in html


def test_tables_and_summary_hold_the_same_figures(page: Path):
    """A view of each remedy at each pose, a row of each remedy on each case, a cell of the map for each case."""
    out = page.parent
    views = pq.read_table(out / "views.parquet").to_pylist()
    assert len(views) == 9 * 7 * 6
    rows = pq.read_table(out / "remedies.parquet").to_pylist()
    assert len(rows) == 9 * 7
    assert sum(row["wins"] for row in rows) == 9
    summary = json.loads((out / MITIGATIONS_SUMMARY).read_text())
    assert len(summary["map"]) == summary["cases"] == 9
    assert {cell["winner"] for cell in summary["map"]} == {"lamps: off", "tilt of the part: 30 deg", None}
    winning = {(row["case"], f"{row['factor']}: {row['level']}") for row in rows if row["wins"]}
    assert winning == {(cell["case"], cell["winner"] or "as set: as set") for cell in summary["map"]}
    (laser,) = [one for one in summary["common_advice"] if one["words"] == "Lower the laser"]
    assert laser["verdict"] == "wrong nearly everywhere"
    assert laser["gain"]["value"] == pytest.approx(-0.05)


def test_rebuilding_changes_no_byte(page: Path):
    """From the folder alone."""
    before = {path: path.read_bytes() for path in page.parent.glob("*.*")}
    rebuild(page.parent)
    assert {path: path.read_bytes() for path in page.parent.glob("*.*")} == before


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_page_is_silent_offline_and_fits_its_width(page: Path, tmp_path: Path):
    """No console message, no request; at 1280 px nothing sticks out to the right."""
    seen = visit(page, tmp_path)
    assert seen.console == []
    assert seen.requests == []
    visit(page, tmp_path, tmp_path / "page.png", (1280, 4200))
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert picture is not None
    assert len(np.unique(picture[:, -20:].reshape(-1, 3), axis=0)) == 1
