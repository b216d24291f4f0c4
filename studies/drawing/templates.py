"""The templates and style sheets of the reports, and the filters that the templates use."""

import re
from functools import cache
from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from studies.base.numbers_as_text import number, percent


@cache
def environment(package: str) -> Environment:
    """The templates that stand beside the modules of a package; a name that a template does not know is an error."""
    environment = Environment(
        loader=PackageLoader(package, "."),
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


def asset(package: str, name: str) -> str:
    """A style sheet or script that stands beside the modules of a package."""
    return files(package).joinpath(name).read_text(encoding="utf-8")


def page_style(*more: tuple[str, str]) -> Markup:
    """The style sheet of all pages, and those of one page: (package, name) of each."""
    return Markup("".join(asset(*sheet) for sheet in (("studies.drawing", "style.css"), *more)))
