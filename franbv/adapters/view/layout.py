"""How the viewer's window is divided: the room at the left, images and curves at the right. Needs the extra `view`."""

import rerun.blueprint as rrb

from franbv.adapters.view.entities import TIMELINE, Entity

ROOM_SHARE, IMAGES_SHARE = 3, 2
"""Widths of the two columns, as parts of their sum: a choice."""


def layout() -> rrb.Blueprint:
    """The window as it opens. The cloud grows with the steps: all that was seen up to the present one is shown. Depth
    stays out of the room, where the viewer would draw walls and table, too."""
    so_far = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.infinite(),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    room = rrb.Spatial3DView(
        origin=Entity.WORLD,
        contents=["$origin/**", f"- /{Entity.DEPTH}"],
        name="Room",
        overrides={Entity.CLOUD: so_far},
    )
    curves = rrb.Tabs(
        _curves("Coverage and Gamma [-]", "coverage", "gamma"),
        _curves("Occupied voxels", "occupied_voxels"),
        _curves("Utility [px^2]", "utility"),
        rrb.TextLogView(origin=Entity.LOG, name="Log"),
    )
    images = rrb.Vertical(
        rrb.Spatial2DView(origin=Entity.LENS, name="Depth"),
        rrb.Spatial2DView(origin=Entity.INFRARED, name="Left infrared"),
        curves,
    )
    return rrb.Blueprint(
        rrb.Horizontal(room, images, column_shares=[ROOM_SHARE, IMAGES_SHARE]),
        rrb.TimePanel(timeline=TIMELINE, play_state=rrb.components.PlayState.Following, state="collapsed"),
        collapse_panels=True,
    )


def _curves(name: str, *curves: str) -> rrb.TimeSeriesView:
    contents = [f"/{Entity.CURVES}/{curve}" for curve in curves]
    return rrb.TimeSeriesView(origin=Entity.CURVES, contents=contents, name=name)
