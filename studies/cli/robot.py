"""The adapters' commands under the name of the tool: what needs a camera or an arm, and no simulator."""

from franbv.adapters.__main__ import run as run_adapters


def run(args: list[str]) -> int:
    """`franbv run`."""
    return run_adapters(["run", *args], "franbv")


def record(args: list[str]) -> int:
    """`franbv record`."""
    return run_adapters(["record", *args], "franbv")


def cameras(args: list[str]) -> int:
    """`franbv cameras`."""
    return run_adapters(["cameras", *args], "franbv")
