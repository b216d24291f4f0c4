"""CAD files that users bring: units, names, materials, rest on the table, and a line for everything that is wrong."""

import importlib.util
import json
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh

from materials.input_error import InputError
from scenes import cad_files
from scenes.part_materials import PartMaterials, part_materials
from scenes.topology import open_edge_count, signed_volume
from scenes.user_mesh import UserPart, load_user_part
from tests.scenes.tangents import u_directions, unit_normals

STEEL = part_materials(["stainless_austenitic:ground"])


def stored(folder: Path, name: str, mesh: trimesh.Trimesh | trimesh.Scene) -> Path:
    """The mesh in a file of the format that the name says."""
    path = folder / name
    mesh.export(path)
    return path


def box_mm() -> trimesh.Trimesh:
    """100 x 60 x 30 mm, off the origin."""
    made = trimesh.creation.box((100, 60, 30))
    made.apply_translation([400, -20, 77])
    return made


def assembly() -> trimesh.Scene:
    """A base of 100 x 60 x 30 mm with a ball of 20 mm radius 5 mm deep in its top, in metres, in a scene graph."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((0.1, 0.06, 0.03)), node_name="base", geom_name="base")
    shift = trimesh.transformations.translation_matrix([0, 0, 0.03])
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.02)
    scene.add_geometry(ball, node_name="ball", geom_name="ball", transform=shift)
    return scene


def split_into_primitives(path: Path) -> tuple[dict, bytes]:
    """JSON tree and binary chunk of a GLB whose only primitive is cut into one per four triangles."""
    data = path.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    tree, binary = json.loads(data[20 : 20 + length]), data[20 + length + 8 :]
    (primitive,) = tree["meshes"][0]["primitives"]
    indices = tree["accessors"][primitive["indices"]]
    size = {5123: 2, 5125: 4}[indices["componentType"]]
    pieces = []
    for start in range(0, indices["count"], 12):
        pieces.append({**primitive, "indices": len(tree["accessors"])})
        tree["accessors"].append({**indices, "count": 12, "byteOffset": indices.get("byteOffset", 0) + start * size})
    tree["meshes"][0]["primitives"] = pieces
    return tree, binary


def packed(tree: dict, binary: bytes) -> bytes:
    """GLB of a JSON tree and a binary chunk (glTF 2.0, section 4.4)."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(text, b"JSON"), (binary, b"BIN\0")]
    body = b"".join(len(chunk).to_bytes(4, "little") + kind + chunk for chunk, kind in chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


def extent(part: UserPart) -> np.ndarray:
    """Lowest and highest corner of all bodies [m]."""
    corners = np.concatenate([body.mesh.vertices for body in part.bodies])
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


@pytest.mark.parametrize(
    ("suffix", "units", "scale"), [("stl", "mm", 1), ("ply", "cm", 0.1), ("obj", "in", 1 / 25.4), ("glb", "m", 1e-3)]
)
def test_every_format_and_unit_gives_the_same_part(tmp_path, suffix, units, scale):
    """A 100 x 60 x 30 mm box, stored in different units: always 0.1 x 0.06 x 0.03 m on the table, closed, outward, flat
    normals, lay along its length."""
    made = box_mm()
    made.apply_scale(scale)
    part = load_user_part(stored(tmp_path, f"part.{suffix}", made), units, STEEL, up="z")
    np.testing.assert_allclose(extent(part), [[-0.05, -0.03, 0], [0.05, 0.03, 0.03]], atol=1e-6)
    (body,) = part.bodies
    assert (body.name, body.is_part, part.notices) == ("part", True, ())
    assert open_edge_count(body.mesh) == 0
    assert signed_volume(body.mesh.vertices, body.mesh.faces) == pytest.approx(0.1 * 0.06 * 0.03, rel=1e-5)
    assert body.mesh.normals is not None
    np.testing.assert_allclose(body.mesh.normals[body.mesh.faces[:, 0]], unit_normals(body.mesh), atol=1e-5)
    along = np.abs(unit_normals(body.mesh)[:, 0]) < 0.5
    np.testing.assert_allclose(np.abs(u_directions(body.mesh)[along, 0]), 1, atol=1e-5)


def test_glb_bodies_keep_names_places_and_materials(tmp_path):
    """glTF is in metres, and y-up: the file's y becomes z. Each body takes the material of its name."""
    path = stored(tmp_path, "assembly.glb", assembly())
    part = load_user_part(path, None, part_materials(["iron:ground", "ball=brass:polished"]))
    assert {body.name: body.material.name for body in part.bodies} == {"base": "iron:ground", "ball": "brass:polished"}
    assert part.notices == (f"{path}: taken as y-up, as glTF lays down, and turned upright",)
    size = extent(part)[1] - extent(part)[0]
    np.testing.assert_allclose(size, [0.1, 0.065, 0.06], atol=1e-6)
    upright = load_user_part(path, None, STEEL, up="z")
    np.testing.assert_allclose(extent(upright)[1] - extent(upright)[0], [0.1, 0.06, 0.065], atol=1e-6)
    ball = next(body for body in upright.bodies if body.name == "ball")
    middle = (ball.mesh.vertices.min(axis=0) + ball.mesh.vertices.max(axis=0)) / 2
    np.testing.assert_allclose(middle, [0, 0, 0.045], atol=1e-6)


def test_faces_of_a_cad_kernels_glb_are_one_body(tmp_path):
    """CAD kernels write each face as a primitive of its own; together they are one closed body."""
    made = box_mm()
    made.apply_scale(1e-3)
    scene = trimesh.Scene(made)
    path = stored(tmp_path, "faces.glb", scene)
    tree, chunks = split_into_primitives(path)
    path.write_bytes(packed(tree, chunks))
    part = load_user_part(path, None, STEEL, up="z")
    (body,) = part.bodies
    assert part.notices == ()
    assert open_edge_count(body.mesh) == 0
    assert len(body.mesh.faces) == 12


def test_a_gltf_finds_its_buffer_beside_it(tmp_path):
    """A text file names its buffer, blanks spelt as `%20`; without that file it is refused by name."""
    tree, binary = split_into_primitives(stored(tmp_path, "box.glb", trimesh.creation.box((0.1, 0.06, 0.03))))
    tree["buffers"][0]["uri"] = "my%20box.bin"
    path = written(tmp_path, "box.gltf", json.dumps(tree))
    with pytest.raises(InputError, match=r"its buffer my%20box.bin is not beside it"):
        load_user_part(path, None, STEEL)
    (tmp_path / "my box.bin").write_bytes(binary)
    np.testing.assert_allclose(np.ptp(extent(load_user_part(path, None, STEEL, up="z")), axis=0), [0.1, 0.06, 0.03])


def test_obj_objects_are_bodies(tmp_path):
    """`o` lines name bodies."""
    part = load_user_part(stored(tmp_path, "two.obj", assembly()), "m", STEEL)
    assert sorted(body.name for body in part.bodies) == ["ball", "base"]


def test_ball_gets_round_normals(tmp_path):
    """Facets of 10 deg are under the smoothing angle: normals point along the radius within a tenth of a facet."""
    path = stored(tmp_path, "ball.stl", trimesh.creation.icosphere(subdivisions=3, radius=30))
    (body,) = load_user_part(path, "mm", STEEL).bodies
    radial = (body.mesh.vertices - [0, 0, 0.03]) / 0.03
    assert body.mesh.normals is not None
    assert np.abs(body.mesh.normals - radial).max() < np.deg2rad(1.0)


def test_wrong_winding_is_mended_and_said(tmp_path):
    """Twelve triangles that look inward are turned; the volume is positive again."""
    made = box_mm()
    made.invert()
    path = stored(tmp_path, "inside_out.stl", made)
    part = load_user_part(path, "mm", STEEL)
    assert part.notices == (f"{path}: body inside_out: 12 of 12 triangles looked inward and were turned",)
    assert signed_volume(part.bodies[0].mesh.vertices, part.bodies[0].mesh.faces) > 0


def test_open_mesh_is_taken_with_a_notice(tmp_path):
    """A box without one triangle has three edges without a partner: said, and gone on."""
    made = box_mm()
    made.update_faces(np.arange(12) > 0)
    path = stored(tmp_path, "open.stl", made)
    part = load_user_part(path, "mm", STEEL)
    assert len(part.bodies[0].mesh.faces) == 11
    assert part.notices == (
        f"{path}: body open: the surface is open (3 edges without a partner), so its inside may show; close it in CAD",
    )


def test_slivers_do_no_harm(tmp_path):
    """A triangle without area in a closed box is dropped: no hole is reported, and every normal is finite."""
    made = box_mm()
    vertices = np.vstack([made.vertices, made.vertices[made.faces[0]][[0, 1]].mean(axis=0)])
    a, b, c = made.faces[0]
    middle = len(made.vertices)
    faces = np.vstack([made.faces[1:], [a, middle, c], [middle, b, c], [a, b, middle]])
    path = stored(tmp_path, "sliver.ply", trimesh.Trimesh(vertices, faces, process=False))
    part = load_user_part(path, "mm", STEEL)
    mesh = part.bodies[0].mesh
    assert part.notices == ()
    assert mesh.normals is not None
    assert mesh.uvs is not None
    assert np.isfinite(mesh.normals).all()
    assert np.isfinite(mesh.uvs).all()
    assert len(mesh.faces) == 13


@pytest.mark.skipif(importlib.util.find_spec("cascadio") is None, reason="needs the extra `step`")
def test_step_states_its_own_unit(tmp_path):
    """A block drawn in mm in a STEP file: metres come out, whether the user repeats the unit or not."""
    path = tmp_path / "block.step"
    path.write_text((Path(__file__).parent / "block_40x30x20_mm.step").read_text())
    for units in (None, "mm"):
        part = load_user_part(path, units, STEEL)
        np.testing.assert_allclose(extent(part)[1] - extent(part)[0], [0.04, 0.03, 0.02], atol=1e-6)


def test_step_without_its_extra_says_what_to_install(tmp_path, monkeypatch):
    """Without the extra the mend is named."""
    path = tmp_path / "block.step"
    path.write_text("ISO-10303-21;")
    monkeypatch.setattr(cad_files.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=re.escape(f'{path}: STEP needs an extra; pip install "franbv[step]", or')):
        load_user_part(path, None, STEEL)


@pytest.mark.skipif(importlib.util.find_spec("cascadio") is None, reason="needs the extra `step`")
def test_a_step_file_of_absurd_size_says_its_unit_and_what_can_be_done(tmp_path):
    """The 40 mm block with its points in metres: 40000 mm by the file's word, which no flag can change."""
    path = tmp_path / "block.step"
    text = (Path(__file__).parent / "block_40x30x20_mm.step").read_text()
    path.write_text(re.sub(r"SI_UNIT *\( *\.MILLI\., *\.METRE\. *\)", "SI_UNIT($,.METRE.)", text))
    for units in (None, "mm", "m"):
        with pytest.raises(InputError) as caught:
            load_user_part(path, units, STEEL)
        assert str(caught.value) == (
            f"{path}: bounding box is 40 m long, as the file's own unit is m; parts are 5 mm to 1 m long; "
            "--units cannot change what a STEP file states: scale it in CAD, such as by 1/1000 (40 mm), or export it "
            "again in its true unit"
        )


def test_one_surface_twice_is_said(tmp_path):
    """Two bodies of one shape in one place: the renderer sees either by chance."""
    faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    lines = f"o a\nv 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n{faces}o b\n{faces}"
    path = written(tmp_path, "twice.obj", lines)
    part = load_user_part(path, "mm", STEEL)
    assert part.notices == (f"{path}: bodies a and b are one surface twice in one place; leave one out in CAD",)


@pytest.mark.parametrize("end", ["o knob\n", "o knob\nv 50 0 0\nv 60 0 0\n", "v 50 0 0\n"])
def test_an_obj_that_ends_in_the_midst_of_an_object_says_so(tmp_path, end):
    """Nothing marks the end of an OBJ; an object without faces, or vertices without, are all that a cut leaves."""
    lines = "o base\nv 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
    part = load_user_part(written(tmp_path, "cut.obj", lines + end), "mm", STEEL)
    assert len(part.notices) == end.count("o knob") + ("v " in end)


def no_triangles(folder: Path) -> Path:
    """A PLY with points alone."""
    return stored(folder, "points.ply", trimesh.PointCloud([[0, 0, 0], [1, 0, 0], [0, 1, 0]]))  # type: ignore[arg-type]


def written(folder: Path, name: str, text: str) -> Path:
    """A file with the given text."""
    path = folder / name
    path.write_text(text)
    return path


def broken(folder: Path, kind: str) -> Path:
    """A file with the named fault."""
    if kind == "missing":
        return folder / "missing.stl"
    if kind == "folder":
        return folder
    if kind == "empty":
        return written(folder, "empty.stl", "")
    if kind == "text":
        return written(folder, "notes.txt", "not a mesh")
    if kind == "garbage":
        return written(folder, "garbage.glb", "this is no glTF at all")
    if kind == "no_facets":
        return written(folder, "none.stl", "solid none\nendsolid none\n")
    if kind == "points":
        return no_triangles(folder)
    vertices = {"nan": "v nan 0 0", "degenerate": "v 20 0 0"}[kind]
    return written(folder, f"{kind}.obj", f"v 0 0 0\nv 10 0 0\n{vertices}\nf 1 2 3\n")


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("missing", "no such file; check the path"),
        ("folder", "is a folder; give one mesh file"),
        ("empty", "the file is empty (0 bytes); export it again"),
        ("text", "not a mesh file; give STL, PLY, OBJ, GLB, GLTF, STEP"),
        ("garbage", "cannot be read as GLB ("),
        ("no_facets", "the file is empty: it holds no geometry; export the solid as a mesh"),
        ("points", "the file is empty: it holds points or curves but no triangles; export the solid as a mesh"),
        ("nan", "body nan has 1 vertices that are not finite numbers; export it again"),
        ("degenerate", "body degenerate: every triangle is degenerate (no area); export it again"),
    ],
)
def test_bad_files_are_named(tmp_path, kind, message):
    """One line: the file, what is wrong, what to do."""
    path = broken(tmp_path, kind)
    with pytest.raises(InputError) as caught:
        load_user_part(path, "mm", STEEL)
    assert str(caught.value).startswith(f"{path}: {message}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("units", "message"),
    [
        (None, "STL files carry no unit; pass --units mm, cm, m or in"),
        ("ft", "unknown unit ft; pass --units mm, cm, m or in"),
        (
            "m",
            "bounding box is 100 m long with --units m; parts are 5 mm to 1 m long; "
            "pass --units mm (100 mm) or --units cm (1 m)",
        ),
        (
            "in",
            "bounding box is 2.54 m long with --units in; parts are 5 mm to 1 m long; pass --units mm (100 mm)",
        ),
    ],
)
def test_units_are_stated_or_refused(tmp_path, units, message):
    """A 100 unit box: metres and inches are absurd; the message says which units would do and how long it then is."""
    path = stored(tmp_path, "part.stl", box_mm())
    with pytest.raises(InputError) as caught:
        load_user_part(path, units, STEEL)
    assert str(caught.value).startswith(f"{path}: {message}")


def test_a_size_that_fits_no_unit_is_refused(tmp_path):
    """1e6 units long: 1 km in mm already."""
    path = stored(tmp_path, "huge.stl", trimesh.creation.box((1e6, 1, 1)))
    with pytest.raises(InputError, match=r"bounding box is 1000 m long with .* scale it in CAD$"):
        load_user_part(path, "mm", STEEL)


def test_bodies_without_or_with_unknown_materials_are_named(tmp_path):
    """A body that no word covers, and a word that no body has."""
    path = stored(tmp_path, "assembly.glb", assembly())
    with pytest.raises(
        InputError,
        match=r"body base has no material; pass --material base=metal:finish; bodies by number: #1 ball, #2 base, ",
    ):
        load_user_part(path, None, part_materials(["ball=brass:polished"]))
    with pytest.raises(
        InputError,
        match=r"there is no body bal to give a material to; did you mean ball\?; bodies by number: #1 ball, #2 base, ",
    ):
        load_user_part(path, None, part_materials(["iron:ground", "bal=brass:polished"]))
    with pytest.raises(InputError, match="has no material"):
        load_user_part(path, None, PartMaterials())
