"""The resolved preset of a study as its folder keeps it, so that its page can be made from the folder alone."""

import json
from pathlib import Path

from pydantic import BaseModel

from materials.input_error import InputError
from studies.base.atomic_file import write_atomically
from studies.base.config import AnyConfig, validated
from studies.base.console import strict_json
from studies.base.reading import reading


def write_preset_file(path: Path, preset: BaseModel, version: int) -> None:
    """Put down what the study is. version: of the file; it rises when the study's cases come to go by other names."""
    stored = {"format": version, "preset": preset.model_dump(mode="json")}
    write_atomically(path, strict_json(stored, indent=1).encode())


def read_preset_file(path: Path, model: type[AnyConfig], version: int) -> AnyConfig:
    """What the study is; InputError where it cannot be read, or is of another format: its cases go by other names, so
    that none of them would be found."""
    with reading(path, "give the study's command again"):
        stored = json.loads(path.read_text(encoding="utf-8"))
        found = stored.get("format", 1)
    if found != version:
        raise InputError(
            f"{path}: was written by an older or newer version (format {found}, here {version}); read it with that "
            "version, or give the study's command again with another --out"
        )
    return validated(model, stored["preset"], str(path))
