"""Columns of turned coupling sleeves, stacked end to end: parts D and E3. In mm, z up.

Read off the published photographs (scale: the plinth's 250 mm), to about 15 %. The lowest foot, dark in the photo of D,
is as wide as the other feet, there and in that of the half ring: a mirror that shows the black plinth.
"""

# pyright: reportMissingImports=false
from build123d import Plane, Pos, RegularPolygon, Shape, extrude

from scenes.authoring.drawing import turned

_FOOT, _SHOULDER, _NECK, _CONE, _SLEEVE = 22.5, 6.0, 11.5, 4.0, 19.0
"""Heights from the bottom up [mm]."""
_HEIGHT = _FOOT + _SHOULDER + _NECK + _CONE + _SLEEVE
"""Of one sleeve [mm]: 88 pixels from neck to neck at 1.43 pixels per mm."""
_FOOT_RADIUS, _SLEEVE_RADIUS, _NECK_RADIUS = 15.2, 15.5, 11.8
"""45 and 34 pixels wide in the photograph [mm]."""
_ACROSS_FLATS = 27.0
"""Of the wrench flats on the shoulder [mm]; ISO 272 has 27, which bar of 31.2 mm just yields."""
_BORE, _PASSAGE = 12.3, 8.0
"""Radius of the open end and of the way through [mm]; 3 mm of wall as in the half ring's photograph."""
_EDGE = 0.4
"""Chamfer of the turned edges [mm] (choice)."""


def column(count: int) -> list[Shape]:
    """So many sleeves, the lowest on z = 0. All but the uppermost are drawn solid: nobody sees into them."""
    shut, bored = _sleeve(bored=False), _sleeve(bored=True)
    return [Pos(0, 0, number * _HEIGHT) * (bored if number == count - 1 else shut) for number in range(count)]


def _sleeve(bored: bool) -> Shape:
    """Foot, shoulder with wrench flats, neck, open sleeve; a groove in either cylinder and two inside."""
    neck = _FOOT + _SHOULDER
    cone = neck + _NECK
    foot = [(_PASSAGE if bored else 0, 0), (_FOOT_RADIUS - _EDGE, 0), (_FOOT_RADIUS, _EDGE)]
    shoulder = [*_groove(_FOOT_RADIUS, 13.0), (_FOOT_RADIUS, _FOOT), (_NECK_RADIUS, neck), (_NECK_RADIUS, cone)]
    outside = [
        (_SLEEVE_RADIUS, cone + _CONE),
        *_groove(_SLEEVE_RADIUS, _HEIGHT - 7.0),
        (_SLEEVE_RADIUS, _HEIGHT - _EDGE),
    ]
    inside = [(_SLEEVE_RADIUS - _EDGE, _HEIGHT), (_BORE + 0.6, _HEIGHT), (_BORE, _HEIGHT - 0.6)]
    for depth in (6.0, 11.0):
        inside += [(_BORE, _HEIGHT - depth), (_BORE + 1, _HEIGHT - depth - 0.2), (_BORE + 1, _HEIGHT - depth - 1.8)]
        inside += [(_BORE, _HEIGHT - depth - 2.0)]
    inside += [(_BORE, cone + _CONE), (_PASSAGE, cone + _CONE - 2.0)]
    top = inside if bored else [(_SLEEVE_RADIUS - _EDGE, _HEIGHT), (0, _HEIGHT)]
    whole = turned([*foot, *shoulder, *outside, *top])
    flats = Plane.XY.offset(_FOOT) * extrude(RegularPolygon(_ACROSS_FLATS / 2, 6, major_radius=False), _SHOULDER)
    ring = Plane.XY.offset(_FOOT) * extrude(RegularPolygon(4 * _FOOT_RADIUS, 4), _SHOULDER) - flats
    return whole - ring


def _groove(radius: float, height: float) -> list[tuple[float, float]]:
    """Turned mark, 0.8 mm wide and 0.4 mm deep."""
    return [(radius, height - 0.4), (radius - 0.4, height - 0.2), (radius - 0.4, height + 0.2), (radius, height + 0.4)]
