"""What pydantic finds wrong with stated settings, as part of a line for people."""

from pydantic import ValidationError


def first_fault(error: ValidationError, whole: str) -> str:
    """`place: message` of the first fault; whole: what it is called where the settings contradict each other."""
    first = error.errors(include_url=False)[0]
    place = ".".join(str(part) for part in first["loc"] if not str(part).startswith("tuple[")) or whole
    return f"{place}: {first['msg'].removeprefix('Value error, ')}"
