"""glTF files of the corpus."""

from dataclasses import replace

import numpy as np

from tests.corpus.gltf_writer import MM, Gltf
from tests.corpus.solids import ANGLE, BASE, KNOB, Solid
from tests.corpus.table import Case, Truth, truth

REACH = 45.0
"""What the largest integer stands for, farther than any corner [mm]."""


def _made(build, text: bool = False):
    def make() -> bytes:
        file = Gltf()
        build(file)
        return file.gltf() if text else file.glb()

    return make


def _plain(file: Gltf) -> None:
    file.node(file.solid(ANGLE), name="angle")


def _placed(file: Gltf) -> None:
    """One mesh three times: as it is, turned by 90 deg about z inside a shifted group, and by a matrix at half size."""
    mesh = file.solid(KNOB.moved(-50, 0, 0))
    file.node(mesh, name="bolt")
    quarter = np.sqrt(0.5)
    child = file.node(mesh, root=False, name="bolt", rotation=[0.0, 0.0, quarter, quarter])
    file.node(children=[child], name="group", translation=[0.1, 0.0, 0.0])
    half = [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0.2, 1]
    file.node(mesh, name="bolt", matrix=half)


PLACED = {
    "bolt": truth(KNOB.moved(-50, 0, 0)),
    "bolt_1": Truth(np.array([90.0, 0, 0]), np.array([100.0, 10, 10]), 1000),
    "bolt_2": Truth(np.array([0.0, 0, 200]), np.array([5.0, 5, 205]), 125),
}


def _mirrored(file: Gltf) -> None:
    file.node(file.solid(ANGLE), name="angle", scale=[-1.0, 1.0, 1.0])


def _faces_apart(file: Gltf) -> None:
    """Every polygon is a primitive, with vertices of its own and a material."""
    file.tree["materials"] = [{"name": "red"}, {"name": "blue"}]
    primitives = []
    for triangle in BASE.triangles:
        positions = file.positions(BASE.points[list(triangle)])
        primitives.append({"attributes": {"POSITION": positions}, "material": len(primitives) % 2})
    file.node(file.mesh(*primitives), name="base")


def _strip(file: Gltf) -> None:
    """Sides of the block as a strip, top and bottom as fans."""
    positions = file.positions(BASE.points)
    around = [0, 4, 1, 5, 2, 6, 3, 7, 0, 4]
    turned = [around[i ^ 1] for i in range(len(around))]
    parts = [(5, turned), (6, [4, 5, 6, 7]), (6, [3, 2, 1, 0])]
    file.node(
        file.mesh(
            *({"attributes": {"POSITION": positions}, "indices": file.indices(c), "mode": mode} for mode, c in parts)
        )
    )


def _sparse(file: Gltf) -> None:
    """The block 10 mm tall, whose upper corners are replaced by those at 20 mm."""
    low = BASE.points * [1, 1, 0.5]
    mesh = file.mesh({"attributes": {"POSITION": file.positions(low)}, "indices": file.indices(BASE.triangles)})
    which, new = file.view(np.array([[4], [5], [6], [7]], "<u2")), file.view((BASE.points[4:] * MM).astype("<f4"))
    file.tree["accessors"][0].pop("min")
    file.tree["accessors"][0].pop("max")
    file.tree["accessors"][0]["sparse"] = {
        **{"count": 4, "indices": {"bufferView": which, "componentType": 5123}},
        "values": {"bufferView": new},
    }
    file.node(mesh)


def _integers(kind: str, normalized: bool):
    """Positions as integers, the largest of which stands for REACH, which the node's scale undoes (the extension
    KHR_mesh_quantization)."""
    most, middle = np.iinfo(kind).max, 20.0 if kind.startswith("i") else 0.0

    def build(file: Gltf) -> None:
        centred = BASE.points - middle
        values = np.round(centred / REACH * most).astype(kind)
        stride = -(-values.dtype.itemsize * 3 // 4) * 4
        positions = file.accessor(values, stride=stride, **({"normalized": True} if normalized else {}))
        file.require("KHR_mesh_quantization")
        scale = REACH * MM / (1 if normalized else most)
        mesh = file.mesh({"attributes": {"POSITION": positions}, "indices": file.indices(BASE.triangles)})
        file.node(mesh, name="base", scale=[scale] * 3, translation=[middle * MM] * 3)

    return build


def _integer_case(name: str, kind: str, normalized: bool) -> Case:
    """An integer rounds by half of REACH / largest, so the volume by the sum over sides at most."""
    step = REACH / np.iinfo(kind).max / 2
    slack = 2 * step * (40 * 30 + 40 * 20 + 30 * 20) * 1.1
    bodies = {name: truth(BASE, slack=slack)}
    make = _made(_integers(kind, normalized))
    return Case(f"{name}.glb", "integer positions", make, bodies, position_tolerance=1.1 * step + 1e-4)


def _instanced(file: Gltf) -> None:
    node = file.node(file.solid(KNOB))
    shifts = file.accessor(np.array([[0, 0, 0], [0.02, 0, 0], [0.04, 0, 0]], "<f4"))
    extension = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": shifts}}}
    file.tree["nodes"][node]["extensions"] = extension
    file.require("EXT_mesh_gpu_instancing")


def _instanced_optional(file: Gltf) -> None:
    _instanced(file)
    file.tree.pop("extensionsRequired")


def _draco(file: Gltf) -> None:
    file.node(file.solid(BASE), name="plain")
    mesh = file.tree["meshes"][file.solid(KNOB)]
    packed = {"bufferView": file.view(np.zeros((16, 1), "<u4")), "attributes": {"POSITION": 0}}
    mesh["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": packed}
    file.node(1, name="packed")
    file.require("KHR_draco_mesh_compression")


def _meshopt(file: Gltf) -> None:
    _plain(file)
    packed = {"buffer": 0, "byteLength": 16, "byteStride": 12, "count": 12, "mode": "ATTRIBUTES"}
    file.tree["bufferViews"][0]["extensions"] = {"EXT_meshopt_compression": packed}
    file.require("EXT_meshopt_compression")


def _unknown(file: Gltf) -> None:
    _plain(file)
    file.require("KHR_materials_clearcoat", "ACME_folded_space")


def _only_looks(file: Gltf) -> None:
    _plain(file)
    file.require("KHR_materials_clearcoat", "KHR_texture_transform", "KHR_lights_punctual")


def _no_scene(file: Gltf) -> None:
    child = file.node(file.solid(KNOB), name="knob", root=False)
    file.node(children=[child], root=False, translation=[0.0, 0.0, 0.01])
    del file.tree["scene"], file.tree["scenes"]


def _hidden(file: Gltf) -> None:
    _plain(file)
    file.node(file.solid(KNOB), name="spare", root=False)


def _circle(file: Gltf) -> None:
    _plain(file)
    file.node(children=[0])


def _skinned(file: Gltf) -> None:
    _plain(file)
    file.tree["nodes"][0]["skin"] = 0


def _far_index(file: Gltf) -> None:
    mesh = file.solid(KNOB)
    file.tree["meshes"][mesh]["primitives"][0]["indices"] = file.indices([0, 1, 8])
    file.node(mesh)


def _huge_count(file: Gltf) -> None:
    _plain(file)
    file.tree["accessors"][0]["count"] = 2**40


def _zeros(file: Gltf) -> None:
    _plain(file)
    file.tree["accessors"][0].pop("bufferView")


def _wrong_bounds(file: Gltf) -> None:
    _plain(file)
    file.tree["accessors"][0]["max"] = [0.08, 0.03, 0.02]


def _nan(file: Gltf) -> None:
    points = BASE.points.copy()
    points[3, 1] = np.nan
    mesh = file.solid(replace(BASE, points=points))
    file.tree["accessors"][0].pop("min")
    file.tree["accessors"][0].pop("max")
    file.node(mesh)


MIRROR: Solid = replace(ANGLE, points=ANGLE.points * [-1, 1, 1])


def _refused(file: str, trouble: str, build, refusal: str) -> Case:
    return Case(file, trouble, _made(build, text=file.endswith(".gltf")), refusal=refusal)


GLTF_CASES = (
    Case("plain.glb", "plain", _made(_plain), {"plain": truth(ANGLE)}),
    Case("text.gltf", "a text file with its buffer inside", _made(_plain, text=True), {"text": truth(ANGLE)}),
    Case("placed.glb", "one mesh in three places under one name", _made(_placed), PLACED),
    Case("mirrored.glb", "a mirror in the scene graph", _made(_mirrored), {"mirrored": truth(MIRROR)}),
    Case("faces_apart.glb", "a primitive per face and colour", _made(_faces_apart), {"faces_apart": truth(BASE)}),
    Case("strip.glb", "strips and fans", _made(_strip), {"strip": truth(BASE)}),
    Case("sparse.glb", "sparse positions", _made(_sparse), {"sparse": truth(BASE)}),
    _integer_case("signed_bytes", "i1", True),
    _integer_case("signed_shorts", "i2", True),
    _integer_case("unsigned_bytes", "u1", True),
    _integer_case("unsigned_shorts", "u2", True),
    _integer_case("whole_bytes", "i1", False),
    _integer_case("whole_shorts", "i2", False),
    Case("only_looks.glb", "extensions of appearance", _made(_only_looks), {"only_looks": truth(ANGLE)}),
    Case("no_scene.glb", "no scene", _made(_no_scene), {"no_scene": truth(KNOB.moved(0, 0, 10))}),
    Case(
        "hidden.glb",
        "a mesh that no scene shows",
        _made(_hidden),
        {"hidden": truth(ANGLE)},
        notices=("1 meshes are in no scene that is shown",),
    ),
    Case(
        "wrong_bounds.glb",
        "bounds that the positions do not have",
        _made(_wrong_bounds),
        {"wrong_bounds": truth(ANGLE)},
        notices=("mesh 0 does not fill the bounds",),
    ),
    _refused("instanced.glb", "copies", _instanced, "extension EXT_mesh_gpu_instancing"),
    _refused("instanced_optional.gltf", "copies, not called needed", _instanced_optional, "EXT_mesh_gpu_instancing"),
    _refused("draco.glb", "compression", _draco, "compressed with Draco (KHR_draco_mesh_compression)"),
    _refused("draco.gltf", "compression", _draco, "export it without compression"),
    _refused("meshopt.glb", "compression", _meshopt, "compressed with meshopt (EXT_meshopt_compression)"),
    _refused("unknown.glb", "an extension that nobody knows", _unknown, "extension ACME_folded_space"),
    _refused("unknown.gltf", "an extension that nobody knows", _unknown, "extension ACME_folded_space"),
    _refused("circle.glb", "a node in two places", _circle, "stands in its scene twice"),
    _refused("skinned.glb", "a skin", _skinned, "bent by a skin"),
    _refused("far_index.glb", "a corner that is not there", _far_index, "names vertex 8, but there are 8"),
    _refused("huge_count.glb", "an accessor beyond its buffer", _huge_count, "needs 1099511627776 values"),
    _refused("zeros.glb", "an accessor without data", _zeros, "accessor 0 has no data"),
    _refused("nan.glb", "a corner is no number", _nan, "1 vertices that are not finite numbers"),
    Case(
        "endless_number.gltf",
        "a number of thousands of digits",
        lambda: b'{"asset": {"version": "2.0"}, "scene": ' + b"1" * 5000 + b"}",
        refusal="its JSON has a number that is none",
    ),
    Case(
        "buffer_elsewhere.gltf",
        "the buffer is a file that is not there",
        lambda: _made(_plain, text=True)().replace(b"data:application/octet-stream;base64,", b"gone/"),
        refusal="is not beside it",
    ),
    Case(
        "misspelt.gltf",
        "a property that the format does not have",
        lambda: _made(_mirrored, text=True)().replace(b'"scale"', b'"scala"'),
        {"misspelt": truth(ANGLE)},
        notices=("glTF has no property `scala`",),
    ),
    Case("cut.glb", "cut off", lambda: _made(_plain)()[:-40], refusal="the file is cut off"),
    Case("cut.gltf", "cut off", lambda: _made(_plain, text=True)()[:-40], refusal="its JSON breaks off in line"),
)
