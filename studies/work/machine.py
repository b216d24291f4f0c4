"""The machine in one line, to stand beside measured times."""

import os
import platform
from pathlib import Path

from studies.work.workers import usable_processors


def machine() -> str:
    """Processor, its count, how busy others keep it, Python."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    model = names[0] if names else platform.processor() or platform.machine()
    load = f"load {os.getloadavg()[0]:.1f}, " if hasattr(os, "getloadavg") else ""
    return f"{usable_processors()} x {model}, {load}Python {platform.python_version()}"
