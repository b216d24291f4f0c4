"""The planner's reader of safe angles: what is in the file comes out, what is not is named, unknown is not safe."""

import json
from pathlib import Path

import pytest

from franbv.surfaces.safe_angles import SAFE_ANGLES_FORMAT, AngleBin, SafeRange, read_safe_angles

BIN = {
    "from_deg": 20.0, "to_deg": 30.0, "views": 30, "effective_views": 25.5, "part_pixels": 1000, "right_pixels": 990,
    "share": 0.99, "lower_bound": 0.97, "matte_share": 1.0, "views_below": 1, "views_below_at_most": 0.12,
    "lost_to": "occlusion",
}  # fmt: skip
UNKNOWN = BIN | {
    "from_deg": 30.0,
    "to_deg": 40.0,
    "views": 3,
    "effective_views": 3.0,
    "lower_bound": None,
    "views_below_at_most": None,
}
SPAN = {"from_deg": 20.0, "to_deg": 30.0, "share": 0.99, "lower_bound": 0.97}
STORED = {
    "format": SAFE_ANGLES_FORMAT,
    "bin_width_deg": 10.0,
    "target_share": 0.95,
    "confidence": 0.9,
    "least_views": 22,
    "least_pixels": 100,
    "measured_for": {"part": "A1", "distance_m": 0.3},
    "materials": [
        {"material": "iron:blasted", "rolls": [{"roll_deg": 0.0, "ranges": [SPAN], "bins": [BIN, UNKNOWN]}]},
        {"material": "brass:mirror", "rolls": [{"roll_deg": 0.0, "ranges": [], "bins": [UNKNOWN]}]},
    ],
    "versions": {},
}


def written(folder: Path, stored: object) -> Path:
    """A file that holds this."""
    path = folder / "safe_angles.json"
    path.write_text(json.dumps(stored))
    return path


def test_what_is_stored_is_read(tmp_path: Path):
    """Every number of the file, by the names that it has there."""
    table = read_safe_angles(written(tmp_path, STORED))
    assert (table.target_share, table.confidence, table.least_views, table.least_pixels) == (0.95, 0.9, 22, 100)
    assert table.measured_for == {"part": "A1", "distance_m": 0.3}
    line = table.angles("iron:blasted", 0)
    assert line.bins == (AngleBin(**BIN), AngleBin(**UNKNOWN))
    assert line.ranges == (SafeRange(**SPAN),)
    assert [found.is_known for found in line.bins] == [True, False]


def test_only_a_safe_range_is_safe(tmp_path: Path):
    """Ends of the range belong to it; a bin that few views see does not, however good its share is."""
    table = read_safe_angles(written(tmp_path, STORED))
    line = table.angles("iron:blasted", 0.0)
    assert [line.is_safe(angle) for angle in (0.0, 19.9, 20.0, 25.0, 30.0, 30.1, 35.0)] == [
        False, False, True, True, True, False, False,
    ]  # fmt: skip
    assert not table.angles("brass:mirror", 0.0).is_safe(35.0)


def test_what_was_not_measured_is_named(tmp_path: Path):
    """Another roll or material is an error that lists what there is."""
    table = read_safe_angles(written(tmp_path, STORED))
    with pytest.raises(ValueError, match=r"no safe angles of iron:blasted at roll 90 deg; .* iron:blasted at 0 deg"):
        table.angles("iron:blasted", 90.0)


@pytest.mark.parametrize(
    ("stored", "words"),
    [
        (STORED | {"format": 2}, r"older or newer version \(format 2, here 1\)"),
        ({"format": 1}, "is no table of safe angles"),
        ([1, 2], "is no table of safe angles"),
        (
            STORED | {"materials": [{"material": "x", "rolls": [{"roll_deg": 0.0, "ranges": [], "bins": [{}]}]}]},
            "no table",
        ),
    ],
)
def test_other_files_are_refused(tmp_path: Path, stored: object, words: str):
    """In one line that names the file."""
    path = written(tmp_path, stored)
    with pytest.raises(ValueError, match=words) as caught:
        read_safe_angles(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)
