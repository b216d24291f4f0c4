"""The adapters' commands for a computer that has the planner and no studies: `python -m franbv.adapters`."""

import argparse
import sys
from collections.abc import Sequence

from franbv.adapters.calibration.calibration_error import CalibrationError
from franbv.adapters.calibration.command import add_calibration_commands
from franbv.adapters.live.command import ONE_LINE, add_live_commands
from franbv.adapters.live.record_command import add_record_command
from franbv.adapters.realsense import commands as realsense
from franbv.adapters.recording import command as recording
from franbv.adapters.view.sight import ViewError


def run(args: Sequence[str], program: str = "") -> int:
    """Exit status: 0 done, 1 a check failed, 2 bad input or a camera that does not deliver, in one line.

    program: how it was called, where that was not `python -m franbv.adapters`.
    """
    parser = argparse.ArgumentParser(
        program or "python -m franbv.adapters",
        description="Real cameras and arms, their calibration, and recordings of them.",
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    realsense.add_commands(commands)
    recording.add_recording_commands(commands)
    add_calibration_commands(commands)
    add_live_commands(commands)
    add_record_command(commands)
    flags = parser.parse_args(args)
    try:
        return flags.run(flags)
    except (*ONE_LINE, CalibrationError, ViewError) as error:
        name = f"{program} {args[0]}" if program else "franbv.adapters"
        sys.stderr.write(f"{name}: {' '.join(str(error).split())}\n")
        return 2


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
