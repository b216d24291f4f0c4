"""Configurations: frozen models read from YAML and flags, with one-line errors that name file, key and nearest key."""

import math
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from types import UnionType
from typing import Any, TypeVar, Union, get_args, get_origin

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from materials.input_error import InputError
from materials.suggestion import suggest


class Config(BaseModel):
    """Base of every configuration: frozen, no unknown keys, finite numbers, docstrings as descriptions."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True)


AnyConfig = TypeVar("AnyConfig", bound=BaseModel)


AnyPreset = TypeVar("AnyPreset", bound="Preset")


class Preset(Config):
    """A whole study's settings, some of which are files of ours."""

    @classmethod
    def of_ours(cls) -> dict[str, Path]:
        """Files of the folder `presets` beside the model's module, by name."""
        folder = files(cls.__module__.rpartition(".")[0]) / "presets"
        return {path.stem: path for path in sorted(map(Path, map(str, folder.iterdir()))) if path.suffix == ".yaml"}

    @classmethod
    def named(cls: type[AnyPreset], name: str) -> AnyPreset:
        """One of ours by name, or one of the user's by file; InputError in one line otherwise."""
        known = cls.of_ours()
        if name not in known and not name.endswith((".yaml", ".yml")):
            raise InputError(f"preset {name}: there is none; {suggest(name, known)}, or give a YAML file")
        return load_config(cls, known.get(name, Path(name)))


def load_config(model: type[AnyConfig], path: Path) -> AnyConfig:
    """The configuration that a YAML file holds; keys that it leaves out keep their defaults."""
    return validated(model, read_yaml(path), str(path))


def overlaid(config: AnyConfig, path: Path, apart: str = "") -> AnyConfig:
    """The configuration with what a YAML file says in its place, key by key. apart: a key of the file that is somebody
    else's."""
    stated = {key: value for key, value in read_yaml(path).items() if key != apart}
    return validated(type(config), _merged(config.model_dump(), stated), str(path))


def _merged(under: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    both = {key: (under[key], over[key]) for key in under.keys() & over.keys()}
    nested = {key: _merged(*pair) for key, pair in both.items() if all(isinstance(one, dict) for one in pair)}
    return {**under, **over, **nested}


def read_yaml(path: Path) -> dict[str, Any]:
    """The mapping that a YAML file holds (an empty file holds an empty one)."""
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as text ({error}); give a YAML file") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f" line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = getattr(error, "problem", None) or "cannot be parsed"
        raise InputError(f"{path}:{place} {problem}; mend the YAML there") from None
    if data is None:
        return {}
    if not isinstance(data, dict):
        raise InputError(f"{path}: holds a {type(data).__name__}, not keys with values; write lines like `seed: 0`")
    return data


def validated(model: type[AnyConfig], data: dict[str, Any], source: str) -> AnyConfig:
    """`data` as a model; InputError with one line when it does not fit."""
    try:
        config = model.model_validate(data)
    except ValidationError as error:
        raise InputError(validation_line(error, source, model)) from None
    check_finite(config, source)
    return config


def check_finite(config: BaseModel, source: str) -> None:
    """InputError when any number in the configuration, nested models included, is infinite or NaN."""
    for key, value in _numbers("", config.model_dump()):
        if not math.isfinite(value):
            raise InputError(f"{source}: `{key}` = {value}: is not a finite number; change it")


def _numbers(key: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _numbers(f"{key}.{name}" if key else str(name), inner)
    elif isinstance(value, list | tuple):
        for inner in value:
            yield from _numbers(key, inner)
    elif isinstance(value, float):
        yield key, value


def validation_line(error: ValidationError, source: str, model: type[BaseModel] | None = None) -> str:
    """The first problem of a validation: source, key, what is wrong, and the nearest known key for an unknown one."""
    problems = error.errors(include_url=False)
    first = next((p for p in problems if p["type"] == "extra_forbidden"), problems[0])
    key = ".".join(str(part) for part in first["loc"])
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    if first["type"] == "extra_forbidden" and model is not None:
        return f"{source}: unknown key `{key}`{more}; {nearest_key(model, first['loc'])}"
    if first["loc"][-1:] == ("[key]",) and isinstance(first["input"], bool):
        place = ".".join(str(part) for part in first["loc"][:-2])
        return f'{source}: `{place}`: YAML takes a bare on, off, yes or no for a truth value{more}; quote it: "off"'
    message = first["msg"].removeprefix("Value error, ")
    message = message[0].lower() + message[1:]
    if not key:
        return f"{source}: {message}{more}"
    return f"{source}: `{key}` = {_short(first['input'])}: {message}{more}; change it"


def nearest_key(model: type[BaseModel], location: tuple[int | str, ...]) -> str:
    """The known keys nearest to the unknown one at `location`, or all that may stand there."""
    *parents, unknown = location
    fields = _fields_at(model, parents)
    return suggest(str(unknown), fields)


def _fields_at(model: type[BaseModel], parents: list[int | str]) -> list[str]:
    for parent in parents:
        field = model.model_fields.get(str(parent))
        nested = _nested_model(field.annotation) if field else None
        if nested is None:
            break
        model = nested
    return list(model.model_fields)


def _nested_model(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if get_origin(annotation) in (Union, UnionType):
        return next((found for part in get_args(annotation) if (found := _nested_model(part))), None)
    return None


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
