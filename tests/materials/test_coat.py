"""The Saunderson correction against limits and a Monte-Carlo count of the photons under a coat."""

import numpy as np
import pytest

from materials.coat import base_albedo, internal_reflectance, seen_reflectance


def test_a_coat_of_air_changes_nothing():
    """n = 1 reflects nothing, so that the base is seen as it is (the limit is approached from above)."""
    assert seen_reflectance(1.0 + 1e-9, 0.37) == pytest.approx(0.37, abs=1e-6)


def test_internal_reflectance_of_plastic_is_the_published_one():
    """0.596 for n = 1.5 (J. L. Saunderson, J. Opt. Soc. Am. 32, 727 (1942), and every text on paint since)."""
    assert internal_reflectance(1.5) == pytest.approx(0.596, abs=5e-4)


def test_a_black_base_is_black_and_a_brighter_base_is_brighter():
    """Nothing comes back from a black base, and the relation is monotonic."""
    seen = [seen_reflectance(1.5, albedo) for albedo in np.linspace(0, 1, 11)]
    assert seen[0] == 0.0
    assert np.all(np.diff(seen) > 0)


@pytest.mark.parametrize("seen", [0.0, 0.015, 0.3, 0.7, 0.95])
def test_base_albedo_inverts_the_seen_reflectance(seen):
    """The two are inverse functions by definition."""
    assert seen_reflectance(1.5, base_albedo(1.5, seen)) == pytest.approx(seen, abs=1e-12)


def test_photons_counted_under_the_coat_give_the_same_reflectance():
    """400,000 photons enter along the normal, scatter off the base (Lambert) and meet the inside of the coat, where
    Fresnel and total reflection decide; what leaves near the normal is compared as a reflectance factor."""
    n, albedo, count, cone = 1.5, 0.6, 400_000, np.deg2rad(20.0)
    rng = np.random.default_rng(8)
    weight = np.full(count, 0.96)  # 1 - R0 of n = 1.5
    seen = 0.0
    for _ in range(30):
        weight = weight * albedo
        cos_in = np.sqrt(rng.random(count))  # cosine-weighted
        sin_out = n * np.sqrt(1 - cos_in**2)
        cos_out = np.sqrt(np.clip(1 - sin_out**2, 0, None))
        r_s = (n * cos_in - cos_out) / (n * cos_in + cos_out)
        r_p = (cos_in - n * cos_out) / (cos_in + n * cos_out)
        reflectance = np.where(sin_out < 1, 0.5 * (r_s**2 + r_p**2), 1.0)
        leaves = (sin_out < np.sin(cone)) & (rng.random(count) >= reflectance)
        seen += weight[leaves].sum() / count / np.sin(cone) ** 2  # a Lambert surface sends sin^2 into the cone
        weight = np.where(reflectance > rng.random(count), weight, 0.0)
    assert seen == pytest.approx(seen_reflectance(n, albedo), rel=0.02)  # 1 % noise
