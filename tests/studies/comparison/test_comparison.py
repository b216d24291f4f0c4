"""The comparison study: which runs it plans, what it leaves, what its page shows."""

import json
import re
from itertools import pairwise
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from markupsafe import escape

from franbv.parameters import Parameters
from render.d435i import SensorSettings
from studies.cli.main import main
from studies.comparison import command as comparison
from studies.comparison import planning_speed
from studies.comparison.cases import planned_runs, seed_at
from studies.comparison.command import with_named
from studies.comparison.links import LINKS, arm_name
from studies.comparison.paper import FINAL_COVERAGE, INCREMENTS, ITERATION_S
from studies.comparison.planning_speed import (
    SPEED,
    SpeedTask,
    measure_speed,
    resampled_burst,
    stored_bursts,
    with_voxels,
)
from studies.comparison.preset import CORNER, ComparisonPreset
from studies.comparison.report.page import comparison_html
from studies.run.ablation import ABLATIONS
from studies.run.batch import RUNS, PlannedRun, check_runs, jobs
from studies.run.report.page import flattened
from studies.run.run_case import RunSettings
from studies.run.stored_run import StoredRun
from studies.work.workers import Failure
from tests.studies.browser import CHROMIUM, visit
from tests.studies.comparison.comparison_records import made_record
from tests.studies.comparison.made_speed import with_goals
from tests.studies.run.analytic_ball import reconstruct_ball

SMALL = Parameters(n_frames=3, max_iterations=3)


def test_presets_are_the_papers_experiment():
    """Four parts, three planners, fifteen runs: 180; quick has two starts, 24; the corner has a preset of its own."""
    paper, quick, corner = (planned_runs(ComparisonPreset.named(name)) for name in ("paper", "quick", "corner"))
    assert len(paper) == 180
    assert {run.part for run in paper} == set("ABCD")
    assert len(quick) == 24
    assert [run.part for run in corner] == [CORNER] * 45
    assert len({run.digest for run in paper}) == len(paper)
    assert {run.digest for run in quick} < {run.digest for run in paper}


def test_methods_start_alike_and_runs_do_not():
    """Azimuth and seed are those of the start, whatever the planner; no two starts share either."""
    starts: dict[int, set[tuple[float, int]]] = {}
    for run in planned_runs(ComparisonPreset.named("paper")):
        starts.setdefault(run.run, set()).add((run.config.azimuth_deg, run.config.seed))
    assert all(len(found) == 1 for found in starts.values())
    azimuths, seeds = zip(*(found.pop() for found in starts.values()), strict=True)
    assert sorted(azimuths) == [24.0 * k for k in range(15)]
    assert len(set(seeds)) == 15
    assert seed_at(1, 0.0) != seed_at(0, 0.0)


def test_neighbours_have_no_burst_in_common():
    """Two workers begin neighbours at the same time: they must not both make the view that they could share."""
    runs = planned_runs(ComparisonPreset.named("paper"))
    assert all(a.part != b.part for a, b in pairwise(runs))


def test_each_ablation_is_run_from_the_starts_of_the_whole_method():
    """On C and D, a third of the starts, each with its planner and the one change."""
    preset = with_named(ComparisonPreset.named("paper"), "ablations", ("all",), ABLATIONS)
    runs = [run for run in planned_runs(preset) if run.arm in ABLATIONS]
    assert len(runs) == len(ABLATIONS) * 2 * 5
    whole = {(run.part, run.arm, run.run): run.config for run in planned_runs(preset) if run.arm not in ABLATIONS}
    for run in runs:
        config = whole[run.part, ABLATIONS[run.arm].planner, run.run]
        assert (config.seed, config.azimuth_deg, config.planner) == (
            run.config.seed, run.config.azimuth_deg, run.config.planner,
        )  # fmt: skip
        assert (config.parameters, config.ablation) != (run.config.parameters, run.config.ablation)


DIFFERS = {
    "roll_0": {"sensor.roll_deg", "parameters.roll_deg"},
    "profile_640x480": {"sensor.profile"},
    "high_accuracy": {"sensor.preset"},
    "high_density": {"sensor.preset"},
    "laser_off": {"sensor.imager.laser_power_mw"},
    "laser_most": {"sensor.imager.laser_power_mw"},
    "lamps_off": {"lamps"},
    "lamps_hall": {"lamps"},
    "plinth_white": {"plinth"},
    "bright": {"material"},
    "polished": {"material"},
    "mirror": {"material"},
    "blasted": {"material"},
    "pixels_120x80": {"sensor.decimation", "sensor.crop"},
    "opencv_matcher": {"sensor.matcher"},
    "frames_1": {"parameters.n_frames"},
    "frames_5": {"parameters.n_frames"},
}
"""What each link is meant to change, by the keys of a run's configuration."""
STANDS_THERE = {"roll_90", "profile_640x360"}
"""Links that change nothing of the paper preset."""


def linked(*links: str) -> list[PlannedRun]:
    """The runs of the paper preset with these links."""
    return planned_runs(with_named(ComparisonPreset.named("paper"), "links", links, LINKS))


@pytest.mark.parametrize(("link", "differs"), DIFFERS.items())
def test_a_changed_link_changes_nothing_else(link: str, differs: set[str]):
    """FRA and PB on C and D from the same five starts, with only the named settings different."""
    runs = linked(link)
    whole = {(run.part, run.arm, run.run): run for run in runs}
    changed = [run for run in runs if "," in run.arm]
    assert len(changed) == 2 * 2 * 5
    for run in changed:
        planner, name = run.arm.split(", ")
        assert name == link
        before, after = (
            dict(flattened(config.model_dump(mode="json")))
            for config in (whole[run.part, planner, run.run].config, run.config)
        )
        assert {key for key in before.keys() | after.keys() if before.get(key) != after.get(key)} == differs
        assert run.digest != whole[run.part, planner, run.run].digest


def test_every_link_is_checked():
    """The lists above name all of them, and every changed run can be built."""
    assert set(LINKS) == set(DIFFERS) | STANDS_THERE
    check_runs(linked(*LINKS))


def test_a_link_at_which_the_study_stands_is_not_run():
    """Nothing would be compared with itself; from a level camera the one on end is the change."""
    assert not any("," in run.arm for run in linked(*STANDS_THERE))
    level = ComparisonPreset.named("paper").model_copy(
        update={"sensor": SensorSettings(roll_deg=0.0), "links": ("roll_0", "roll_90")}
    )
    changed = [run for run in planned_runs(level) if "," in run.arm]
    assert {run.arm for run in changed} == {"fra, roll_90", "pb, roll_90"}
    assert {(run.config.sensor.roll_deg, run.config.parameters.roll_deg) for run in changed} == {(90.0, 90.0)}


@pytest.mark.parametrize(
    ("flags", "says"),
    [
        (["--preset", "qick"], "preset qick: there is none; did you mean quick?"),
        (["--preset", "quick", "--ablations", "poses_7"], "--ablations poses_7: there is none; did you mean poses_"),
        (["--preset", "quick", "--workers", "0"], "--workers 0: there must be someone to do the work"),
        (["--preset", "{yaml}"], "own.yaml: parts, ablations or links: there is no E; known: A, B, C, D"),
    ],
)
def test_bad_input_is_one_line(flags: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """What is wrong, exit status 2, and no output folder."""
    (tmp_path / "own.yaml").write_text("title: Mine\nparts: [E]\n")
    flags = [flag.format(yaml=tmp_path / "own.yaml") for flag in flags]
    assert main(["study", "comparison", "--out", str(tmp_path / "out"), *flags]) == 2
    error = capsys.readouterr().err
    assert says in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ComparisonPreset]:
    """Finished runs of a ball under the names of two runs of FRA and PB on D, as the study would have left them."""
    out = tmp_path_factory.mktemp("study")
    preset = ComparisonPreset(title="Ball <study>", runs=2, parts=("D",), planners=("fra", "pb"), parameters=SMALL)
    for planned in planned_runs(preset):
        (out / RUNS / planned.digest).mkdir(parents=True)
        settings = RunSettings(planner=planned.config.planner, azimuth_deg=planned.config.azimuth_deg, parameters=SMALL)
        reconstruct_ball(out / RUNS / planned.digest, settings=settings)
    comparison.write_preset(out, preset)
    return out, preset


def test_finished_runs_are_not_planned_again(study: tuple[Path, ComparisonPreset], tmp_path: Path):
    """Nothing to do where all runs are; all of them elsewhere."""
    out, preset = study
    runs = planned_runs(preset)
    assert jobs(out, runs) == []
    assert [job.name for job in jobs(tmp_path, runs)] == [run.title for run in runs]


def test_report_command_rebuilds_table_summary_and_page(study: tuple[Path, ComparisonPreset]):
    """From the folder alone: a row per run, the agreed JSON, a page that escapes what comes from outside."""
    out, preset = study
    assert main(["report", str(out)]) == 0
    table = pq.read_table(out / comparison.RUNS_TABLE).to_pylist()
    assert [(row["part"], row["arm"], row["run"]) for row in table] == [
        (run.part, run.arm, run.run) for run in planned_runs(preset)
    ]
    assert all(row["processor_s"] > 0 for row in table)
    summary = json.loads((out / comparison.SUMMARY).read_text())
    for column in ("coverage_5mm", "coverage_map_5mm"):  # of two runs the median is the mean
        coverages = [row[column] for row in table if row["arm"] == "fra"]
        assert summary["parts"]["D"]["fra"][column] == pytest.approx(sum(coverages) / 2)
    last = [StoredRun(out / RUNS / run.digest).rows[-1]["filtered_coverage_5mm"] for run in planned_runs(preset)]
    assert [row["coverage_map_5mm"] for row in table] == last
    assert summary["parts"]["D"]["fra"]["activations"] > 0
    assert summary["processor_s"] == pytest.approx(sum(row["processor_s"] for row in table))
    html = (out / "report.html").read_text()
    assert "Ball &lt;study&gt;" in html
    first = (out / "report.html").read_bytes()
    assert main(["report", str(out)]) == 0
    assert (out / "report.html").read_bytes() == first


def test_speed_is_measured_at_every_size(study: tuple[Path, ComparisonPreset], monkeypatch: pytest.MonkeyPatch):
    """PB and RE on the same maps at all sizes; what the axis changes is what grows."""
    out, preset = study
    monkeypatch.setattr(planning_speed, "REPEATED_S", 0.0)
    monkeypatch.setattr(planning_speed, "EDGES", (40, 50))
    monkeypatch.setattr(planning_speed, "CANDIDATES", (32, 64))
    monkeypatch.setattr(planning_speed, "IMAGES", ((60, 40), (90, 60)))
    measure_speed(SpeedTask(out, out / RUNS / planned_runs(preset)[0].digest, preset.parameters))
    found = json.loads((out / SPEED).read_text())
    rows = found["rows"]
    assert [(row["axis"], row["size"], row["planner"]) for row in rows] == [
        (axis, size, planner)
        for axis, sizes in (("voxels", (40, 50)), ("candidates", (32, 64)), ("pixels", (60, 90)))
        for size in sizes
        for planner in ("pb", "re")
    ]
    assert [row["map_voxels"] for row in rows[:4]] == pytest.approx([40**3] * 2 + [50**3] * 2, rel=0.12)
    assert [row["rays"] for row in rows[8:]] == [2400, 2400, 5400, 5400]
    assert rows[4]["poses"] < rows[6]["poses"]
    assert all(row["object_voxels"] > 100 for row in rows)
    page = _page(out, preset)
    assert "a decision takes" in page
    assert "One decision of PB" in page


def _page(out: Path, preset: ComparisonPreset) -> str:
    comparison.rebuild(out)
    return (out / "report.html").read_text()


def test_finer_sensor_has_the_same_field_of_view(study: tuple[Path, ComparisonPreset]):
    """The edges of the image stay where they are, and the middle of a block of equal depths keeps its direction."""
    out, preset = study
    burst = stored_bursts(out / RUNS / planned_runs(preset)[0].digest, 1)[0]
    finer = resampled_burst(burst, 180, 120)
    assert finer.depths.shape == (3, 120, 180)
    assert (finer.depths[:, ::3, ::3] == burst.depths).all()
    assert (finer.depths[:, 2::3, 2::3] == burst.depths).all()
    coarse, fine = burst.intrinsics.pixel_directions(), finer.intrinsics.pixel_directions()
    assert fine[1::3, 1::3] == pytest.approx(coarse, abs=1e-12)
    k, f = burst.intrinsics, finer.intrinsics
    assert (-0.5 - f.cx) / f.fx == pytest.approx((-0.5 - k.cx) / k.fx)
    assert (119.5 - f.cy) / f.fy == pytest.approx((39.5 - k.cy) / k.fy)


def test_voxels_are_counted_in_the_workspace():
    """0.495 x 0.495 x 0.315 m in 64^3 voxels: (0.0772 m^3)^(1/3) / 64 = 6.65 mm."""
    assert with_voxels(Parameters(), 64).voxel_size == pytest.approx((0.495 * 0.495 * 0.315) ** (1 / 3) / 64)


def whole_page() -> str:
    """A page with runs of all parts, planners, ablations and links, a failure, and the corner."""
    preset = with_named(ComparisonPreset.named("paper"), "ablations", ("all",), ABLATIONS)
    records = []
    for k, part in enumerate((*preset.parts, CORNER)):
        for j, arm in enumerate(preset.planners):
            for run in range(6):
                end = 0.95 - 0.05 * k - 0.03 * j + 0.004 * run
                coverage, kinds = ((0.3, 0.4, 0.5, end), "frnn") if arm == "fra" else ((0.3, 0.5, 0.6, end), "fnnn")
                records.append(made_record(part, arm, run, coverage, kinds, activations=k if arm == "fra" else 0))
    for part in preset.ablated_parts:
        for link in LINKS:
            records += [made_record(part, arm_name(planner, link)) for planner in ("fra", "pb")]
        for name in ABLATIONS:
            records += [made_record(part, name, run, (0.3, 0.5, 0.7, 0.8), "fnnn") for run in range(3)]
    failures = [Failure("D re, run 3", "its process was ended by SIGKILL")]
    return comparison_html(preset, comparison.Comparison(records), len(records) + 1, failures, with_goals())


def test_page_sets_every_number_of_the_paper_beside_ours():
    """Its medians, boxes, whiskers, recoveries, increments and times; every ablation, link and planner has its row."""
    html = whole_page()
    cells = set(re.findall(r'<td class="n theirs">([^<]*)</td>', html))
    for arms in FINAL_COVERAGE.values():
        assert {f"{100 * box.median:.2f}" for box in arms.values()} <= cells
        assert {f"{100 * box.lower:.0f} to {100 * box.upper:.0f}" for box in arms.values()} <= cells
        assert {f"{100 * box.low:.0f} to {100 * box.high:.0f}" for box in arms.values()} <= cells
    assert {"1.5 to 3", "5.5 to 9", "to 12", "6.96", "34.56", "\u22123 to 27", "20 to 71"} <= cells
    assert {"+9.4", "+7.9", "+16.8", "+31.5", "+55.9"} <= cells
    medians = [value for rows in INCREMENTS.values() for pair in rows.values() for value in pair if value is not None]
    assert {f"{100 * value:.1f}".replace("-", "\u2212") for value in medians} <= cells
    assert html.count('class="paper-median') == len(medians)
    for rows in ITERATION_S.values():
        for lower, median, upper in rows.values():
            assert f"{median:.2f}<small>{lower:.2f} to {upper:.2f}</small>" in html
    for number in (
        "up to 31 %",
        "approximately 56 %",
        "around 10 % on A and B, up to approximately 30 % on C and D",
        "A \u2264 B &lt; C \u2264 D",
    ):
        assert number in html
    table = html[html.index('id="ablations"') :]
    for words, _, _ in ABLATIONS.values():
        assert table.count(f"<td>{escape(words)}</td>") == 2
    links = html[html.index('id="changed"') : html.index('id="ablations"')]
    for link in LINKS.values():
        assert links.count(f"<td>{escape(link.words)}</td>") == 2
        assert links.count(f">{escape(link.words)}</text>") == 2
    assert "D re, run 3" in html
    assert html.count('class="figure"') == 7


def test_page_asks_for_nothing_from_outside():
    """No address, no style or script of another file."""
    html = whole_page()
    places = re.findall(r'(?:src|href)="([^"]*)"', html) + re.findall(r"url\(([^)]*)\)", html)
    assert all(place.startswith(("data:", "#")) for place in places)
    assert "http" not in html


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_page_is_silent_and_as_wide_as_the_window(tmp_path: Path):
    """At 1280 px: no console message, no request, and nothing sticks out to the right."""
    page = tmp_path / "report.html"
    probe = "<script>document.title = document.documentElement.scrollWidth</script></body>"
    page.write_text(whole_page().replace("</body>", probe))
    seen = visit(page, tmp_path)
    assert seen.console == []
    assert seen.requests == []
    title = re.search(r"<title>(\d+)</title>", seen.dom)
    assert title is not None
    assert int(title[1]) <= 1280


def test_titles_are_for_people():
    """Runs are counted from one."""
    run = planned_runs(ComparisonPreset.named("quick"))[0]
    assert isinstance(run, PlannedRun)
    assert run.title == "A fra, start 1"
