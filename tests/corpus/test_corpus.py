"""Every file of the corpus gives the bodies, places, sizes and volumes of its table, or is refused in one line."""

import functools
import importlib.util
from pathlib import Path

import numpy as np
import pytest

from materials.input_error import InputError
from scenes import user_mesh
from scenes.cad.cad_file import CadFile
from scenes.cad_files import read_cad_file
from scenes.cad_units import METRES
from scenes.part_materials import part_materials
from scenes.topology import signed_volume
from scenes.user_mesh import load_user_part
from tests.corpus.make_corpus import CORPUS, FOLDER
from tests.corpus.table import Case

IRON = part_materials(["iron:ground"])
MOST_BYTES_OF_CORPUS = 500_000
VOLUME_TOLERANCE = 1e-5
"""Relative; 32-bit coordinates round."""
READABLE = [case for case in CORPUS if case.bodies]
REFUSED = [case for case in CORPUS if case.refusal]


@functools.cache
def read_once(path: Path) -> CadFile:
    """Reading takes a process for STEP; the tests share it."""
    return read_cad_file(path)


def names(case: Case) -> str:
    """For the name of the test."""
    return case.file


def needs_extra(case: Case) -> None:
    """Skip STEP where its reader is not installed."""
    if case.file.endswith("step") and importlib.util.find_spec("cascadio") is None:
        pytest.skip("needs the extra `step`")


def test_the_committed_files_are_those_that_the_script_makes():
    """Same bytes, no file too many, each either readable or refused, the whole small."""
    assert {path.name for path in FOLDER.iterdir()} == {case.file for case in CORPUS}
    assert len({case.file for case in CORPUS}) == len(CORPUS)
    for case in CORPUS:
        assert (FOLDER / case.file).read_bytes() == case.make(), case.file
        assert bool(case.bodies) != bool(case.refusal), case.file
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < MOST_BYTES_OF_CORPUS


@pytest.mark.parametrize("case", READABLE, ids=names)
def test_bodies_stand_where_the_file_says(case: Case):
    """Box and volume of every body, under its name, from the closed forms of the table."""
    needs_extra(case)
    read = read_once(FOLDER / case.file)
    mm = 1000 * METRES[case.units if case.units and not case.file.endswith("step") else "m"]
    assert [body.name for body in read.bodies] == sorted(case.bodies)
    for body in read.bodies:
        expected = case.bodies[body.name]
        np.testing.assert_allclose(body.vertices.min(axis=0) * mm, expected.low, atol=case.position_tolerance)
        np.testing.assert_allclose(body.vertices.max(axis=0) * mm, expected.high, atol=case.position_tolerance)
        volume = signed_volume(body.vertices, body.faces) * mm**3
        assert abs(volume - expected.volume) <= VOLUME_TOLERANCE * expected.volume + expected.slack


@pytest.mark.parametrize("case", READABLE, ids=names)
def test_parts_keep_their_size_and_say_what_is_wrong(monkeypatch, case: Case):
    """The part on the table is as large as its bodies together; notices are those of the table and no others."""
    needs_extra(case)
    monkeypatch.setattr(user_mesh, "read_cad_file", read_once)
    part = load_user_part(FOLDER / case.file, case.units, IRON, up="z")
    corners = np.concatenate([body.mesh.vertices for body in part.bodies])
    low = np.min([body.low for body in case.bodies.values()], axis=0)
    high = np.max([body.high for body in case.bodies.values()], axis=0)
    np.testing.assert_allclose(np.ptp(corners, axis=0) * 1000, high - low, atol=2 * case.position_tolerance)
    assert len(part.notices) == len(case.notices), part.notices
    for notice, words in zip(part.notices, case.notices, strict=True):
        assert notice.startswith(f"{FOLDER / case.file}: ")
        assert words in notice


@pytest.mark.parametrize("case", REFUSED, ids=names)
def test_what_cannot_be_read_is_refused_in_one_line(case: Case):
    """The message names the file, what is wrong, and where."""
    needs_extra(case)
    with pytest.raises(InputError) as caught:
        load_user_part(FOLDER / case.file, case.units, IRON)
    assert str(caught.value).startswith(f"{FOLDER / case.file}: ")
    assert case.refusal in str(caught.value)
    assert "\n" not in str(caught.value)
