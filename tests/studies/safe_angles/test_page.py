"""The page of safe angles: silent, without network, a card for each material, and true to the table."""

import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from franbv.surfaces.safe_angles import SafeAngles
from studies.base.numbers_as_text import percent
from studies.safe_angles.plan import AnglesPlan, write_angles_plan
from studies.safe_angles.report.page import write_angles_report
from studies.safe_angles.settings import SafeAnglesSettings, check_settings
from studies.safe_angles.table import safe_angles_table
from studies.safe_angles.views import angle_views
from studies.sensitivity.tables import Tables
from tests.studies.browser import CHROMIUM, visit
from tests.studies.safe_angles.made_up_views import counted

MATERIALS = ("iron:blasted", "stainless_austenitic:polished", "brass:blasted")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, AnglesPlan, SafeAngles]:
    """A page of three materials at two rolls, of which one view is missing."""
    out = tmp_path_factory.mktemp("angles")
    settings = check_settings(SafeAnglesSettings(part="A1", material=MATERIALS, poses=44))
    views = angle_views(settings)
    plan = write_angles_plan(out, settings, 0.95, 0.9, views)
    rows = [counted(view) for view in views[1:]]
    tables = Tables([row for r in rows for row in r["views"]], [row for r in rows for row in r["incidence"]], [])
    table = safe_angles_table(plan, tables)
    return write_angles_report(out, plan, table, len(tables.views)), plan, table


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_page_is_silent_offline_and_fits(made: tuple[Path, AnglesPlan, SafeAngles], tmp_path: Path):
    """No console message, no request; at 1280 px nothing sticks out to the right; the safe bars are seen."""
    seen = visit(made[0], tmp_path)
    assert seen.console == []
    assert seen.requests == []
    visit(made[0], tmp_path, tmp_path / "page.png", (1280, 3200))
    picture = cv2.imread(str(tmp_path / "page.png"))
    assert picture is not None
    assert len(np.unique(picture[:, -20:].reshape(-1, 3), axis=0)) == 1
    safe = np.abs(picture[..., ::-1].astype(int) - (0x1F, 0x8C, 0x78)).sum(axis=-1) < 12
    assert np.count_nonzero(safe) > 2 * 2 * 3 * 30 * 100  # two materials, two rolls, three bars of 30 x 100 px


def test_every_material_has_a_card_and_every_bin_its_numbers(made: tuple[Path, AnglesPlan, SafeAngles]):
    """A figure for each material and roll; nine bars or question marks; numbers as in the table."""
    html, table = made[0].read_text(), made[2]
    assert html.count('class="card material"') == len(MATERIALS)
    assert html.count('class="figure"') == 2 * len(MATERIALS)
    for entry in table.materials:
        card = html[html.index(f"<h2>{entry.material.replace(':', ', ').replace('_', ' ').capitalize()}</h2>") :]
        card = card[: card.index("</section>")]
        for line in entry.rolls:
            for found in line.bins:
                words = f"{found.from_deg:g} to {found.to_deg:g} deg: "
                assert words in card
                if found.lower_bound is not None:
                    assert f"{percent(found.share)} right in {found.views} views" in card
                    assert f"{percent(found.lower_bound)} at least" in card
        safe = entry.material.endswith("blasted")
        assert ("safe: 20 to 50 deg" in card) is safe
        assert card.count('class="angle-bar safe"') == (6 if safe else 0)
    assert not re.search(r"https?://", html)
    assert "@import" not in html


def test_page_says_what_is_missing_and_what_it_holds_for(made: tuple[Path, AnglesPlan, SafeAngles]):
    """One view of 264 is not measured; part, light and camera are named."""
    html = made[0].read_text()
    assert "263 of 264 views are measured so far" in html
    assert "Safe angles of part A1" in html
    for name, value in (("lamps", "workshop"), ("distance_m", "0.3"), ("camera", "d435i"), ("laser_mw", "150.0")):
        assert f"<code>{name}</code><span>{value}</span>" in html
