"""What a CAD file is called and made of on the command line: names that are no UTF-8, a material flag for each body."""

import os
from pathlib import Path

import pytest

from studies.base.flags import parse_case_command
from studies.run.scene_settings import SubjectSettings, build_subject, resolved

STL = b"solid a\n" + b"".join(
    b"facet normal 0 0 0\nouter loop\nvertex %s\nvertex %s\nvertex %s\nendloop\nendfacet\n" % corners
    for corners in (
        (b"0 0 0", b"0 30 0", b"30 0 0"),
        (b"0 0 0", b"30 0 0", b"0 0 30"),
        (b"30 0 0", b"0 30 0", b"0 0 30"),
        (b"0 30 0", b"0 0 0", b"0 0 30"),
    )
)


def test_title_and_settings_are_text(tmp_path):
    """The byte F6 is an o with two dots in Latin-1, whatever the system's charset."""
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/K\xf6rper.stl"))
    try:
        path.write_bytes(STL + b"endsolid a\n")
    except OSError:
        pytest.skip("this disk takes names in UTF-8 alone")
    settings = SubjectSettings(mesh=path, units="mm", material=("iron:ground",))
    subject = build_subject(settings)
    assert subject.title == "Körper.stl, iron:ground"
    assert subject.notices == ()
    assert resolved(settings).mesh == Path("Körper.stl")
    assert "Körper.stl" in resolved(settings).model_dump_json()


@pytest.mark.parametrize(
    "words",
    [
        ["--material", "a=iron:ground", "b=brass:polished"],
        ["--material", "a=iron:ground", "--material", "b=brass:polished"],
        ["--material=a=iron:ground", "--units", "mm", "--material=b=brass:polished"],
        ["--material", "a=iron:ground", "--up", "z", "--material", "b=brass:polished"],
    ],
)
def test_a_material_flag_for_each_body_counts(words):
    """Each may have its own flag, as the message for a body without a material advises; none is dropped."""
    command = parse_case_command(SubjectSettings, ["--out", "o", "--mesh", "x.stl", *words], "franbv frame", "")
    assert command.settings.material == ("a=iron:ground", "b=brass:polished")
    assert command.settings.mesh == Path("x.stl")
