"""The adapters' commands for a computer that has the planner and no studies: `python -m franbv.adapters`."""

import argparse
import sys
from collections.abc import Sequence

from franbv.adapters.camera_error import CameraError
from franbv.adapters.realsense import commands as realsense
from franbv.adapters.recording import command as recording
from franbv.adapters.recording.contents import RecordingError
from franbv.adapters.view.sight import ViewError


def run(args: Sequence[str]) -> int:
    """Exit status: 0 done, 1 a check failed, 2 bad input or a camera that does not deliver, in one line."""
    parser = argparse.ArgumentParser("python -m franbv.adapters", description="Real cameras and recordings of them.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    realsense.add_commands(commands)
    recording.add_recording_commands(commands)
    flags = parser.parse_args(args)
    try:
        return flags.run(flags)
    except (CameraError, RecordingError, ViewError) as error:
        sys.stderr.write(f"franbv.adapters: {' '.join(str(error).split())}\n")
        return 2


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
