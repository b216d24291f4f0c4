"""Damaged recordings: one line that names the file, or what is whole of it; never another error, never much memory."""

import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from franbv.adapters.recording.bags.choices import BagChoices
from franbv.adapters.recording.contents import Recording, RecordingError
from franbv.adapters.recording.mcap_records import MCAP_MAGIC
from franbv.adapters.recording.opening import open_recording
from tests.franbv.adapters.recording.bags.bag_writers import ROS1, camera_info, write_rosbag1, write_rosbag2
from tests.franbv.adapters.recording.bags.test_reading import CHOICES, INFO, frames, stamped, transforms
from tests.franbv.adapters.recording.damages import cut, damaged, flipped

MOST_MEMORY = 16 * 2**20
"""Beyond what the file itself takes [bytes]: a chunk of the recording here has 0.1 MB."""


def outcome(path: Path, choices: BagChoices | None = None) -> Recording | None:
    """What is read, every image of it too; None where it is refused, in one line with the file's name."""
    found, complaint = None, None
    try:
        found = open_recording(path, choices)
        for burst in found.bursts:
            burst.read()
            burst.read_infrared()
    except RecordingError as error:
        complaint = str(error)
    if complaint is None:
        return found
    assert complaint.startswith(f"{path}: ")
    assert "\n" not in complaint
    return None


def check_damages(data: bytes, folder: Path, n: int, seed: int) -> dict[str, int]:
    """Refusals by kind of damage; what is read of a damaged file is the beginning of the whole one."""
    whole = folder / "whole.mcap"
    whole.write_bytes(data)
    depths = [burst.read().depths for burst in open_recording(whole).bursts]
    refused: dict[str, int] = {}
    path = folder / "damaged.mcap"
    tracemalloc.start()
    for words, changed in damaged(data, n, seed):
        path.write_bytes(changed)
        tracemalloc.reset_peak()
        held = tracemalloc.get_traced_memory()[0]
        found = outcome(path)
        assert tracemalloc.get_traced_memory()[1] - held < MOST_MEMORY, words
        kind = words.partition(":")[0]
        refused[kind] = refused.get(kind, 0) + (found is None)
        if found is None or kind == "rewritten":
            continue  # a number that is still one may be any other
        assert len(found.notices) == 1, words
        assert not changed.endswith(MCAP_MAGIC), words
        assert len(found.bursts) <= len(depths), words
        same = [np.array_equal(b.read().depths, d) for b, d in zip(found.bursts, depths, strict=False)]
        assert all(same), words
    tracemalloc.stop()
    return refused


def test_some_damaged_recordings(recorded, tmp_path: Path):
    """A few dozen, of every kind; flipped bits never pass where the file still has its end."""
    refused = check_damages(recorded.path.read_bytes(), tmp_path, n=60, seed=0)
    assert all(refused[kind] > 0 for kind in ("cut", "flipped", "shuffled", "oversized", "rewritten"))


@pytest.mark.slow
def test_a_thousand_damaged_recordings(recorded, tmp_path: Path):
    """The same at large."""
    refused = check_damages(recorded.path.read_bytes(), tmp_path, n=1000, seed=1)
    assert refused["flipped"] > 190  # of 200: all but flips in the last eight bytes


@pytest.mark.parametrize("seed", [0, pytest.param(range(1, 15), marks=pytest.mark.slow)])
def test_damaged_recordings_of_others(tmp_path: Path, seed: int | range):
    """rosbags takes .db3 and .bag apart, which have no checksums: whatever it raises becomes our one line."""
    folder = write_rosbag2(tmp_path / "bag", [INFO, *stamped(), *frames()])
    lone = next(folder.glob("*.db3"))
    info = ("/camera/depth/camera_info", camera_info(ROS1), 1)
    bag = write_rosbag1(tmp_path / "a.bag", [info, *transforms(ROS1), *frames(ROS1)])
    for source in (lone, bag):
        path = tmp_path / f"damaged{source.suffix}"
        for one in [seed] if isinstance(seed, int) else seed:
            rng = np.random.default_rng(one)
            for damage in [cut, flipped] * 15:
                path.write_bytes(damage(source.read_bytes(), rng).data)
                outcome(path, CHOICES)


@pytest.mark.parametrize("name", ["empty.mcap", "empty.db3", "empty.bag"])
def test_empty_files_are_refused(tmp_path: Path, name: str):
    """Of every kind."""
    (tmp_path / name).touch()
    assert outcome(tmp_path / name) is None


def test_what_is_no_recording_is_named(tmp_path: Path):
    """A path that leads nowhere, a picture, a folder of anything."""
    (tmp_path / "a.png").touch()
    for path, words in [
        (tmp_path / "none.mcap", "no such file"),
        (tmp_path / "a.png", "is no recording"),
        (tmp_path, "is no recording"),
    ]:
        with pytest.raises(RecordingError, match=words):
            open_recording(path)
