"""OBJ and PLY files of the corpus."""

from dataclasses import replace

from tests.corpus import polygon_writers as writers
from tests.corpus.solids import ANGLE, BASE, FRAME, KNOB, Solid
from tests.corpus.table import Case, Truth, truth

TWO = {"base": truth(BASE), "knob": truth(KNOB)}


def _lifted() -> Solid:
    """The block with one corner of its top 4 mm higher: the top is bent."""
    points = BASE.points.copy()
    points[5, 2] += 4
    return replace(BASE, points=points)


def _lifted_truth() -> Truth:
    """A quadrilateral cut along one diagonal or the other: 24000 + 600 * 4 / 3 * (1 or 2) mm^3."""
    return Truth(_lifted().low, _lifted().high, 25200, slack=400 + 0.01)


def _lifted_angle() -> Solid:
    """The L with the corner of its notch 2 mm higher: the cap is bent and concave."""
    points = ANGLE.points.copy()
    points[7, 2] += 2
    return replace(ANGLE, points=points)


def _lifted_angle_truth() -> Truth:
    """2 mm over triangles round the corner of the notch, which take at most the whole cap: up to 600 * 2 / 3 mm^3."""
    return Truth(_lifted_angle().low, _lifted_angle().high, 12200, slack=200 + 0.01)


def _lines(*lines: str, end: str = "\n") -> bytes:
    return (end.join(lines) + end).encode()


def _two_forwards() -> bytes:
    return _lines("o base", *writers.obj_lines(BASE), "o knob", *writers.obj_lines(KNOB, first=9))


def _dressed() -> bytes:
    """Normals, groups, materials, comments, smoothing, long lines and the line ends of another system."""
    vertices, faces = writers.obj_lines(ANGLE, corner="{0}//1")[:12], writers.obj_lines(ANGLE, corner="{0}//1")[12:]
    long = faces[0].replace(" 9", " \\\r\n 9", 1)
    head = ["# made", "mtllib made.mtl", "g all", *(line + " 0.5 0.5 0.5" for line in vertices), "vn 0 0 1", "s off"]
    return _lines(*head, "usemtl red # top", long, "usemtl blue", "g rest", *faces[1:], "l 1 2", end="\r\n")


def _obj(file: str, trouble: str, make, **what) -> Case:
    return Case(f"{file}.obj", trouble, make, units="mm", **what)


OBJ_CASES = (
    _obj("concave", "concave polygons", lambda: _lines(*writers.obj_lines(ANGLE)), bodies={"concave": truth(ANGLE)}),
    _obj(
        "ring",
        "a polygon with a hole, by way of a bridge",
        lambda: _lines(*writers.obj_lines(FRAME)),
        bodies={"ring": truth(FRAME)},
    ),
    _obj("bent", "a bent polygon", lambda: _lines(*writers.obj_lines(_lifted())), bodies={"bent": _lifted_truth()}),
    _obj(
        "bent_concave",
        "a bent and concave polygon",
        lambda: _lines(*writers.obj_lines(_lifted_angle())),
        bodies={"bent_concave": _lifted_angle_truth()},
    ),
    _obj("dressed", "all that an OBJ can say beside its shape", _dressed, bodies={"dressed": truth(ANGLE)}),
    _obj("two_objects", "objects", _two_forwards, bodies=TWO),
    _obj(
        "backwards",
        "negative indices between further vertices",
        lambda: _lines("o base", *writers.obj_backwards(BASE), "o knob", *writers.obj_backwards(KNOB)),
        bodies=TWO,
    ),
    _obj(
        "free_form",
        "surfaces beside the polygons",
        lambda: _lines(*writers.obj_lines(BASE), "cstype bspline", "deg 3 3", "surf 0 1 0 1 1 2 3 4", "end"),
        bodies={"free_form": truth(BASE)},
        notices=("line 15: free-form curves and surfaces (`cstype`)",),
    ),
    _obj(
        "unknown_word",
        "a statement that nobody knows",
        lambda: _lines(*writers.obj_lines(BASE), "q knob"),
        bodies={"unknown_word": truth(BASE)},
        notices=("line 15: the statement `q` is not known",),
    ),
    _obj(
        "crossed",
        "a polygon that crosses itself",
        lambda: _lines("v 0 0 0", "v 10 0 0", "v 0 10 0", "v 12 10 0", "f 1 2 3 4"),
        refusal="line 5: a face cannot be cut into triangles: its outline crosses",
    ),
    _obj(
        "no_such_vertex",
        "a face names a vertex that is not there",
        lambda: _lines(*writers.obj_lines(BASE), "f 1 2 9"),
        refusal="line 15: vertex 9 of a face, but the file has 8 vertices",
    ),
    _obj(
        "too_far_back",
        "a face counts back behind the first vertex",
        lambda: _lines(*writers.obj_lines(BASE), "f -1 -2 -9"),
        refusal="line 15: -9 is no vertex of a face; 8 come before it",
    ),
    _obj(
        "utf16",
        "two bytes a letter",
        lambda: _lines(*writers.obj_lines(BASE)).decode().encode("utf-16-le"),
        refusal="it is no text: byte 1 is zero",
    ),
    _obj(
        "nan",
        "a corner is no number",
        lambda: _lines(*writers.obj_lines(BASE)).replace(b"v 40 30 20", b"v 40 nan 20"),
        refusal="1 vertices that are not finite numbers",
    ),
    _obj(
        "comma",
        "decimal commas",
        lambda: _lines(*writers.obj_lines(BASE)).replace(b"v 40 30 20", b"v 40,0 30,0 20,0"),
        refusal="line 7: v 40,0 30,0 20,0 is no vertex with three numbers",
    ),
)


def _ply_text(solid: Solid = ANGLE, **header) -> bytes:
    return (writers.ply_header("ascii", solid, **header) + writers.ply_text(solid)).encode()


def _ply_binary(order: str, **header) -> bytes:
    name = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    return writers.ply_header(name, ANGLE, **header).encode() + writers.ply_binary(ANGLE, order)


def _more_columns() -> bytes:
    """Colours behind every vertex, an element of our own, and a number behind every face."""
    text = _ply_text().decode().replace("property float z\n", "property float z\nproperty uchar red\n")
    text = text.replace("element face", "element other 2\nproperty list uchar float values\nelement face")
    text = text.replace("vertex_indices\n", "vertex_indices\nproperty float quality\n")
    head, body = text.split("end_header\n")
    rows = body.splitlines()
    rows = [*(row + " 255" for row in rows[:12]), "2 0.5 0.5", "0", *(row + " 0.25" for row in rows[12:])]
    return (head + "end_header\n" + "\n".join(rows) + "\n").encode()


def _ply(file: str, trouble: str, make, **what) -> Case:
    return Case(f"{file}.ply", trouble, make, units="mm", **what)


PLY_CASES = (
    _ply("text", "concave polygons", _ply_text, bodies={"text": truth(ANGLE)}),
    _ply("ring", "a polygon with a hole", lambda: _ply_text(FRAME), bodies={"ring": truth(FRAME)}),
    _ply("bent", "a bent polygon", lambda: _ply_text(_lifted()), bodies={"bent": _lifted_truth()}),
    _ply("little", "bytes in one order", lambda: _ply_binary("<"), bodies={"little": truth(ANGLE)}),
    _ply("big", "bytes in the other order", lambda: _ply_binary(">"), bodies={"big": truth(ANGLE)}),
    _ply("more_columns", "more columns and tables than needed", _more_columns, bodies={"more_columns": truth(ANGLE)}),
    _ply(
        "text_crlf",
        "line ends of another system",
        lambda: _ply_text().replace(b"\n", b"\r\n"),
        bodies={"text_crlf": truth(ANGLE)},
    ),
    _ply(
        "text_joined",
        "a line end is missing",
        lambda: _ply_text().replace(b"\n0 0 0\n", b"\n0 0 0", 1),
        refusal="its line has 5 values, not 3",
    ),
    _ply("text_cut", "cut off", lambda: _ply_text()[:-20], refusal="the file is cut off"),
    _ply("little_cut", "cut off", lambda: _ply_binary("<")[:-20], refusal="the file is cut off"),
    _ply("big_cut", "cut off", lambda: _ply_binary(">")[:-20], refusal="the file is cut off"),
    _ply(
        "too_many",
        "the header announces more than there is",
        lambda: _ply_binary("<", faces=2_000_000_000),
        refusal="the header announces 2000000000 rows of `face`",
    ),
    _ply(
        "too_few_text",
        "the header announces less than there is",
        lambda: _ply_text(faces=5),
        refusal="3 lines follow after all that the header announces",
    ),
    _ply(
        "too_few",
        "the header announces less than there is",
        lambda: _ply_binary("<", faces=5),
        refusal="bytes follow after all that the header announces",
    ),
    _ply(
        "nan",
        "a corner is no number",
        lambda: _ply_text(BASE).replace(b"\n40 30 20\n", b"\n40 30 nan\n"),
        refusal="1 vertices that are not finite numbers",
    ),
    _ply(
        "no_faces",
        "points alone",
        lambda: (
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
            b"end_header\n1 2 3\n"
        ),
        refusal="it holds points or curves but no triangles",
    ),
)
