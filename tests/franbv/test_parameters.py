"""The parameter model: the paper's table is the default, mistakes are refused, every field says unit and source."""

import pytest
import yaml
from pydantic import ValidationError

from franbv.parameters import Parameters
from franbv.voxel_map import empty_map


def test_defaults_are_the_paper_s_table():
    """Expected values are copied from the paper's parameter table, in metres."""
    p = Parameters()
    assert (p.max_iterations, p.stagnation_change, p.stagnation_iterations) == (15, 0.01, 5)
    assert (p.voxel_size, p.n_frames, p.recovered_share) == (0.0075, 15, 0.3)
    assert (p.stand_off, p.n_candidates, p.lateral_offset, p.recovery_distance) == (0.2, 32, 0.1, 0.1)


def test_the_map_has_the_paper_s_voxels():
    """67 x 67 x 43 is printed in the parameter table of the authors' project page; the part stands on the middle."""
    grid = empty_map(Parameters())
    assert grid.log_odds.shape == (67, 67, 43)
    assert (grid.first[:2] == -33).all()


def test_every_field_names_unit_and_source():
    """A number without a source cannot be judged: table, text, equation, published code, convention or choice."""
    for name, field in Parameters.model_fields.items():
        text = field.description or ""
        assert any(s in text for s in ("Table.", "Text", "Choice", "Eq.", "Published", "OctoMap", "Convention")), name
        assert field.annotation in (bool, str) or "[" in text or "Literal" in str(field.annotation), name


def test_yaml_round_trip():
    """A study's YAML gives the same model back, vectors included."""
    p = Parameters(recovered_share=0.5, workspace_max=(0.3, 0.3, 0.3))
    assert Parameters.model_validate(yaml.safe_load(yaml.safe_dump(p.model_dump(mode="json")))) == p


@pytest.mark.parametrize(
    "wrong",
    [
        {"tau": 0.3},
        {"voxel_size": 0.0},
        {"workspace_min": (0.3, 0.0, 0.0)},
        {"prior_max": (-0.2, 0.1, 0.1)},
        {"hit_probability": 0.4},
        {"polar_min_deg": 85.0},
        {"covariance": "diag"},
        {"n_frames": 0},
        {"polar_min_deg": 0.0, "polar_max_deg": 0.0},
        {"hit_probability": 0.5001},
    ],
)
def test_mistakes_are_refused(wrong):
    """Unknown keys, empty boxes, a hit that does not raise occupancy and the like never reach the loop."""
    with pytest.raises(ValidationError):
        Parameters(**wrong)
