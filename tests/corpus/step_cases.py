"""STEP files of the corpus."""

import numpy as np

from tests.corpus.solids import ANGLE, BASE, KNOB
from tests.corpus.step_writer import Step
from tests.corpus.table import Case, Truth, truth

RED, BLUE, GREY = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.5, 0.5, 0.5)
STRANGE = ("M6=A2", "stift@2", "Flansch \\X2\\00D8\\X0\\40 ''A''", "#1")
"""Names as the file spells them."""


def _single(unit: str = "mm") -> bytes:
    file = Step(unit)
    file.part("angle", file.solid(ANGLE)[0])
    return file.text()


def _coloured() -> bytes:
    """Grey, one face red and one blue."""
    file = Step()
    solid, faces = file.solid(BASE)
    file.part("base", solid)
    file.colour([(solid, GREY), (faces[0], RED), (faces[3], BLUE)])
    return file.text()


def _assembly() -> bytes:
    """A base and two of one knob: beside it, and on it, turned by 90 deg about x, so that its y looks up."""
    file = Step()
    base = file.part("base", file.solid(BASE)[0])
    knob = file.part("knob", file.solid(KNOB.moved(-50, 0, 0))[0])
    beside, on_top = file.placement((50, 0, 0)), file.placement((0, 10, 20), z=(0, -1, 0))
    file.assembly("all", [("base", base, file.placement((0, 0, 0))), ("left", knob, beside), ("up", knob, on_top)])
    return file.text()


def _names() -> bytes:
    file = Step()
    instances = []
    for number, name in enumerate((*STRANGE, STRANGE[0])):
        part = file.part(name, file.solid(KNOB.moved(-50, 0, 0))[0])
        instances.append((name, part, file.placement((20 * number, 0, 0))))
    file.assembly("all", instances)
    return file.text()


def _knob_at(x: float) -> Truth:
    return truth(KNOB.moved(x - 50, 0, 0))


def _dangling() -> bytes:
    """An entity too many refers to one that is not there."""
    file = Step()
    file.part("angle", file.solid(ANGLE)[0])
    file.add("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#99999))")
    return file.text()


def _face_lost() -> bytes:
    """The plane of a face is no plane."""
    return _single().replace(b"PLANE('',", b"POINT('',", 1)


def _step(file: str, trouble: str, make, **what) -> Case:
    return Case(f"{file}.step", trouble, make, **what)


STEP_CASES = (
    _step("millimetres", "plain", _single, bodies={"millimetres": truth(ANGLE)}, units="mm"),
    _step("inches", "another unit", lambda: _single("in"), bodies={"inches": truth(ANGLE)}),
    _step("metres", "another unit", lambda: _single("m"), bodies={"metres": truth(ANGLE)}),
    _step(
        "inches_called_mm",
        "a unit of the user's against the file's own",
        lambda: _single("in"),
        bodies={"inches_called_mm": truth(ANGLE)},
        units="mm",
        notices=("the file states its own unit, in, which is taken",),
    ),
    _step("coloured", "colours of single faces", _coloured, bodies={"coloured": truth(BASE)}),
    _step(
        "assembly",
        "one part in two places",
        _assembly,
        bodies={
            "base": truth(BASE),
            "left": truth(KNOB),
            "up": Truth(np.array([0.0, 0, 20]), np.array([10.0, 10, 30]), 1000),
        },
    ),
    _step(
        "names",
        "names with signs of ours, of Unicode, and twice the same",
        _names,
        bodies={
            "M6=A2": _knob_at(0),
            "stift@2": _knob_at(20),
            "Flansch Ø40 'A'": _knob_at(40),
            "#1": _knob_at(60),
            "M6=A2_1": _knob_at(80),
        },
    ),
    _step(
        "dangling",
        "an entity that is not there",
        _dangling,
        bodies={"dangling": truth(ANGLE)},
        notices=("entity #99999 is referred to", "Open CASCADE says: ERR StepReaderData : Unresolved Reference"),
    ),
    _step(
        "face_lost",
        "a face that cannot be made",
        _face_lost,
        bodies={"face_lost": truth(ANGLE, slack=np.inf)},
        notices=("1 of its 8 faces could not be made", "the surface is open"),
    ),
    _step("cut", "cut off", lambda: _single()[:-600], refusal="the file is cut off: it has no `END-ISO-10303-21;`"),
    _step("not_step", "another file", lambda: b"solid angle\n", refusal="it does not begin with `ISO-10303-21;`"),
    _step(
        "no_shape",
        "no shape in it",
        lambda: Step().text(),
        refusal="Failed to transfer STEP data",
    ),
)
