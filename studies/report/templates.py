"""The templates and style sheets of the reports, and the filters that the templates use."""

import re
from functools import cache
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from studies.run_words import number, percent


@cache
def environment() -> Environment:
    """Where the templates are; a name that a template does not know is an error."""
    environment = Environment(
        loader=PackageLoader("studies.report", "."),
        autoescape=select_autoescape(["html", "j2"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["percent"] = percent
    environment.filters["number"] = number
    environment.filters["unbroken"] = unbroken
    return environment


def unbroken(text: str) -> str:
    """The text with numbers and their units kept on one line."""
    return re.sub(r"(?<=\d) (?=%|mm\b|s\b)", "\u00a0", text)


def asset(name: str) -> str:
    """A style sheet or script beside the templates."""
    return files("studies.report").joinpath(name).read_text(encoding="utf-8")
