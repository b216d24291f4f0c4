"""Stainless G1/2 pipe fittings, drawn along +z from the face of the port they are screwed into (z = 0), in mm.

Threads are to ISO 228-1 and pipe to ASME B36.19, both out of bd_warehouse. Envelopes follow 150 lb fittings of DN 15
(ISO 4144: elbow and tee 27 mm from centre to end, 13 mm of useful thread); where makers differ, a round number.
"""

# pyright: reportMissingImports=false
from bd_warehouse.pipe import PipeSection
from build123d import Axis, Circle, Pos, Rot, Shape, Solid, fillet, revolve

from scenes.authoring.drawing import hexagon, tube, turned
from scenes.authoring.pipe_thread import pipe_thread
from scenes.scene import Mesh

PIPE = PipeSection("1/2", "stainless", "40S")
BORE = PIPE.id / 2
"""Clear radius through every fitting [mm]."""
SOCKET = 9.4
"""Radius of a female thread [mm]: half of G1/2's 18.63 mm minor diameter and a little clearance."""
SOCKET_DEPTH = 13.0
BODY = 12.5
"""Outer radius of cast bodies [mm] (choice: 3 mm of wall around the thread)."""
BEAD = 14.5
"""Outer radius of the bead around a female end [mm] (choice: 4 mm around the thread)."""
BEAD_HEIGHT = 11.0
CENTRE_TO_END = 27.0
NIPPLE_HEX = 27.0
NIPPLE_HEX_HEIGHT = 8.0


def nipple_hexagon() -> Shape:
    """Hexagon of a nipple whose lower thread is in the port."""
    return hexagon(NIPPLE_HEX, 0.0, NIPPLE_HEX_HEIGHT, BORE)


def nipple_thread() -> Mesh:
    """Upper, free thread of that nipple, standing on z = 0; mesh in metres."""
    return pipe_thread("G1/2", SOCKET_DEPTH, BORE)


def elbow() -> Shape:
    """90 deg elbow: lower mouth at z = 0 looking down, upper mouth looking along +x at height 27 mm."""
    bend = CENTRE_TO_END - BEAD_HEIGHT
    mouth = Pos(CENTRE_TO_END, 0, CENTRE_TO_END) * Rot(0, 90, 0)
    foot = Rot(180, 0, 0)
    body = _quarter_bend(BODY, bend) + mouth * _bead() + foot * _bead()
    return body - _quarter_bend(BORE, bend) - mouth * _socket() - foot * _socket()


def tee() -> Shape:
    """Tee: lower mouth at z = 0 looking down, the run along x at height 27 mm with mouths at x = -27 and 27 mm."""
    foot = Rot(180, 0, 0)
    right, left = (Pos(s * CENTRE_TO_END, 0, CENTRE_TO_END) * Rot(0, s * 90, 0) for s in (1, -1))
    run = Pos(-CENTRE_TO_END + 1, 0, CENTRE_TO_END) * Rot(0, 90, 0)
    length = 2 * CENTRE_TO_END - 2
    crotch = run * Solid.make_cylinder(BODY, length) + Pos(0, 0, 1) * Solid.make_cylinder(BODY, CENTRE_TO_END)
    seam = [edge for edge in crotch.edges() if abs(edge.center().X) < 1 or abs(edge.center().Y) > 1]
    body = fillet([e for e in seam if 2 < e.bounding_box().size.Z < 26], 2.5)
    for end in (foot, right, left):
        body = body + end * _bead()
    body = body - run * Solid.make_cylinder(BORE, length) - Solid.make_cylinder(BORE, CENTRE_TO_END)
    for end in (foot, right, left):
        body = body - end * _socket()
    return body


def plug() -> Shape:
    """Hexagon plug screwed into a mouth at z = 0 that looks along +z; its thread is out of sight."""
    return turned([(0, -8), (SOCKET - 0.2, -8), (SOCKET - 0.2, 0.5), (11.5, 0.5), (11.5, 2.5), (0, 2.5)]) + hexagon(
        19.0, 2.0, 11.0, 0.0
    )


def union() -> list[Shape]:
    """Union: lower hexagon, 41 mm nut, upper hexagon, 46 mm high in all."""
    lower = hexagon(27.0, 0.0, 11.0, BORE) + tube(13.0, BORE, 10.5, 15.0)
    nut = hexagon(36.0, 14.0, 32.0, 13.2) + turned(
        [(13.0, 28.0), (16.0, 28.0), (16.0, 32.5), (14.5, 34.0), (13.0, 34.0)]
    )
    upper = tube(13.0, BORE, 30.0, 37.5) + hexagon(27.0, 37.0, 46.0, BORE)
    return [lower, nut, upper]


def pipe_stub(length: float) -> Shape:
    """Plain end of pipe from z = 0."""
    return tube(PIPE.od / 2, BORE, 0.0, length)


def compression_joint(tube_length: float) -> list[Shape]:
    """Compression joint for 12 mm tube with its union nut, and the tube that comes out of it."""
    body = hexagon(22.0, 0.0, 9.0, 5.0) + tube(9.0, 5.0, 8.5, 13.0)
    nut = hexagon(22.0, 12.0, 24.0, 6.1) + turned([(6.1, 20.0), (9.5, 20.0), (9.5, 25.0), (8.0, 27.0), (6.1, 27.0)])
    return [body, nut, tube(6.0, 5.0, 5.0, 27.0 + tube_length, 0.3)]


def _quarter_bend(radius: float, bend: float) -> Shape:
    """Quarter of a torus from (0, 0, BEAD_HEIGHT) upwards, round to +x at height 27 mm."""
    return Pos(0, 0, BEAD_HEIGHT) * revolve(Circle(radius), Axis((bend, 0, 0), (0, 1, 0)), 90)


def _bead() -> Shape:
    """Rounded end of a fitting, solid, from its mouth at z = 0 downwards and a little into the body."""
    ring = Pos(0, 0, -BEAD_HEIGHT - 0.5) * Solid.make_cylinder(BEAD, BEAD_HEIGHT + 0.5)
    return fillet(ring.edges(), 1.2)


def _socket() -> Shape:
    """What a tap cuts out of an end whose mouth is at z = 0 and looks along +z; the thread is drawn as a bore."""
    wide = SOCKET + 1.5
    return turned([(0, 1.0), (wide + 1, 1.0), (wide, 0.0), (SOCKET, -1.5), (SOCKET, -SOCKET_DEPTH), (0, -SOCKET_DEPTH)])
