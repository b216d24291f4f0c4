"""The report: self-contained, silent on the console, every figure present, and true to the stored numbers."""

import errno
import json
import os
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

from franbv.projection import silhouette
from studies.base.latest import point_latest
from studies.cli.main import main
from studies.drawing.svg import Scale, element, round_ticks
from studies.drawing.templates import unbroken
from studies.run.report.page import report_html, write_report
from studies.run.report.scene_payload import UNIT, packed
from studies.run.report.strip import projected_ellipses
from studies.run.sentences import run_paragraph
from studies.run.stored_run import StoredRun, stored_runs
from tests.studies.browser import CHROMIUM, visit
from tests.studies.run.analytic_ball import reconstruct_ball

needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished reconstruction of an analytic ball."""
    folder = tmp_path_factory.mktemp("ball")
    reconstruct_ball(folder)
    return folder


@pytest.mark.browser
@needs_browser
def test_page_is_silent_offline_and_alive(case: Path, tmp_path: Path):
    """No console message, no request; the script ran: it wrote the last acquisition's numbers under the scene."""
    seen = visit(case / "report.html", tmp_path)
    assert seen.console == []
    assert seen.requests == []
    rows = StoredRun(case).rows
    caption = re.search(r'class="scene-caption">([^<]*)<', seen.dom)
    assert caption is not None
    assert caption[1].startswith(f"Acquisition {len(rows)} of {len(rows)}: ")
    assert f"Coverage {100 * rows[-1]['coverage_map_5mm']:.1f} %" in caption[1]


@pytest.mark.browser
@needs_browser
def test_browser_check_sees_errors_and_requests(tmp_path: Path):
    """The check itself can fail: a page with a broken script and a remote picture is caught at both."""
    page = tmp_path / "bad.html"
    page.write_text('<img src="http://example.invalid/x.png"><script>throw new Error("broken")</script>')
    seen = visit(page, tmp_path)
    assert any("broken" in line for line in seen.console)
    assert seen.requests == ["http://example.invalid/x.png"]


@pytest.mark.browser
@needs_browser
def test_scene_is_drawn(case: Path, tmp_path: Path):
    """The canvas shows the surface's two colours: covered (pale blue) and, the foot of the ball, not covered (red)."""
    visit(case / "report.html", tmp_path, tmp_path / "page.png")
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert picture is not None
    blue, green, red = (picture[..., k].astype(int) for k in range(3))
    assert np.count_nonzero((red > 180) & (green < 130) & (blue < 130)) > 20
    assert picture.shape[1] == 1280


def test_page_refers_to_nothing_outside_itself(case: Path):
    """No attribute, style rule or import points anywhere but into the page."""
    html = (case / "report.html").read_text()
    places = re.findall(r'(?:src|href|action|poster)="([^"]*)"', html) + re.findall(r"url\(([^)]*)\)", html)
    assert places
    assert all(place.startswith(("data:", "#")) for place in places)
    assert "@import" not in html
    assert "http://" not in html
    assert "https://" not in html


def test_every_figure_and_every_acquisition_is_there(case: Path):
    """One strip per acquisition with four pictures, the coverage curve, two timing figures, the scene's data."""
    html = (case / "report.html").read_text()
    rows = StoredRun(case).rows
    assert html.count('<article class="strip"') == len(rows)
    assert html.count('class="picture"') == 4 * len(rows)
    assert html.count('class="figure"') == 3
    assert html.count("<circle") == len(rows)
    assert {row["kind"] for row in rows} == {"first", "nbv", "recovery"}
    data = re.search(r'id="scene-data">(.*?)</script>', html, re.DOTALL)
    assert data is not None
    assert len(json.loads(data[1])["views"]) == len(rows)


def test_text_from_outside_is_escaped(case: Path):
    """A title with markup in it stays text: the ball's is `Ball <mirror> & table`."""
    html = (case / "report.html").read_text()
    assert "Ball &lt;mirror&gt; &amp; table" in html
    assert "<mirror>" not in html


def test_headline_says_what_the_table_says(case: Path):
    """The words carry the last row's coverage of the map and the raw one, the count of rows and of recoveries."""
    stored = StoredRun(case)
    words = run_paragraph(stored.run, stored.timings)
    assert f"{100 * stored.rows[-1]['coverage_map_5mm']:.1f} % of the visible surface" in words
    assert f"{len(stored.rows)} acquisitions" in words
    assert f"{100 * stored.rows[-1]['coverage_5mm']:.1f} %" in words
    assert "\n" not in words


def test_rebuilt_report_is_the_same(case: Path):
    """The report is a function of the stored files: rebuilding gives the same page, and changes no other file."""
    before = {path: path.read_bytes() for path in case.rglob("*") if path.is_file()}
    write_report(case)
    assert {path: path.read_bytes() for path in case.rglob("*") if path.is_file()} == before
    assert report_html(StoredRun(case)).encode() == before[case / "report.html"]


def test_drawn_ellipses_are_the_silhouette(case: Path):
    """The union of the drawn ellipses, filled at pixel centres, is I_o, which is found by casting rays instead."""
    stored = StoredRun(case)
    for k in range(3):
        view = stored.view(k)
        h, w = view.invalid.shape
        v, u = np.mgrid[:h, :w]
        inside = np.zeros((h, w), bool)
        for mean, shape, _ in projected_ellipses(view):
            offset = np.stack([u, v], axis=-1) - mean
            inside |= np.einsum("hwi,ij,hwj->hw", offset, np.linalg.inv(shape), offset) <= 1
        assert np.array_equal(inside, silhouette(view.ellipsoids, view.intrinsics, view.pose))
        assert np.array_equal(inside, view.silhouette)


def test_packed_lengths_come_back(case: Path):
    """Little-endian int16 counts of 0.1 mm: a decoder written from that sentence gives the lengths to 0.05 mm."""
    import base64

    lengths = np.array([0.0, 0.12345, -0.3, 2.0])
    counts = np.frombuffer(base64.b64decode(packed(lengths)), "<i2")
    assert np.abs(counts * UNIT - lengths).max() <= UNIT / 2


def test_ticks_are_round_and_inside():
    """Steps of 1, 2 or 5 times a power of ten, all within the axis."""
    assert round_ticks(0, 100, 5) == [0, 20, 40, 60, 80, 100]
    assert round_ticks(0, 0.7, 4) == [0, 0.2, 0.4, 0.6]
    assert round_ticks(1, 23, 12) == [2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22]
    assert Scale(0, 10, 100, 200)(2.5) == 125


def test_svg_escapes_and_names():
    """Text and attributes are escaped, `klass` and underscores become HTML's names."""
    drawn = str(element("text", "a < b", klass='x"y', stroke_width=1.50))
    assert drawn == '<text class="x&#34;y" stroke-width="1.5">a &lt; b</text>'


def test_units_stay_on_the_line():
    """A number and its unit are joined by a no-break space."""
    assert unbroken("63.6 % in 131 s, 5.2 mm") == "63.6\u00a0% in 131\u00a0s, 5.2\u00a0mm"


def _report_line(capsys: pytest.CaptureFixture[str], folder: Path) -> str:
    """What `franbv report` complains of: one line."""
    assert main(["report", str(folder)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    return err


def _out_folder(case: Path, out: Path) -> Path:
    """As `franbv reconstruct --out` leaves it: the case, and links to it and to some of its files."""
    folder = Path(shutil.copytree(case, out / "0123456789abcdef"))
    point_latest(folder, ["run.json", "report.html"])
    return out


@pytest.mark.parametrize("how", ["parent", "out", "links followed"])
def test_whole_results_are_found_wherever_they_stand(case: Path, tmp_path: Path, how: str):
    """A folder of several --out folders; one of them; a copy of one in which links became files (`scp -r`, zip)."""
    out = _out_folder(case, tmp_path / "runs" / "ball")
    if how == "links followed":
        out = Path(shutil.copytree(out, tmp_path / "copy", symlinks=False))
        assert (out / "run.json").is_file()
        assert not (out / "run.json").is_symlink()
    given = out.parent if how == "parent" else out
    assert stored_runs(given) == [out / "0123456789abcdef"]
    assert main(["report", str(given)]) == 0


def test_a_missing_file_is_named_and_nothing_is_to_be_removed(case: Path, tmp_path: Path, capsys):
    """What is there may be all that is left of the results."""
    copy = Path(shutil.copytree(case, tmp_path / "copy"))
    (copy / "surface.npz").write_bytes((copy / "surface.npz").read_bytes()[:100])
    line = _report_line(capsys, copy)
    assert "surface.npz: cannot be read" in line
    assert "copy the case whole" in line
    assert "remove" not in line


@pytest.mark.parametrize(("number", "words"), [(errno.ENOSPC, "the disk is full"), (errno.EROFS, "read-only")])
def test_a_disk_that_takes_no_report_is_told_apart(
    case: Path, tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch, number: int, words: str
):
    """The results are whole: only the page has no place."""
    copy = Path(shutil.copytree(case, tmp_path / "copy"))

    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number), str(copy / "report.html"))

    monkeypatch.setattr("studies.base.atomic_file.os.replace", fail)
    line = _report_line(capsys, copy)
    assert words in line
    assert "damaged" not in line
    assert "remove" not in line


def test_results_of_an_older_version_are_called_so(case: Path, tmp_path: Path, capsys):
    """Before formats were numbered, `run.json` had none."""
    copy = Path(shutil.copytree(case, tmp_path / "copy"))
    stored = json.loads((copy / "run.json").read_text())
    del stored["format"]
    (copy / "run.json").write_text(json.dumps(stored))
    assert "was written by an older or newer version (format 1, here" in _report_line(capsys, copy)


def test_our_own_faults_are_not_called_the_users(case: Path, monkeypatch: pytest.MonkeyPatch):
    """A figure that breaks on sound results is a fault of ours: it is no damage, and it shows where it is."""

    def broken(*_: object) -> None:
        raise KeyError("no_such_column")

    monkeypatch.setattr("studies.run.report.page.coverage_figure", broken)
    with pytest.raises(KeyError, match="no_such_column"):
        main(["report", str(case)])
