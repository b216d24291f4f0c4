"""The command on a bank that is there already: what it says, writes and keeps, and who takes its settings."""

import json
from pathlib import Path

import pytest
import yaml

from franbv.adapters.live.command import _parameters
from studies.base.config import overlaid
from studies.base.flags import parse_wider_command
from studies.cli.main import main
from studies.cli.reconstruct import ReconstructCommand
from studies.run.reconstruct import ReconstructSettings
from studies.run.replayed import ReplaySettings
from tests.studies.browser import CHROMIUM, visit
from tests.studies.thresholds.made_up_bank import write_banks
from tests.studies.thresholds.made_up_study import PRESET, STATED


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A finished study and its configuration."""
    folder = tmp_path_factory.mktemp("thresholds")
    config, out = folder / "config.yaml", folder / "out"
    config.write_text(yaml.safe_dump(STATED))
    write_banks(out, PRESET)
    assert main(["study", "thresholds", str(config), "--out", str(out), "--workers", "1"]) == 0
    return config, out


def test_what_it_leaves(made):
    """A setting that finds the ball, certified; the numbers in summary and certificate agree; nothing half-written."""
    _, out = made
    summary = json.loads((out / "thresholds_summary.json").read_text())
    certificate = json.loads((out / "certificate.json").read_text())
    assert certificate["certified"] is True
    assert summary["settings"]["cluster_min_samples"] == 5
    assert certificate["settings"] == summary["settings"]
    assert summary["repetitions"] == 50
    assert summary["violations"] <= summary["allowed"]
    assert [p["draws"] for p in certificate["promises"]] == [39, 39]
    cells = certificate["combinations"]
    assert sum(cell["exceeding"]["false_recoveries"][1] for cell in cells) == 60
    assert {cell["part"] for cell in cells} == {"ball", "plate"}
    assert not list(out.rglob(".*"))


def test_nothing_is_done_twice(made, capsys):
    """The same command draws and scores nothing; `franbv report` makes the same page."""
    config, out = made
    before = {path: path.stat().st_mtime_ns for path in (out / "bank").rglob("*.npz")}
    assert len(before) == 2 * 60
    page = (out / "certificate.html").read_text()
    assert main(["study", "thresholds", str(config), "--out", str(out), "--json"]) == 0
    said = capsys.readouterr().out
    assert json.loads(said.splitlines()[-1])["confidence"] == 0.9
    assert "false_recoveries: 39 of 60 draws certify; without one that exceeds they promise 5.7 %" in said
    assert "Repeated on 50 other splits" in said
    assert main(["report", str(out)]) == 0
    assert (out / "certificate.html").read_text() == page
    assert {path: path.stat().st_mtime_ns for path in (out / "bank").rglob("*.npz")} == before


def test_the_settings_are_taken_as_they_are(made, tmp_path):
    """By `reconstruct --config`, `replay --config` and `run --parameters`."""
    path = made[1] / "thresholds.yaml"
    chosen = yaml.safe_load(path.read_text())["parameters"]
    args = ["--config", str(path), "--part", "A", "--out", str(tmp_path)]
    command = parse_wider_command(ReconstructCommand, ReconstructSettings, args, "franbv reconstruct", "")
    replayed = overlaid(ReplaySettings(), path)
    for parameters in (command.settings.parameters, replayed.parameters, _parameters(path)):
        assert {name: getattr(parameters, name) for name in chosen} == chosen


def test_a_target_that_cannot_be_reached(made, tmp_path, capsys):
    """One line with the level that the budget can reach, exit 2, nothing written."""
    stated = STATED | {"risks": {"false_recoveries": {"most": 0, "level": 0.01}}}
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump(stated))
    assert main(["study", "thresholds", str(config), "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "`false_recoveries.level` = 0.01: 39 certifying draws reach 0.0573 at confidence 0.9" in err
    assert not (tmp_path / "out").exists()


def test_nothing_certified(made, tmp_path, capsys):
    """Where nothing keeps the levels it is said, and there is no file of settings to be taken by mistake."""
    _, out = made
    again = tmp_path / "out"
    stated = STATED | {"settings": {"cluster_min_samples": [400], "n_frames": [3]}}
    config = tmp_path / "config.yaml"
    config.write_text(yaml.safe_dump(stated))
    again.mkdir()
    (again / "bank").symlink_to(out / "bank")
    (again / "thresholds.yaml").write_text("parameters: {}\n")
    assert main(["study", "thresholds", str(config), "--out", str(again), "--workers", "1"]) == 0
    said = capsys.readouterr().out
    assert "No setting is certified: at best missed_reflective_area exceeds in 39 of 39 draws" in said
    assert not (again / "thresholds.yaml").exists()
    assert json.loads((again / "certificate.json").read_text())["settings"] is None
    assert "No setting marks a pixel: none of the " in (again / "certificate.html").read_text()


def test_precision_and_recall_on_the_page(made):
    """The ball's highlight is found with 5 pixels to a cluster, for either burst; with 400 nothing is marked. Without
    reconstructions the page has no curves of them."""
    page = (made[1] / "certificate.html").read_text()
    detector = page[page.index('id="detector"') : page.index('id="how"')]
    assert detector.count('class="setting chosen"') == 1
    assert detector.count("<title>cluster_min_samples 5, n_frames ") == 2
    assert "and are not drawn: 2 of 4." in detector
    assert 'id="progress"' not in page


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_page_is_silent_and_offline(made, tmp_path):
    """At 1280 px no message and no request; the title's markup is text."""
    seen = visit(made[1] / "certificate.html", tmp_path, tmp_path / "page.png", (1280, 3000))
    assert seen.console == []
    assert seen.requests == []
    html = (made[1] / "certificate.html").read_text()
    assert "Balls &lt;and&gt; plates" in html
    assert "Certified with confidence 90.0 %" in html
