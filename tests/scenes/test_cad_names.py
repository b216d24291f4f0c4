"""Any body of a file can be given a material, whatever its name; any name of a file can be read."""

import os
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from scenes.cad.cad_file import distinct_names, file_name
from scenes.cad_files import read_cad_file
from scenes.part_materials import part_materials
from scenes.user_mesh import load_user_part

CORPUS = Path(__file__).parents[1] / "corpus" / "files"
NAMES = ["M6=A2", "stift@2", "Flansch Ø40 'A'", "#1", "a b", "iron", 'say "x"', "stift@2=a"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("spec", ["iron:ground", "brass:polished@alpha=0.1", "aluminium:brushed@alpha=0.05,0.2"])
def test_every_name_takes_every_material(name, spec):
    """The word is cut where a material begins, whatever equals signs and at signs the name has."""
    (found,) = part_materials([f"{name}={spec}"]).for_bodies("f", [name])
    assert found.name == spec
    (quoted,) = part_materials([f'"{name}"={spec}']).for_bodies("f", [name])
    assert quoted.name == spec


def test_numbers_address_bodies_but_a_name_wins():
    """`#2` is the second of the list; where a body has that very name, it is meant."""
    chosen = part_materials(["iron:ground", "#2=brass:polished"])
    assert [m.name for m in chosen.for_bodies("f", ["a", "b", "c"])] == ["iron:ground", "brass:polished", "iron:ground"]
    assert [m.name for m in chosen.for_bodies("f", ["#2", "b"])] == ["brass:polished", "iron:ground"]
    with pytest.raises(InputError, match=r"^f: there is no body #4 to give a material to"):
        part_materials(["iron:ground", "#4=brass:polished"]).for_bodies("f", ["a", "b", "c"])


def test_a_letter_and_its_accent_are_the_letter_with_it():
    """Systems write the same umlaut as one sign or as two."""
    (found,) = part_materials(["Ko\u0308rper=iron:ground"]).for_bodies("f", ["K\u00f6rper"])
    assert found.name == "iron:ground"


def test_messages_list_the_bodies_and_can_be_followed():
    """The word that the message advises gives the body its material; a name that nobody can type goes by number."""
    for names in (["it's", "other"], ["a\u0007b", "other"]):
        with pytest.raises(InputError) as caught:
            part_materials(["other=iron:ground"]).for_bodies("f", names)
        assert f"bodies by number: #1 {names[0]}, #2 other" in str(caught.value)
        found = re.search(r"pass --material (.*); bodies", str(caught.value))
        assert found is not None
        (word,) = shlex.split(found[1])
        word = word.replace("metal:finish", "brass:polished")
        chosen = part_materials(["other=iron:ground", word]).for_bodies("f", names)
        assert [m.name for m in chosen] == ["brass:polished", "iron:ground"]


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("M6=A2=iron:grund", "iron:grund: unknown finish grund; did you mean ground?"),
        ("bolt=brass:ground@alpha=x", "brass:ground@alpha=x: cannot read the roughness"),
        ("brass:ground@alpha=x", "brass:ground@alpha=x: cannot read the roughness"),
        ("=iron:ground", "=iron:ground: cannot tell body from material; write body=metal:finish"),
        ("bolt=", "bolt=: cannot tell body from material; write body=metal:finish"),
        ("stift@2=irn:ground", "irn:ground: unknown material"),
    ],
)
def test_a_wrong_material_is_named_without_the_body(word, message):
    """The message is about the material, where there is one."""
    with pytest.raises(InputError) as caught:
        part_materials([word])
    assert str(caught.value).startswith(message)


def test_names_become_distinct_and_printable():
    """Twice the same, nothing, blanks, line breaks; a name that another would have become."""
    made = distinct_names(["bolt", "bolt", "bolt_1", "", " a \n b ", "x\u0000y"])
    assert made == ["bolt", "bolt_1", "bolt_1_1", "body", "a b", "xy"]


def test_a_file_name_of_another_charset_is_read(tmp_path):
    """`K\\xf6rper.stl` of an old disk: loads, and its name is text that can be written anywhere."""
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/K\xf6rper.stl"))
    try:
        shutil.copy(CORPUS / "binary.stl", path)
    except OSError:
        pytest.skip("this disk takes names in UTF-8 alone")
    part = load_user_part(path, "mm", part_materials(["iron:ground"]))
    assert (part.name, part.bodies[0].name, file_name(path)) == ("Körper", "Körper", "Körper.stl")


def test_our_own_mistakes_are_not_called_the_files(monkeypatch):
    """A bug in a reader shows as what it is."""
    monkeypatch.setattr(np, "frombuffer", lambda *args, **more: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        read_cad_file(CORPUS / "binary.stl")
