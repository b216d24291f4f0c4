"""`franbv safe-angles`: bad input in one line, no view measured twice, the folder all that a page needs; a real run."""

import contextlib
import json
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from franbv.surfaces.safe_angles import read_safe_angles
from studies.cli.main import main
from studies.safe_angles import command
from studies.safe_angles.settings import SafeAnglesSettings, check_settings
from studies.safe_angles.table import SAFE_ANGLES
from studies.safe_angles.views import angle_views, poses_around
from studies.sensitivity.measurement import CASES, CaseTask, write_case
from studies.work.executor import LocalExecutor
from studies.work.workers import Failure, Job
from tests.studies.safe_angles.made_up_views import counted

PART = ["--part", "A1"]
IRON = ["--material", "iron:blasted"]


class Bench(LocalExecutor):
    """Stands in for the workers: writes made-up counts, and remembers whose."""

    def __init__(self, pixels: int = 1000) -> None:
        super().__init__(1)
        object.__setattr__(self, "pixels", pixels)
        object.__setattr__(self, "done", [])

    def run(self, stages: Sequence[Sequence[Job]], already_done: int = 0, tell: object = None) -> list[Failure]:
        """Views only; nobody needs the twins."""
        for job in stages[-1]:
            task: CaseTask = job.argument
            write_case(task, lambda view, twins, scene_of: counted(view, self.pixels))
            self.done.append(task.config)
        return []


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    """The command works with it instead of processes."""
    stand_in = Bench()

    @contextlib.contextmanager
    def executor_of(flags: object) -> Iterator[Bench]:
        yield stand_in

    monkeypatch.setattr(command, "executor_of", executor_of)
    return stand_in


def said(capsys: pytest.CaptureFixture[str], args: list[str], status: int) -> str:
    """What the command prints to the stream of its exit status."""
    assert main(["safe-angles", *args]) == status
    printed = capsys.readouterr()
    return printed.err if status else printed.out


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ([*PART, "--material", "irn:blasted"], "unknown material; did you mean iron"),
        ([*PART, "--material", "iron:blsted"], "unknown finish blsted; did you mean blasted"),
        ([*PART], "no material to make a card of; give --material"),
        ([*IRON], "nothing to look at; give either --part"),
        (["--part", "A9", *IRON], "part A9: there is none"),
        (["--part", "plate", "--material", "own"], "a coupon needs one material"),
        (["--mesh", "nowhere.stl", "--units", "mm", *IRON], "nowhere.stl"),
        ([*PART, *IRON, "--share", "1.2"], "--share 1.2: is no share between 0 and 1"),
        ([*PART, *IRON, "--confidence", "0"], "--confidence 0: is no share between 0 and 1"),
        ([*PART, *IRON, "--poses", "0"], "`poses` = 0: input should be greater than or equal to 1"),
        ([*PART, *IRON, "--most-polar", "95"], "`most_polar` = 95.0: input should be less than or equal to 85"),
        ([*PART, *IRON, "--distance", "0.01"], "`distance` = 0.01: input should be greater than or equal to 0.15"),
        ([*PART, *IRON, "--lamps", "candle"], "candle"),
        ([*PART, *IRON, "--sensor.roll-deg", "90"], "--sensor.roll-deg 90: each view is taken at several rolls"),
        ([*PART, *IRON, "--sensor.profile", "1x1"], "1x1"),
    ],
)
def test_bad_input_is_one_line(args: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Exit status 2, the thing named, and nothing written."""
    line = said(capsys, [*args, "--out", str(tmp_path / "out")], 2)
    assert words in line
    assert line.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_part_that_no_view_shows_is_named(tmp_path: Path, bench: Bench, capsys: pytest.CaptureFixture[str]):
    """Without a pixel there is no share of anything."""
    object.__setattr__(bench, "pixels", 0)
    line = said(capsys, [*PART, *IRON, "--poses", "2", "--out", str(tmp_path)], 2)
    assert "A1: no view shows a pixel of it; choose a --distance" in line


def test_no_view_is_measured_twice(tmp_path: Path, bench: Bench, capsys: pytest.CaptureFixture[str]):
    """Two poses at two rolls; asked again none; of three poses the third; of a further material its own; of another
    roll that one; what is asked of the share changes no view."""
    asked = [*PART, *IRON, "--out", str(tmp_path)]
    for more, new in (
        (["--poses", "2"], 4),
        (["--poses", "2"], 0),
        (["--poses", "3"], 2),
        (["--poses", "3", "--material", "brass:mirror"], 6),
        (["--poses", "3", "--rolls", "0", "45", "90"], 3),
        (["--poses", "3", "--share", "0.5", "--confidence", "0.5"], 0),
    ):
        bench.done.clear()
        said(capsys, [*asked, *more], 0)
        assert len(bench.done) == new
    assert len(list((tmp_path / CASES).iterdir())) == 4 + 2 + 6 + 3


def test_table_page_and_json_say_the_same(tmp_path: Path, bench: Bench, capsys: pytest.CaptureFixture[str]):
    """44 made-up views see 20 to 50 deg and half of them what lies beside it: blasted iron is right there but for two
    pixels in a thousand, polished brass half; beside it a third is lost to the window. The page is made again of the
    folder alone."""
    args = [*PART, *IRON, "brass:polished", "--poses", "44", "--rolls", "0", "--out", str(tmp_path), "--json"]
    out = said(capsys, args, 0)
    assert "iron:blasted, roll 0 deg: safe from 20 to 50 deg (99.8 % of the surface right, in each bin 99.8 %" in out
    assert "brass:polished, roll 0 deg: safe nowhere; the best bin, 0 to 10 deg, has 66.7 %" in out
    assert "Not known, for fewer than 22 views: 70 to 80 deg (0.0), 80 to 90 deg (0.0)." in out
    printed = json.loads(out.splitlines()[-1])
    stored = json.loads((tmp_path / SAFE_ANGLES).read_text())
    assert printed["materials"] == stored["materials"]
    assert (stored["target_share"], stored["confidence"], stored["bin_width_deg"]) == (0.95, 0.9, 10.0)
    facts = stored["measured_for"]
    assert (facts["part"], facts["lamps"], facts["distance_m"], facts["laser_mw"]) == ("A1", "workshop", 0.3, 150.0)
    assert (facts["sensor_preset"], facts["auto_exposure"], facts["poses"]) == ("default", True, 44)
    line = read_safe_angles(tmp_path / SAFE_ANGLES).angles("iron:blasted", 0)
    assert [line.is_safe(angle) for angle in (15, 20, 35, 50, 55, 85)] == [False, True, True, True, False, False]
    assert pq.read_table(tmp_path / "incidence.parquet").num_rows == 2 * 44 * 5
    page = (tmp_path / "report.html").read_text()
    (tmp_path / "report.html").unlink()
    assert main(["report", str(tmp_path)]) == 0
    assert (tmp_path / "report.html").read_text() == page


def test_poses_spread_evenly_and_continue():
    """Of 200 poses a quarter lies in each quarter of the polar angle and of the azimuth, a sixteenth in each of both,
    within one in fifty; fewer poses are the first of them; a seed continues the series."""
    settings = SafeAnglesSettings(part="A1", material=("iron:blasted",), poses=200)
    poses = np.array(poses_around(settings))
    assert poses.min() >= 0
    assert poses[:, 0].max() <= 75
    counts, _, _ = np.histogram2d(*poses.T, bins=[np.linspace(0, 75, 5), np.linspace(0, 360, 5)])
    assert np.abs(counts.sum(axis=0) / 200 - 0.25).max() <= 0.02
    assert np.abs(counts.sum(axis=1) / 200 - 0.25).max() <= 0.02
    assert np.abs(counts / 200 - 1 / 16).max() <= 0.02
    assert poses_around(settings.model_copy(update={"poses": 5})) == poses_around(settings)[:5]
    later = settings.model_copy(update={"poses": 5, "seed": 3})
    assert poses_around(later) == poses_around(settings)[3:8]


def test_a_mesh_is_named_by_its_content(tmp_path: Path):
    """The same file elsewhere makes the same views; another content, unit or bench makes others; so do they for the
    matte twin, which materials share."""
    solid = "solid s\n" + "".join(
        f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {c}{chr(10)}' for c in face)}endloop\nendfacet\n"
        for face in (("0 0 0", "0 9 0", "9 0 0"), ("0 0 0", "9 0 0", "0 0 9"), ("0 0 0", "0 0 9", "0 9 0"),
                     ("9 0 0", "0 9 0", "0 0 9"))
    ) + "endsolid s\n"  # fmt: skip
    one, other = tmp_path / "a.stl", tmp_path / "deep" / "a.stl"
    other.parent.mkdir()
    one.write_text(solid)
    other.write_text(solid)

    def names(mesh: Path, **changed: str) -> tuple[str, str]:
        settings = SafeAnglesSettings(mesh=mesh, **{"units": "mm", "material": ("iron:blasted",), **changed})
        view = angle_views(check_settings(settings))[0]
        return view.digest, view.twins[0].digest

    assert names(one) == names(other)
    brass = names(one, material=("brass:polished",))
    assert brass[0] != names(one)[0]
    assert brass[1] == names(one)[1]
    others = [names(one, units="cm"), names(one, bench="paper")]
    other.write_text(solid.replace("9", "8"))
    others.append(names(other))
    for k in (0, 1):
        assert len({names(one)[k], *(found[k] for found in others)}) == 4


@pytest.mark.slow
def test_real_views_of_a_plate(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A view of matte primer and one of polished iron: the primer is its own twin, so that a matte surface would have
    what it has; the iron loses more than the primer in every bin."""
    args = ["--part", "plate", "--material", "primer", "iron:polished", "--poses", "1", "--rolls", "0"]
    rest = ["--frames", "1", "--confidence", "0.05", "--out", str(tmp_path), "--workers", "1"]
    said(capsys, [*args, *rest], 0)
    table = read_safe_angles(tmp_path / SAFE_ANGLES)
    primer, iron = (table.angles(spec, 0).bins for spec in ("primer", "iron:polished"))
    seen = [k for k, found in enumerate(primer) if found.views]
    assert seen
    for k in seen:
        assert primer[k].part_pixels == iron[k].part_pixels
        assert primer[k].share == primer[k].matte_share
        assert iron[k].right_pixels < primer[k].right_pixels
    pixels = sum(found.part_pixels for found in primer)
    assert sum(found.right_pixels for found in primer) > 0.8 * pixels
    assert len(list((tmp_path / "twins").iterdir())) == 2  # the primer's and the iron's
