"""The report of a sensitivity study: self-contained, silent, every figure present, and true to the stored counts."""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from materials.catalog import metal_names
from render.labels.causes import HOLES
from studies.base.console import JSON_SCHEMA
from studies.base.numbers_as_text import percent
from studies.cli.main import main
from studies.sensitivity.columns import cause_column
from studies.sensitivity.plan import read_plan
from studies.sensitivity.report.page import rebuild
from studies.sensitivity.report.tables import dot_table
from studies.sensitivity.tables import gather_tables, main_rows, of_own_dots, study_summary
from studies.sensitivity.trust import angle_words, distrusts, metal_words, surface
from tests.studies.browser import CHROMIUM, visit
from tests.studies.sensitivity.synthetic_study import ANGLES, FINISHES, write_study

FIGURES = 9
"""Two depth maps, detection, recovery, shares against angle, roughness, causes, true incidence, recovery views."""
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A made-up study in the amounts of the full preset, with its report."""
    out = tmp_path_factory.mktemp("study")
    write_study(out)
    rebuild(out)
    return out


@pytest.mark.browser
@needs_browser
def test_page_is_silent_offline_and_fits(study: Path, tmp_path: Path):
    """No console message, no request; at 1280 px nothing sticks out to the right: the page's outermost 20 columns hold
    its ground colour alone."""
    seen = visit(study / "report.html", tmp_path)
    assert seen.console == []
    assert seen.requests == []
    visit(study / "report.html", tmp_path, tmp_path / "page.png", (1280, 9000))
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert picture is not None
    assert picture.shape[1] == 1280
    assert len(np.unique(picture[:, -20:].reshape(-1, 3), axis=0)) == 1
    assert len(np.unique(picture[:, 100:1180].reshape(-1, 3), axis=0)) > 200


def test_page_refers_to_nothing_outside_itself(study: Path):
    """No attribute, style rule or import points anywhere but into the page."""
    html = (study / "report.html").read_text()
    places = re.findall(r'(?:src|href|action|poster)="([^"]*)"', html) + re.findall(r"url\(([^)]*)\)", html)
    assert places
    assert all(place.startswith(("data:", "#")) for place in places)
    assert "@import" not in html
    assert not re.search(r"https?://", html)


def test_every_figure_and_every_cell_is_there(study: Path):
    """Nine figures; in the map of missing depth a cell per material, angle and distance: 12 metals x 6 finishes x 8
    angles x 2 distances, and two more at a third distance, for the lights."""
    html = (study / "report.html").read_text()
    assert html.count('class="figure"') == FIGURES
    depth = html[html.index('id="depth"') : html.index('id="angle"')]
    missing = depth[: depth.index("False depth")]
    assert missing.count('class="heat"') == len(metal_names()) * len(FINISHES) * len(ANGLES) * 2 + 2
    for name in (*FINISHES, "gold", "tungsten", "stainless ferritic"):
        assert f">{name}</text>" in missing


def test_text_from_outside_is_escaped(study: Path):
    """A title with markup in it stays text."""
    html = (study / "report.html").read_text()
    assert "Made-up &lt;study&gt; &amp; more" in html
    assert "<study>" not in html


def test_cell_says_what_was_counted(study: Path):
    """The number in a cell is the pooled share of the stored counts, added up here from the folders themselves."""
    holes = pixels = 0
    for file in (study / "cases").glob("*/result.json"):
        for row in json.loads(file.read_text())["views"]:
            if (row["material"], row["polar_deg"], row["distance_m"]) == ("stainless_austenitic:polished", 20.0, 0.3):
                holes += sum(row[cause_column(cause)] for cause in HOLES)
                pixels += row["part_pixels"]
    html = (study / "report.html").read_text()
    words = f"stainless_austenitic:polished, 20 deg: {100 * holes / pixels:.1f} % (5 views, {pixels:,} part pixels)"
    assert words in html


def test_widths_of_the_dots_have_a_table_and_nothing_else(study: Path):
    """A row a width, its shares added up here from the folders; the sensor's own are the cases of the same view. Views
    with other dots count neither in the headline nor in a cell."""
    shares = {}
    for file in (study / "cases").glob("*/result.json"):
        for row in json.loads(file.read_text())["views"]:
            if (row["subject"], row["material"], row["polar_deg"], row["distance_m"], row["seed"]) == (
                "plate", f"{metal_names()[0]}:mirror", 20.0, 0.3, 0,
            ):  # fmt: skip
                shares[row["dot_fwhm_px"]] = sum(row[cause_column(c)] for c in HOLES) / row["part_pixels"]
    assert set(shares) == {None, 3.7, 5.0}
    tables = gather_tables(study, read_plan(study).cases)
    table = dot_table(tables.views)
    assert [row[0] for row in table.rows] == ["the sensor's own", "3.7 px wide", "5 px wide"]
    column = table.head.index("mirror: no depth / false")
    assert [row[column].split(" / ")[0] for row in table.rows] == [percent(shares[w]) for w in (None, 3.7, 5.0)]
    assert all(row["dot_fwhm_px"] is None for row in main_rows(tables))
    assert "3.7 px wide" in (study / "report.html").read_text()
    assert dot_table(of_own_dots(tables.views)).rows == []


def test_rebuilt_report_is_the_same(study: Path, capsys: pytest.CaptureFixture):
    """`franbv report` on the folder gives the same page and tables, and touches no case."""
    before = {path: path.read_bytes() for path in study.rglob("*") if path.is_file()}
    assert main(["report", str(study), "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1]) == {
        "schema": JSON_SCHEMA,
        "reports": [str(study / "report.html")],
    }
    assert {path: path.read_bytes() for path in study.rglob("*") if path.is_file()} == before


def test_tables_carry_their_meaning(study: Path):
    """Every column of every table says what it holds."""
    for name in ("views", "incidence", "recovery_views"):
        schema = pq.read_schema(study / f"{name}.parquet")
        assert all((schema.field(column).metadata or {}).get(b"meaning") for column in schema.names)


def test_unfinished_study_says_so(tmp_path: Path):
    """A folder in which a case is missing yields a report of the others that tells how many are measured."""
    write_study(tmp_path, ("iron",), ("polished",))
    whole = len(read_plan(tmp_path).cases)
    (tmp_path / "cases" / f"{0:016x}" / "result.json").unlink()
    (tmp_path / "cases" / f"{0:016x}").rmdir()
    html = rebuild(tmp_path).read_text()
    assert f"{whole - 1} of {whole} cases are measured so far" in html


def test_damaged_plan_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture):
    """Exit status 2, and the mend."""
    (tmp_path / "study.json").write_text("{")
    assert main(["report", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "give the study's command again" in said


def test_summary_counts_a_shared_case_once(tmp_path: Path):
    """A case that two sweeps asked for has rows for both in the tables, but is summed up once."""
    write_study(tmp_path, ("iron",), ("polished",))
    cases = read_plan(tmp_path).cases
    once = study_summary(gather_tables(tmp_path, cases))
    twice = gather_tables(tmp_path, (*cases, ("again", cases[0][1])))
    assert study_summary(twice) == once
    assert len(twice.views) == len(gather_tables(tmp_path, cases).views) + 1


def test_list_of_distrust_names_what_fails(study: Path):
    """Polished surfaces of the made-up study lose detector and depth, blasted ones nothing: each rule that is broken
    stands there, with the counts of combinations, and no other."""
    main_views = main_rows(gather_tables(study, read_plan(study).cases))
    found = distrusts(main_views)
    assert {distrust.surface for distrust in found if distrust.subject == "plate"} >= {"mirror", "polished"}
    assert not any(distrust.surface == "blasted" for distrust in found)
    for distrust in found:
        cells = {
            (row["metal"], row["polar_deg"])
            for row in main_views
            if (row["subject"], surface(row)) == (distrust.subject, distrust.surface)
        }
        assert 0 < distrust.failing <= distrust.measured == len(cells)


def test_combinations_in_words():
    """Neighbouring angles run together, few metals are named, many are named by those left out."""
    assert angle_words([0, 20, 40], [0, 20, 40, 60]) == "0 to 40 deg"
    assert angle_words([0, 40, 60], [0, 20, 40, 60]) == "0 and 40 to 60 deg"
    assert angle_words([0, 20], [0, 20]) == "both angles"
    metals = ["iron", "gold", "silver", "copper", "stainless_ferritic", "tungsten"]
    assert metal_words(metals[:2], metals) == "iron, gold"
    assert metal_words(metals[:5], metals) == "5 of 6 metals (not tungsten)"
    assert metal_words(metals, metals) == "all 6 metals"
    assert metal_words([None], [None]) == ""
