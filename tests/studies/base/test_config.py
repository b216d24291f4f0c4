"""Configuration files: what they hold is what the run uses, and every mistake is one line with the nearest key."""

from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.base.config import Config, load_config
from studies.base.flags import parse_case_command


class Inner(Config):
    voxel_size: float = 0.0075
    count: int = 3


class Settings(Config):
    part: str | None = None
    seed: int = 0
    inner: Inner = Inner()


def _file(folder: Path, text: str) -> Path:
    path = folder / "run.yaml"
    path.write_text(text)
    return path


def test_file_overrides_defaults_and_flags_override_the_file(tmp_path: Path):
    """The order of the contract: defaults, then file, then flags, key by key and also inside a nested model."""
    path = _file(tmp_path, "part: C\nseed: 5\ninner: {count: 7}\n")
    args = ["--out", "x", "--config", str(path), "--seed", "6", "--inner.voxel-size", "0.01"]
    settings = parse_case_command(Settings, args, "franbv frame", "").settings
    assert settings == Settings(part="C", seed=6, inner=Inner(voxel_size=0.01, count=7))


def test_empty_file_means_defaults(tmp_path: Path):
    """A YAML file with only comments holds no keys."""
    assert load_config(Settings, _file(tmp_path, "# nothing yet\n")) == Settings()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("sede: 3\n", r"run\.yaml: unknown key `sede`; did you mean seed\?"),
        ("inner: {voxl_size: 1}\n", r"unknown key `inner\.voxl_size`; did you mean voxel_size\?"),
        ("zzz: 3\n", "unknown key `zzz`; known: part, seed, inner"),
        ("seed: many\n", r"`seed` = 'many': .*integer"),
        ("inner: {voxel_size: .inf}\n", "finite"),
        ("inner: {voxel_size: .nan}\n", "finite"),
        ("- seed\n", "holds a list, not keys"),
        ("part: [D\n", r"run\.yaml: line 2, column 1 .*mend the YAML"),
        ("part: !!python/object:os.system {}\n", "mend the YAML"),
    ],
)
def test_mistakes_in_a_file_are_one_line_with_file_key_and_mend(tmp_path: Path, text: str, expected: str):
    """The line names the file and the key; an unknown key comes with the nearest known one."""
    with pytest.raises(InputError, match=expected) as error:
        load_config(Settings, _file(tmp_path, text))
    assert "\n" not in str(error.value)
    assert "run.yaml" in str(error.value)


def test_missing_file_and_binary_file_are_one_line(tmp_path: Path):
    """Neither a traceback of the YAML reader nor of the text decoder."""
    with pytest.raises(InputError, match="no such file"):
        load_config(Settings, tmp_path / "none.yaml")
    binary = tmp_path / "photo.yaml"
    binary.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(InputError, match="cannot be read as text"):
        load_config(Settings, binary)
    with pytest.raises(InputError, match="cannot be read as text"):
        load_config(Settings, tmp_path)


@pytest.mark.parametrize(
    ("args", "expected"),
    [
        (["--out", "x", "--prat", "D"], r"unrecognized options: --prat, D; Perhaps you meant: --part"),
        (["--out", "x", "--seed", "many"], r"error parsing --seed: .*'many'"),
        (["--out", "x", "--inner.voxel-size", "inf"], "finite"),
        (["--part", "D"], "missing .*--out PATH"),
        (["--out", "x", "--config", "none.yaml"], r"none\.yaml: no such file"),
    ],
)
def test_mistakes_in_flags_are_one_line(args: list[str], expected: str):
    """The boxes that the flag parser draws are condensed; its suggestion stays."""
    with pytest.raises(InputError, match=expected) as error:
        parse_case_command(Settings, args, "franbv frame", "")
    assert "\n" not in str(error.value)
    assert "─" not in str(error.value)
