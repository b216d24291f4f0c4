"""A simulated RealSense D435i or D415: radiance, imagers, stereo matcher, z16, decimation, crop.

Implements `DepthCamera`. With its settings, `render.sensor`, it is the only face of this package to the studies.
"""

import copy
import hashlib
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float32, UInt8, UInt16
from scipy.spatial.transform import RigidTransform

from franbv.frames import Intrinsics, block_centre_intrinsics, centre_corner
from franbv.sensing import DepthBurst
from materials.lights import Band
from render.depth.coding import metres_from_z16, z16_from_disparity
from render.depth.decimation import crop_centre, decimate
from render.imager.expose import expose_burst
from render.imager.exposure import auto_exposure
from render.imager.seen_surfaces import SeenSurfaces
from render.imager.settings import REFERENCE_LASER_POWER_MW, ImagerSettings
from render.light.first_surface import StereoView
from render.light.pattern import dot_pattern, projector_dots
from render.light.projector import ProjectorLight
from render.light.radiance import RadianceLayers, render_stereo, stop_at_first_surface
from render.light.sampling import Sampling
from render.matcher.interface import StereoMatcher, Window
from render.sensor import SensorSettings
from render.world.mitsuba_scene import LoadedScene, load_scene
from render.world.rig import Rig
from render.world.seen_surfaces import seen_surfaces
from render.world.truth import Truth, measure_truth
from scenes.scene import Scene


@dataclass(frozen=True, eq=False)
class Measurement:
    """All that one pose gives, before and after decimation.

    Both layers of each imager are kept, from which `SimulatedD435i.expose` makes other exposures without a new
    rendering. The n frames share them and their speckle; shot and read noise are drawn anew for each. What is really
    there is not in it: see `SimulatedD435i.truth`.
    """

    T_world_cam: RigidTransform
    """Pose of the left imager."""
    left_layers: RadianceLayers
    right_layers: RadianceLayers
    imager: ImagerSettings
    """With the exposure and gain that were used."""
    lefts: UInt8[np.ndarray, "n h w"]
    """Left infrared images [DN]."""
    rights: UInt8[np.ndarray, "n h w"]
    """Right infrared images [DN]."""
    z16: UInt16[np.ndarray, "n h w"]
    """Depth at full resolution, in `DepthFormat.unit`, 0 = invalid."""
    depths: Float32[np.ndarray, "n h w"]
    """The same in metres."""
    burst: DepthBurst
    """What the planner gets: decimated and cropped."""


class SimulatedD435i:
    """The camera in front of one scene.

    Radiance at 850 nm -> electrons -> pairs of 8 bits -> disparity d -> Z = f B / d -> z16 -> decimation -> crop. Noise
    and speckle depend on the seed and the pose alone, so a pose gives the same frames whatever was measured before, and
    the first frames of a longer burst are those of a shorter one.

    Camera and scene stand still and the pose is exact; the pair is perfectly rectified but for
    `SensorSettings.row_misalignment_px`. Left out: the colour imager, the
    inertial unit, librealsense's filters but decimation, and what `render.imager.expose` and `render.light.paths` name.
    Raises BackendError where nothing can render, InputError for settings or a scene that it cannot take.
    """

    def __init__(
        self,
        scene: Scene,
        settings: SensorSettings | None = None,
        seed: int = 0,
        sampling: Sampling | None = None,
        matcher: StereoMatcher | None = None,
        known: LoadedScene | None = None,
    ) -> None:
        """Load the scene. sampling: see `Sampling`; matcher: any `StereoMatcher` instead of the one that is named;
        known: a loaded scene whose geometry it may share."""
        self._set_to((settings or SensorSettings()).resolved(), matcher)
        self.scene = scene
        self.world = load_scene(self._seen_scene, known)
        self._seed = seed
        self._sampling = sampling or Sampling()
        self._view: dict[bytes, StereoView] = {}
        self._seen: tuple[StereoView, Scene, tuple[SeenSurfaces, SeenSurfaces]] | None = None
        self._dots = projector_dots(self.settings.model, self.settings.dot_fwhm_px)
        self._light = ProjectorLight.at(RigidTransform.identity(), dot_pattern(self._dots), 0.0)

    def _set_to(self, settings: SensorSettings, matcher: StereoMatcher | None) -> None:
        self.settings, self._matcher = settings, matcher or settings.stereo_matcher
        self._search_start = settings.rig.disparity_shift
        own_shift = getattr(self._matcher, "shift", 0)  # of a matcher of the caller's, which may have one
        self.rig: Rig = replace(settings.rig, disparity_shift=self._search_start + own_shift)

    @property
    def _seen_scene(self) -> Scene:
        """The scene as the imagers see it: through a filter lamps shine at 850 nm alone."""
        plain = self.settings.imager.band_pass is None
        return self.scene if plain else replace(self.scene, lamp_band=Band.PROJECTOR)

    @property
    def _lamp_share(self) -> float:
        """Share of the lamps' electrons that a filter lets through [0, 1]."""
        band_pass = self.settings.imager.band_pass
        return 1.0 if band_pass is None else band_pass.passed_share(self.scene.lamp_band)

    @property
    def intrinsics(self) -> Intrinsics:
        """Of the decimated and cropped depth, along the middle of each block."""
        full = self.rig.intrinsics
        if self.settings.decimation > 1:
            full = block_centre_intrinsics(full, self.settings.decimation)
        if self.settings.crop is None:
            return full
        return crop_centre(np.zeros((1, full.height, full.width), np.uint16), full, self.settings.crop)[1]

    @property
    def min_z(self) -> float:
        """Smallest measurable Z-depth [m]."""
        return self.rig.min_z

    def capture(self, T_world_cam: RigidTransform, n_frames: int) -> DepthBurst:
        """Depth frames as the planner gets them."""
        return self.measure(T_world_cam, n_frames).burst

    def projector_light(self, T_world_cam: RigidTransform) -> ProjectorLight:
        """The projector of a camera at this pose, at the reference laser power."""
        mean = REFERENCE_LASER_POWER_MW * 1e-3 / (np.pi * self._dots.field_area)
        return self._light.moved(self.rig.projector(T_world_cam), mean)

    def view(self, T_world_cam: RigidTransform) -> StereoView:
        """What both imagers meet first from there; kept until the pose changes, by all cameras `changed` from one."""
        pose = T_world_cam.as_matrix().tobytes()
        if pose not in self._view:
            self._view.clear()
            self._view[pose] = StereoView.at(self.world, self.projector_light(T_world_cam), self.rig, T_world_cam)
        return self._view[pose]

    def render(self, T_world_cam: RigidTransform) -> tuple[RadianceLayers, RadianceLayers]:
        """Radiance at the left and the right imager for the reference laser power, behind their polarisers."""
        polarisers = self.settings.imager.polarisers
        return render_stereo(self.world, self.view(T_world_cam), self._sampling, polarisers=polarisers)

    def stopped_at_first_surface(
        self, T_world_cam: RigidTransform, left: RadianceLayers, right: RadianceLayers
    ) -> tuple[RadianceLayers, RadianceLayers]:
        """What was rendered from there, without mirror images and mutual light."""
        view, polarisers = self.view(T_world_cam), self.settings.imager.polarisers
        return stop_at_first_surface(self.world, view, self._sampling, (left, right), polarisers=polarisers)

    def dots_in_shadow(self, T_world_cam: RigidTransform) -> tuple[Float32[np.ndarray, "h w"], ...]:
        """What Lambertian surfaces would send to either imager if nothing hid the projector from them, beyond what they
        do send [W m^-2 sr^-1]."""
        view, n = self.view(T_world_cam), self._sampling.subpixels
        polarisers = self.settings.imager.polarisers
        passed = np.float32(1.0 if polarisers is None else polarisers.dots_passed)
        return tuple(passed * first.dots(n, 0).kept_from(self.world) for first in (view.left, view.right))

    def measure(self, T_world_cam: RigidTransform, n_frames: int) -> Measurement:
        """Render the pose once, then expose, match and decimate `n_frames` noisy pairs."""
        return self.expose(T_world_cam, *self.render(T_world_cam), n_frames)

    def expose(
        self,
        T_world_cam: RigidTransform,
        left: RadianceLayers,
        right: RadianceLayers,
        n_frames: int,
        pixels: Bool[np.ndarray, "h w"] | None = None,
    ) -> Measurement:
        """Measure from rendered layers; laser power, lamps, exposure and noise change without a new rendering.

        pixels: those whose depth is wanted, at least one; others may be left without. None = all in `window`.
        """
        imager, seen = self.settings.imager, self.seen(T_world_cam)
        if self.settings.auto_exposure:
            imager = self.auto_exposed(T_world_cam, left, imager)
        lefts, rights = (
            expose_burst(
                *(layers.projector, layers.ambient, imager, n_frames, seed, self.rig.chip),
                *(surfaces, self._lamp_share, rows_down),
            )
            for layers, seed, surfaces, rows_down in zip(
                (left, right),
                self._pose_seed(T_world_cam).spawn(2),
                seen,
                (0.0, self.settings.row_misalignment_px),
                strict=True,
            )
        )
        window = self.window if pixels is None else Window.around(pixels)
        disparities = self._matcher.match_burst(lefts, rights, window, self._search_start)
        z16 = z16_from_disparity(disparities, self.rig.focal_baseline, self.settings.depth)
        burst = DepthBurst(metres_from_z16(self.reduced(z16), self.settings.depth), self.intrinsics, T_world_cam)
        depths = metres_from_z16(z16, self.settings.depth)
        return Measurement(T_world_cam, left, right, imager, lefts, rights, z16, depths, burst)

    def auto_exposed(
        self,
        T_world_cam: RigidTransform,
        left: RadianceLayers,
        imager: ImagerSettings,
        pixels: Bool[np.ndarray, "h w"] | None = None,
    ) -> ImagerSettings:
        """The imager with the exposure and gain that suit the left image; pixels: see `auto_exposure`."""
        exposure_us, gain = auto_exposure(
            left.projector, left.ambient, imager, pixels, self.rig.chip, self.seen(T_world_cam)[0], self._lamp_share
        )
        return imager.model_copy(update={"exposure_us": exposure_us, "gain": gain})

    def seen(self, T_world_cam: RigidTransform) -> tuple[SeenSurfaces, SeenSurfaces]:
        """What optics and speckle need to know of what each imager sees; kept until pose, scene or geometry changes."""
        view = self.view(T_world_cam)
        if self._seen is None or self._seen[0] is not view or self._seen[1] is not self.world.source:
            materials = [body.material for body in self.world.source.bodies]
            projector = self.rig.projector(T_world_cam).translation
            left, right = (
                seen_surfaces(first.surface, materials, first.T_world_imager, projector)
                for first in (view.left, view.right)
            )
            self._seen = view, self.world.source, (left, right)
        return self._seen[2]

    def truth(self, T_world_cam: RigidTransform) -> Truth:
        """Exact maps at full resolution."""
        return measure_truth(self.world, self.rig, T_world_cam, self.view(T_world_cam).left.surface)

    @property
    def window(self) -> Window | None:
        """Full-resolution pixels that end up in the cropped depth; None = all."""
        if self.settings.crop is None:
            return None
        f, k = self.settings.decimation, self.rig.intrinsics
        width, height = self.settings.crop
        left, top = centre_corner((k.width // f, k.height // f), (width, height))
        return Window(left * f, top * f, width * f, height * f)

    def changed(
        self, scene: Scene | None = None, imager: ImagerSettings | None = None, **sampling: int | float
    ) -> "SimulatedD435i":
        """The same camera with one thing changed, its seed and so its noise kept.

        scene: another one before it, as it is without a filter. imager: exposure and gain held at these. sampling:
        fields of `Sampling`.
        """
        other = copy.copy(self)
        other.scene = scene or self.scene
        if imager is not None:
            other.settings = self.settings.model_copy(update={"imager": imager, "auto_exposure": False})
        seen = other._seen_scene
        if scene is not None or seen.lamp_band is not self.world.source.lamp_band:
            other.world = load_scene(seen, self.world)
            if not seen.has_geometry_of(self.world.source):
                other._view = {}
        other._sampling = replace(self._sampling, **sampling)
        return other

    def set_to(self, settings: SensorSettings, seed: int) -> "SimulatedD435i":
        """The same camera with other settings and other noise, before the same light: layers that either of them
        rendered are good for both. ValueError for settings under which the light would be another."""
        settings = settings.resolved()
        if settings.light != self.settings.light:
            raise ValueError("settings with another model, profile, dots or films have other light; make a new camera")
        other = copy.copy(self)
        other._set_to(settings, None)
        other._seed = seed
        return other

    def reduced(self, z16: UInt16[np.ndarray, "n h w"]) -> UInt16[np.ndarray, "n h_d w_d"]:
        """Decimated and cropped."""
        if self.settings.decimation > 1:
            z16 = decimate(z16, self.settings.decimation)
        if self.settings.crop is None:
            return z16
        _, h, w = z16.shape
        return crop_centre(z16, Intrinsics(w, h, 1.0, 1.0, 0.0, 0.0), self.settings.crop)[0]

    def _pose_seed(self, T_world_cam: RigidTransform) -> np.random.SeedSequence:
        """A seed of the camera's seed and the pose, to a nanometre, so that rounding does not change it."""
        digits = np.round(T_world_cam.as_matrix() * 1e9).astype(np.int64).tobytes()
        digest = hashlib.blake2b(digits, digest_size=16).digest()
        return np.random.SeedSequence([self._seed, *np.frombuffer(digest, np.uint32).tolist()])
