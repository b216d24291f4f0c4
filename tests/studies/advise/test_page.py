"""The page of an advice: silent, without network, and true to the numbers."""

from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np
import pytest

from materials.input_error import InputError
from studies.advise.advice import advice_from
from studies.advise.command import rebuild
from studies.advise.explained import face_rows, losses
from studies.advise.pictures import picture_rows
from studies.advise.sentences import advice_sentence
from studies.advise.stored_advice import ADVICE, StoredAdvice, read_stored_advice, stored_wall_s, write_stored_advice
from tests.studies.advise.made_up import remedy, tried
from tests.studies.advise.test_advice import BASE, SPRAYED, better
from tests.studies.advise.test_explained import explained
from tests.studies.browser import CHROMIUM, visit


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, StoredAdvice]:
    """Three remedies and a pair, spray for want of time untried."""
    out = tmp_path_factory.mktemp("advice")
    laser, roll, preset = remedy("laser", "60 mW"), remedy("roll", "90 deg"), remedy("preset", "hand")
    singles = [tried(laser, right=better(0.1)), tried(preset, right=better(-0.1)), tried(roll, right=better(0.0, 0.05))]
    spray = tried(remedy("spray", "matte"), right=SPRAYED)
    advice, _ = advice_from([tried(right=BASE), *singles, spray, tried(laser, roll, right=better(0.27))], 6, 1)
    views = [explained(), explained()]
    rows = tuple(asdict(row) for row in face_rows(views, views, ["block", "table", "screw"]))
    lost = losses(views)
    untried, impossible = ("profile: 1280x720",), ("stand-off: 1.33 times",)
    stored = StoredAdvice(
        "Part <X>", advice, advice_sentence(advice, lost), untried, impossible, ("0,40,0.3", "90,40,0.3"), lost,
        lost, rows, tuple(picture_rows(views, views)), {"part": "X", "sensor": {"profile": "640x360"}},
        {"python": "3"}, 12.0,
    )  # fmt: skip
    write_stored_advice(out, stored)
    return rebuild(out), stored


def test_the_folder_keeps_what_the_page_is_made_of(made: tuple[Path, StoredAdvice]):
    """Read back, it is the same but for lists that JSON has in place of tuples."""
    page, stored = made
    assert read_stored_advice(page.parent).advice == stored.advice
    assert read_stored_advice(page.parent).pictures == stored.pictures


def test_an_answer_that_cannot_be_read_is_no_hindrance_to_a_new_one(made: tuple[Path, StoredAdvice], tmp_path: Path):
    """Its time is not known; a whole one's is."""
    assert stored_wall_s(made[0].parent) == 12.0
    assert stored_wall_s(tmp_path) == 0.0
    (tmp_path / ADVICE).write_text("{")
    assert stored_wall_s(tmp_path) == 0.0
    with pytest.raises(InputError, match="give the command again"):
        read_stored_advice(tmp_path)


def test_the_page_says_what_was_found(made: tuple[Path, StoredAdvice]):
    """Sentence, tiles, every remedy, faces, what was not tried; titles are escaped."""
    html = made[0].read_text().replace("\u00a0", " ")
    assert "right depth on 81 % (" in html
    assert "<b>54 %</b>" in html
    assert "Not tried for want of time: profile: 1280x720" in html
    assert "no camera can stand there from one of the poses: stand-off: 1.33 times." in html
    assert "block, +x" in html
    assert "part &lt;X&gt;" in html
    for words in ("laser: 60 mW", "preset: hand", "spray: matte", "laser + roll: 60 mW + 90 deg"):
        assert words in html
    assert html.count('class="views"') == 4


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_page_is_silent_offline_and_fits_its_width(made: tuple[Path, StoredAdvice], tmp_path: Path):
    """No console message, no request; at 1280 px nothing sticks out to the right."""
    seen = visit(made[0], tmp_path)
    assert seen.console == []
    assert seen.requests == []
    visit(made[0], tmp_path, tmp_path / "page.png", (1280, 3200))
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert picture is not None
    assert len(np.unique(picture[:, -20:].reshape(-1, 3), axis=0)) == 1
