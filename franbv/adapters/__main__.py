"""The adapters' commands for a computer that has the planner and no studies: `python -m franbv.adapters`."""

import argparse
import sys
from collections.abc import Sequence

from franbv.adapters.recording import command as recording
from franbv.adapters.recording.contents import RecordingError


def run(args: Sequence[str]) -> int:
    """Exit status: 0 done, 2 bad input, in one line."""
    parser = argparse.ArgumentParser("python -m franbv.adapters", description="Real cells and recordings of them.")
    recording.add_recording_commands(parser.add_subparsers(required=True, metavar="COMMAND"))
    flags = parser.parse_args(args)
    try:
        return flags.run(flags)
    except RecordingError as error:
        sys.stderr.write(f"franbv.adapters: {' '.join(str(error).split())}\n")
        return 2


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
