"""A reader learns what a class of the planner, the sensor or the materials holds without leaving it.

Read off the sources, since what is inherited or set while running is not what a reader sees.
"""

import ast
from collections.abc import Iterator

import pytest

from tests.conftest import ROOT

EXPLAINED = ("franbv", "render", "materials")
"""The packages whose classes carry physics and formulas; those of the studies are flags and tables."""
NUMERIC = {"int", "float", "complex", "bool", "ndarray", "Any"}
"""Names in an annotation that say number or array; `Any` stands for the arrays of the device."""
DESCRIPTION = "description"
"""What pydantic calls a field's text; the second argument of a function that makes fields."""


def undocumented(source: str) -> list[str]:
    """Public classes without a docstring of their own, and their numeric fields that neither a text nor it explains."""
    module = ast.parse(source)
    aliases = {
        target.id: node.value
        for node in module.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    classes = [node for node in ast.walk(module) if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    return [fault for node in classes for fault in faults_of(node, aliases)]


def faults_of(node: ast.ClassDef, aliases: dict[str, ast.expr]) -> Iterator[str]:
    """`Class` if it lacks a docstring, `Class.field` for each field that nothing explains."""
    text = ast.get_docstring(node) or ""
    if not text:
        yield node.name
    for field, following in zip(node.body, [*node.body[1:], None], strict=True):
        if not isinstance(field, ast.AnnAssign) or not isinstance(field.target, ast.Name):
            continue
        name = field.target.id
        if name.startswith("_") or not is_numeric(field.annotation, aliases):
            continue
        if not (is_text(following) or is_described(field.value) or f"`{name}`" in text):
            yield f"{node.name}.{name}"


def is_numeric(annotation: ast.expr, aliases: dict[str, ast.expr]) -> bool:
    """Whether a number or an array is in it, behind an alias of the module too."""
    for node in ast.walk(annotation):
        name = node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""
        if name in NUMERIC or (name in aliases and is_numeric(aliases[name], {})):
            return True
    return False


def is_text(node: ast.AST | None) -> bool:
    """Whether it is a string, alone or as a statement, with something in it."""
    value = node.value if isinstance(node, ast.Expr) else node
    return isinstance(value, ast.Constant) and isinstance(value.value, str) and bool(value.value.strip())


def is_described(default: ast.expr | None) -> bool:
    """Whether a field's default is made with a description."""
    if not isinstance(default, ast.Call):
        return False
    named = [keyword.value for keyword in default.keywords if keyword.arg == DESCRIPTION]
    return any(map(is_text, [*named, *default.args[1:2]]))


@pytest.mark.parametrize("package", EXPLAINED)
def test_public_classes_and_their_numbers_are_explained(package: str):
    """Every public class says what it is, and every number and array of it what it means and in which unit."""
    sources = sorted((ROOT / package).rglob("*.py"))
    faults = {path.relative_to(ROOT).as_posix(): undocumented(path.read_text(encoding="utf-8")) for path in sources}
    assert {path: found for path, found in faults.items() if found} == {}


@pytest.mark.parametrize(
    ("body", "faults"),
    [
        ("x: float", ["Thing", "Thing.x"]),
        ("'''A thing.'''\n    x: float", ["Thing.x"]),
        ("'''A thing of x.'''\n    x: float", ["Thing.x"]),  # a letter in a sentence explains nothing
        ("'''A thing.'''\n    x: Float[np.ndarray, 'n 3']", ["Thing.x"]),
        ("'''A thing.'''\n    x: Length = 1.0", ["Thing.x"]),
        ("'''A thing.'''\n    x: Length = Field(gt=0)", ["Thing.x"]),
        ("'''A thing.'''\n    x: tuple[int, ...]\n    ''''''", ["Thing.x"]),
        ("'''A thing.'''\n    x: float\n    y: float\n    '''Height [m].'''", ["Thing.x"]),
        ("'''A thing.'''\n    def f(self):\n        '''Not the thing's.'''\n    x: Any", ["Thing.x"]),
        ("'''A thing.'''\n    x: float\n    '''Length [m].'''", []),
        ("'''A thing; `x` is its length [m].'''\n    x: float", []),
        ("'''A thing.'''\n    x: Length = Field(1.0, description='Length [m].')", []),
        ("'''A thing.'''\n    x: Length = _number(1.0, 'Length [m].')", []),
        ("'''A thing.'''\n    x: str\n    _y: float", []),
    ],
)
def test_what_counts_as_explained(body: str, faults: list[str]):
    """The rule itself, on a class written for it: by hand, a fault for everything that a reader would have to guess."""
    assert undocumented(f"Length = Annotated[float, Field(gt=0)]\nclass Thing(Base):\n    {body}\n") == faults


def test_private_classes_may_be_silent():
    """They have no readers but those of their module."""
    assert undocumented("class _Thing:\n    x: float\n") == []


def test_a_class_inside_a_function_is_public_too():
    """The renderer's plugins can only be written where a variant has been chosen."""
    assert undocumented("def make():\n    class Plugin(mi.BSDF):\n        pass\n") == ["Plugin"]
