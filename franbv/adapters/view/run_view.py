"""Draws a run acquisition by acquisition into a stream of the viewer rerun. Needs the extra `view`.

Every acquisition is one step of the timeline, and all that it knows is drawn at that step, empty things too: what the
viewer shows at a step is never left over from an earlier one. Units are metres, the world's z axis is up.
"""

import numpy as np
import rerun as rr
from jaxtyping import UInt8

from franbv.acquisition import Acquisition
from franbv.adapters.view.entities import TIMELINE, Entity
from franbv.adapters.view.layout import layout
from franbv.adapters.view.shapes import lines_of_sight, origins_of, placed_boxes, placed_ellipsoids
from franbv.adapters.view.sight import CURVES, ShownVoxels, Sight, sight_of


class Colour:
    """Of what is drawn [0, 255]: a choice."""

    OCCUPIED = (66, 135, 245)
    FRONTIER = (245, 176, 65)
    CLOUD = (155, 89, 182)
    REFLECTIVE = (231, 76, 60)
    LOOK_AGAIN = (39, 174, 96)
    WAY = (150, 150, 150)


POINT_RADIUS = 0.00075
"""Of the cloud's points [m] (choice: a tenth of the paper's voxels, so that points of neighbouring ones stay apart)."""
LINE_RADIUS = 0.0005
"""Of edges and of the way [m] (choice: thinner than a point)."""
ARROW = 0.05
"""Length of the line of sight of a recovery pose [m] (choice: it does not reach the object from the paper's 141 mm)."""
FRUSTUM = 0.08
"""Distance at which the camera's image is drawn [m] (choice: in front of the object from all of the paper's views)."""


class RunView:
    """What one run looks like. `observe` is what `franbv.reconstruction.reconstruct` calls with each acquisition."""

    def __init__(self, stream: rr.RecordingStream, invalid_share: float) -> None:
        """stream: without clock times; invalid_share: as in `sight_of`."""
        self._stream, self._invalid_share = stream, invalid_share
        self._way: list[np.ndarray] = []
        stream.send_blueprint(layout())
        stream.log(Entity.WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True, strict=True)

    def observe(
        self,
        acquisition: Acquisition,
        coverage: float | None = None,
        infrared: UInt8[np.ndarray, "h w"] | None = None,
    ) -> None:
        """Draw an acquisition; the arguments are those of `sight_of`."""
        self.show(sight_of(acquisition, self._invalid_share, coverage, infrared))

    def show(self, sight: Sight) -> None:
        """Draw what is shown of an acquisition."""
        self._stream.set_time(TIMELINE, sequence=sight.index)
        self._draw(Entity.CLOUD, rr.Points3D(_single(sight.points), radii=POINT_RADIUS, colors=Colour.CLOUD))
        if sight.voxels is not None:
            self._draw_voxels(sight.voxels)
        self._draw_ellipsoids(sight)
        self._draw_regions(sight)
        self._draw_camera(sight)
        if sight.infrared is None:
            self._draw(Entity.INFRARED, rr.Clear(recursive=False))
        else:
            self.infrared(sight.index, sight.infrared)
        for name in CURVES:
            value = sight.curves.get(name)
            if value is not None:
                self._draw(f"{Entity.CURVES}/{name}", rr.Scalars(value))
        words = f"acquisition {sight.index}: {sight.kind}, NBV iteration {sight.iteration}"
        self._draw(Entity.LOG, rr.TextLog(words, level=rr.TextLogLevel.INFO))

    def infrared(self, index: int, image: UInt8[np.ndarray, "h w"]) -> None:
        """Draw the left infrared image of an acquisition that was shown without one."""
        self._stream.set_time(TIMELINE, sequence=index)
        self._draw(Entity.INFRARED, rr.Image(image, color_model="L"))

    def _draw_voxels(self, voxels: ShownVoxels) -> None:
        half = np.full(3, voxels.size / 2, np.float32)
        solid, edges = rr.components.FillMode.Solid, rr.components.FillMode.MajorWireframe
        cubes = [
            (Entity.OCCUPIED, voxels.occupied, Colour.OCCUPIED, solid),
            (Entity.FRONTIER, voxels.frontier, Colour.FRONTIER, edges),
        ]
        for path, centres, colour, mode in cubes:
            halves = np.broadcast_to(half, (len(centres), 3))
            self._draw(
                path,
                rr.Boxes3D(
                    centers=_single(centres), half_sizes=halves, colors=colour, radii=LINE_RADIUS, fill_mode=mode
                ),
            )

    def _draw_ellipsoids(self, sight: Sight) -> None:
        both = [
            (Entity.OCCUPIED_ELLIPSOIDS, sight.ellipsoids.of_occupied(), Colour.OCCUPIED),
            (Entity.FRONTIER_ELLIPSOIDS, sight.ellipsoids.of_frontier(), Colour.FRONTIER),
        ]
        for path, some, colour in both:
            centres, halves, quaternions = map(_single, placed_ellipsoids(some))
            mode = rr.components.FillMode.MajorWireframe
            self._draw(
                path,
                rr.Ellipsoids3D(
                    centers=centres,
                    half_sizes=halves,
                    quaternions=quaternions,
                    colors=colour,
                    line_radii=LINE_RADIUS,
                    fill_mode=mode,
                ),
            )

    def _draw_regions(self, sight: Sight) -> None:
        centres, halves, quaternions = map(_single, placed_boxes(sight.regions))
        self._draw(
            Entity.REGIONS,
            rr.Boxes3D(
                centers=centres,
                half_sizes=halves,
                quaternions=quaternions,
                colors=Colour.REFLECTIVE,
                radii=2 * LINE_RADIUS,
            ),
        )
        arrows = _single(ARROW * lines_of_sight(sight.recovery_poses))
        origins = _single(origins_of(sight.recovery_poses))
        self._draw(
            Entity.RECOVERY_POSES,
            rr.Arrows3D(vectors=arrows, origins=origins, colors=Colour.LOOK_AGAIN, radii=2 * LINE_RADIUS),
        )

    def _draw_camera(self, sight: Sight) -> None:
        """Frustum, depth and the way so far. The viewer counts pixels from the corner of the first, we from its centre:
        the principal point moves by half a pixel."""
        pose, lens = sight.T_world_cam, sight.intrinsics
        quaternion = rr.Quaternion(xyzw=pose.rotation.as_quat())
        self._draw(Entity.CAMERA, rr.Transform3D(translation=pose.translation, quaternion=quaternion))
        self._draw(
            Entity.LENS,
            rr.Pinhole(
                resolution=(lens.width, lens.height),
                focal_length=(lens.fx, lens.fy),
                principal_point=(lens.cx + 0.5, lens.cy + 0.5),
                image_plane_distance=FRUSTUM,
            ),
        )
        self._draw(Entity.DEPTH, rr.DepthImage(sight.depth.astype(np.float32), meter=1.0))
        self._way.append(pose.translation)
        way = [_single(np.array(self._way))]
        self._draw(Entity.WAY, rr.LineStrips3D(way, colors=Colour.WAY, radii=LINE_RADIUS))

    def _draw(self, path: str, thing: rr.AsComponents) -> None:
        """At the present step; what the viewer would only warn of is raised."""
        self._stream.log(path, thing, strict=True)


def _single(numbers: np.ndarray) -> np.ndarray:
    """As the viewer keeps them."""
    return np.asarray(numbers, np.float32)
