"""Settings out of YAML files."""

from pathlib import Path
from typing import Any

import yaml

from franbv.adapters.live.cell import CellError


def stated_in(path: Path | None) -> dict[str, Any]:
    """What a file says, nothing where there is none; CellError where it cannot be read."""
    if path is None:
        return {}
    try:
        stated = yaml.safe_load(path.read_text())
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise CellError(f"{path}: cannot be read ({' '.join(str(error).split())}); give a YAML file") from None
    if not isinstance(stated, dict):
        raise CellError(f"{path}: has no settings; give names and values")
    return stated
