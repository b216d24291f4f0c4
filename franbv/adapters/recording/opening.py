"""Opens a recording by what it is, and says which extra is missing where one is."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from franbv.adapters.recording.bags.choices import BagChoices
from franbv.adapters.recording.contents import Recording, RecordingError

KINDS = (".mcap", ".db3", ".bag")
"""Suffixes of the files that can be read; a folder of rosbag2 can, too."""
PACKAGES_OF_EXTRA = ("mcap", "zstandard", "rosbags", "apsw", "lz4")
"""What the extra `record` brings; lz4 is needed by mcap and rosbags."""


@contextmanager
def record_extra() -> Iterator[None]:
    """RecordingError where a package of the extra is asked for and not installed."""
    try:
        yield
    except ImportError as error:
        if (error.name or "").split(".")[0] not in PACKAGES_OF_EXTRA:
            raise
        raise RecordingError(f"recordings need the package {error.name}; pip install 'franbv[record]'") from error


def open_recording(path: Path, choices: BagChoices | None = None) -> Recording:
    """The recording; choices: what one that is not ours leaves open."""
    if not path.exists():
        raise RecordingError(f"{path}: no such file; give a recording")
    is_folder = path.is_dir()
    if path.suffix not in KINDS and not (is_folder and (path / "metadata.yaml").is_file()):
        raise RecordingError(f"{path}: is no recording; give a file {', '.join(KINDS)} or a folder of rosbag2")
    with record_extra():
        if not is_folder and is_ours(path):
            from franbv.adapters.recording.mcap_recording import read_recording

            return read_recording(path)
        from franbv.adapters.recording.bags.reading import read_bag

        return read_bag(path, choices or BagChoices())


def is_ours(path: Path) -> bool:
    """Whether the file was written by `franbv.adapters.recording.writer`."""
    if path.suffix != ".mcap":
        return False
    with record_extra():
        from franbv.adapters.recording.mcap_records import profile_of
        from franbv.adapters.recording.topics import PROFILE

        try:
            profile = profile_of(path)
        except OSError as error:
            raise RecordingError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    return profile in (PROFILE, None)  # what is no MCAP file at all is told so by our own reader
