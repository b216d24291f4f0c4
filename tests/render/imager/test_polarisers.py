"""Films before lenses, projector and lamps: what they let through, and what the laser's own polarisation does there."""

import numpy as np
import pytest
from pydantic import ValidationError

from materials.lights import Band
from render.imager.polarisers import FILMS, Film, Polarisers
from render.imager.settings import ImagerSettings
from render.imager.speckle import degrees_of_freedom


def test_malus_law_of_a_polarised_laser():
    """cos^2 of the angle between laser and film is left, and it is polarised along the film wholly."""
    for angle in (0.0, 30.0, 60.0, 90.0):
        power, q, u = Polarisers(projector_deg=angle, film="ideal", laser_degree=1.0).projector_stokes()
        assert power == pytest.approx(np.cos(np.radians(angle)) ** 2, abs=1e-12)
        assert (q, u) == (pytest.approx(power, abs=1e-12), pytest.approx(0.0, abs=1e-12))


def test_an_even_mix_is_halved_whatever_the_angle():
    """Of unpolarised light an ideal film leaves half; without a film the laser stays as it is."""
    for angle in (-90.0, 0.0, 45.0):
        assert Polarisers(projector_deg=angle, film="ideal").projector_stokes()[0] == pytest.approx(0.5)
    assert Polarisers(laser_degree=0.4, laser_deg=20.0).projector_stokes() == pytest.approx((1.0, 0.4, 0.0))
    assert Polarisers(laser_degree=0.4, laser_deg=20.0).projector_axis_deg == 20.0


def test_a_weak_film_keeps_what_swings_aslant():
    """A film that lets all pass changes nothing: 40 % along 45 deg to its axis stay that."""
    power, q, u = Polarisers(projector_deg=0.0, film="sheet", laser_degree=0.4, laser_deg=45.0).projector_stokes()
    beyond = FILMS["sheet"].beyond
    assert (power, q, u) == pytest.approx((beyond, 0.0, 0.4 * beyond))


def test_photographers_sheets_do_nothing_at_850_nm():
    """They polarise the visible light of LEDs, half of what the imager sees of halogen lamps, and not the dots."""
    sheet = FILMS["sheet"]
    assert sheet.degree(Band.PROJECTOR) == 0
    assert sheet.degree(Band.WHITE_LED) > 0.95
    assert 0.3 < sheet.degree(Band.HALOGEN) < 0.9
    assert FILMS["nir"].degree(Band.PROJECTOR) == pytest.approx(0.998, abs=1e-3)


@pytest.mark.parametrize("band", Band)
def test_an_ideal_film_leaves_half(band: Band):
    """All of one field, none of the other, of any light."""
    assert Film(1.0, 0.0).passed(band) == pytest.approx(0.5)
    assert Film(1.0, 0.0).degree(band) == pytest.approx(1.0)


def test_one_speckle_pattern_is_left_behind_a_film():
    """Half the degrees of freedom, so sqrt(2) of the contrast; a sheet leaves both, and so does a film elsewhere."""
    plain = degrees_of_freedom(640, ImagerSettings())

    def behind(**films) -> float:
        return degrees_of_freedom(640, ImagerSettings(polarisers=Polarisers(**films))) / plain

    assert behind(imagers_deg=0.0, film="ideal") == pytest.approx(0.5)
    assert behind(imagers_deg=0.0, film="sheet") == pytest.approx(1.0)
    assert behind(projector_deg=0.0) == pytest.approx(1.0)


def test_settings_without_films_are_written_as_before():
    """So that finished cases keep their names; with films they are read back."""
    assert "polarisers" not in ImagerSettings().model_dump()
    filmed = ImagerSettings(polarisers=Polarisers(imagers_deg=90.0, projector_deg=0.0))
    assert ImagerSettings.model_validate_json(filmed.model_dump_json()) == filmed


@pytest.mark.parametrize("wrong", [{"imagers_deg": 200.0}, {"film": "foil"}, {"imager": 0.0}, {"laser_degree": 1.5}])
def test_wrong_films_are_refused(wrong: dict):
    """Turns beyond half a circle, films and keys that there are not."""
    with pytest.raises(ValidationError):
        ImagerSettings(polarisers=wrong)
