"""Light that sharp lobes throw onto Lambertian surfaces: what light paths from the imagers find too rarely.

Photons (H. W. Jensen, Global illumination using photon maps, EGWR 1996) from the projector and from the lamps are shot
at what is sharp alone, followed from one glossy surface to the next, and left on the first Lambertian one. There each
is spread to a share of the width of the lobe that threw it, and counted into the pixels of both imagers. The photons
are the same for both, so what error remains lies on the surface as the caustic itself does.

They are smoothed twice, since neither way does alone. A lobe's width spreads what a photon stands for where the lobe is
wide; a fixed blur joins what is left apart where it is narrow, and makes soft what few photons of wide lamps hit. On
part D, a polished ball and an inside corner the error of the dots' caustics is 1.6 to 1.9 times as large without the
first and 2.2 to 2.4 times without the second, that of the lamps' 1.4 and 10 times: three photons for one and more.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float32
from scipy.ndimage import binary_dilation

from render.light.first_surface import FirstSurface
from render.light.projector_view import CELLS, ProjectorView
from render.light.scatter import scatter
from render.world import backend
from render.world.mitsuba_scene import LoadedScene
from render.world.scene_geometry import FIRST_LAMP
from render.world.surface import SurfaceMap

MOST_PER_CELL = 64
"""Photons of one cell of the projector's field (choice: 16 a pixel of 640x360)."""
MOST_BOUNCES = 4
"""Glossy surfaces that a photon is followed to (choice: 0.7^4, a quarter of the light, at the most is left)."""
SPLAT_SIGMA = 0.25
"""Standard deviation to which a photon is spread, in units of the radius of what it stands for, t sqrt(angle / pi) at
distance t and a solid angle that is one over its lobe's density and that of its lamp (choice: it widens the caustic by
3 %)."""
START, REACHED = 1e-4, 1e-3
"""Photons start this far before a lamp, and have met the point that they were shot at when they end as near as that
[m]."""
SPLATS = 4
"""Points by which that is drawn."""


@dataclass(frozen=True, eq=False)
class Photons:
    """Where they lie; Dr.Jit, one value a splat."""

    position: Any
    """[m]"""
    normal: Any
    """Of the surface, on the side that they came from."""
    body: Any
    """As `LoadedScene.body` counts."""
    power: Any
    """[W]"""


def from_projector(world: LoadedScene, view: ProjectorView, most: int, seed: int) -> Photons | None:
    """The dots: at most `most` photons; None where the projector shines on nothing sharp."""
    mi = backend.mitsuba()
    import drjit as dr

    sharp = binary_dilation(world.reflectances.sharp.numpy()[view.body] > 0, np.ones((3, 3)))
    cells = np.flatnonzero(sharp)
    if not len(cells) or not most:
        return None
    per_cell = int(np.clip(most // len(cells), 1, MOST_PER_CELL))
    random = mi.PCG32(len(cells) * per_cell, initstate=seed)
    index = dr.arange(mi.UInt32, len(cells) * per_cell)
    cell = dr.gather(mi.UInt32, mi.UInt32(cells.astype(np.uint32)), index // per_cell)
    row = cell // CELLS[0]
    width, height = view.cell_size
    light = view.light
    # Strata in x; plain chance in y.
    stratum = (mi.Float(index % per_cell) + random.next_float32()) / per_cell
    x = (mi.Float(cell - row * CELLS[0]) + stratum) * width - light.half_field[0]
    y = (mi.Float(row) + random.next_float32()) * height - light.half_field[1]
    direction = dr.normalize(light.world_to_projector.T @ mi.Vector3f(x, y, 1))
    s, _ = light.white_wall_radiance(direction, mi.Float(0), mi.Bool(True))
    power = dr.pi * s * (width * height / per_cell)
    return _flown(world, mi.Ray3f(light.position, direction), power, mi.Float(0), random, 0, seed)


def from_lamps(world: LoadedScene, most: int, seed: int) -> Photons | None:
    """The lamps' light: photons to points that lie evenly on the sharp bodies; None without lamps or such bodies.

    They are the same for all poses, and kept.
    """
    if (most, seed) not in world.lamp_photons:
        world.lamp_photons[most, seed] = _shot_from_lamps(world, most, seed)
    return world.lamp_photons[most, seed]


def _shot_from_lamps(world: LoadedScene, most: int, seed: int) -> Photons | None:
    """A lamp of radiance L sends L cos cos dA dA / d^2 from one patch of itself to one of a surface."""
    mi = backend.mitsuba()
    import drjit as dr

    patches = world.geometry.patches
    sharp = np.flatnonzero(world.reflectances.sharp.numpy()[patches.body] > 0)
    if not len(sharp) or not most or not world.lamps:
        return None
    rng = np.random.default_rng(seed)
    chosen = rng.choice(sharp, most, p=patches.area[sharp] / patches.area[sharp].sum())
    place = rng.integers(patches.position.shape[1], size=most)
    goal, normal = (
        mi.Point3f(np.ascontiguousarray(a[chosen, place].T, np.float32)) for a in (patches.position, patches.normal)
    )
    random = mi.PCG32(most, initstate=seed)
    lamp = mi.UInt32(rng.integers(len(world.lamps), size=most).astype(np.uint32))
    start, facing, area, radiance = mi.Point3f(0), mi.Normal3f(0), mi.Float(0), mi.Float(0)
    u, v = random.next_float32(), random.next_float32()
    for number, candidate in enumerate(world.lamps):
        own, (point, _, _) = lamp == number, candidate.connection(goal, u, v)
        start, facing = dr.select(own, point, start), dr.select(own, mi.Normal3f(candidate.normal), facing)
        area, radiance = dr.select(own, candidate.area, area), dr.select(own, candidate.radiance, radiance)
    way = goal - start
    distance = dr.norm(way)
    direction = way / distance
    # Neighbouring photons come from all over the lamp: its solid angle widens what one of them stands for.
    angle = area * dr.maximum(dr.dot(direction, facing), 0) / dr.square(distance)
    each = float(patches.area[sharp].sum() * len(world.lamps) / most)
    power = radiance * angle * dr.abs(dr.dot(direction, normal)) * each
    ray = mi.Ray3f(start + direction * START, direction)
    met = world.scene.ray_intersect_preliminary(ray)
    power = dr.select(dr.abs(met.t + START - distance) < REACHED, power, 0)
    return _flown(world, ray, power, angle, random, 1, seed)


def _flown(world: LoadedScene, ray: Any, power: Any, angle: Any, random: Any, band: int, seed: int) -> Photons | None:
    """Photons of these rays, where they end. angle: solid angle that each stands for before its first lobe [sr].
    band: 0 = 850 nm, 1 = under the lamps."""
    mi = backend.mitsuba()
    import drjit as dr

    n = dr.width(power)
    if world.reflectances.has_others:
        _ = world.reflectances.bsdfs
    start = _Flight(
        ray,
        power,
        power > 0,
        dr.zeros(mi.UInt32, n),
        mi.Float(angle) + dr.zeros(mi.Float, n),
        dr.zeros(mi.Point3f, n),
        dr.zeros(mi.Normal3f, n),
        dr.zeros(mi.UInt32, n),
        dr.zeros(mi.Float, n),
        dr.zeros(mi.Float, n),
    )
    end, _ = dr.while_loop((start, random), lambda p, r: p.active, lambda p, r: (_fly(world, p, r, band), r))
    return _spread(end, seed)


@dataclass
class _Flight:
    """Photons on their way; Dr.Jit."""

    ray: Any
    power: Any
    active: Any
    bounces: Any
    angle: Any
    """Solid angle that each stands for [sr]."""
    position: Any
    """Where they were left."""
    normal: Any
    body: Any
    left: Any
    """Power that they left there [W]."""
    radius: Any
    """Of their lobe there [m]."""


def _fly(world: LoadedScene, photon: _Flight, random: Any, band: int) -> _Flight:
    """To the next surface, and on from there or not."""
    mi = backend.mitsuba()
    import drjit as dr

    surfaces = world.reflectances
    si = world.scene.ray_intersect(photon.ray, mi.RayFlags.All, coherent=photon.bounces == 0, active=photon.active)
    body = world.body(si)
    met = photon.active & si.is_valid() & (body < FIRST_LAMP)
    glossy = world.is_glossy(body)
    sharp = dr.gather(mi.UInt32, surfaces.sharp, body, met) > 0
    arrived = met & ~glossy & (photon.bounces > 0)
    onwards = met & glossy & ((photon.bounces > 0) | sharp) & (photon.bounces < MOST_BOUNCES)
    u, v = random.next_float32(), mi.Point2f(random.next_float32(), random.next_float32())
    lobes = scatter(si, surfaces, body, mi.Vector3f(0, 0, 1), [], u, v, mi.Bool(False), onwards)
    power = photon.power * lobes.weight[band]
    onwards &= (lobes.pdf > 0) & (power > 0)
    cosine = dr.maximum(dr.abs(dr.dot(si.n, photon.ray.d)), 0.1)
    radius = si.t * dr.sqrt(photon.angle / (dr.pi * cosine))
    return _Flight(
        si.spawn_ray(si.to_world(lobes.onwards)),
        power,
        onwards,
        photon.bounces + 1,
        photon.angle + dr.rcp(dr.maximum(lobes.pdf, 1e-6)),
        dr.select(arrived, si.p, photon.position),
        dr.select(arrived, dr.mulsign(si.n, -dr.dot(si.n, photon.ray.d)), photon.normal),
        dr.select(arrived, body, photon.body),
        dr.select(arrived, photon.power, photon.left),
        dr.select(arrived, radius, photon.radius),
    )


def _spread(end: _Flight, seed: int) -> Photons | None:
    """Every photon as several points about it, in the plane of its surface."""
    mi = backend.mitsuba()
    import drjit as dr

    dr.eval(end)
    there = np.flatnonzero(end.left.numpy() > 0)
    if not len(there):
        return None
    index = dr.arange(mi.UInt32, len(there) * SPLATS)
    photon = dr.gather(mi.UInt32, mi.UInt32(there.astype(np.uint32)), index // SPLATS)
    random = mi.PCG32(len(there) * SPLATS, initstate=seed + 1_000_003)
    normal = dr.gather(mi.Normal3f, end.normal, photon)
    offset = mi.warp.square_to_std_normal(mi.Point2f(random.next_float32(), random.next_float32()))
    offset *= SPLAT_SIGMA * dr.gather(mi.Float, end.radius, photon)
    position = dr.gather(mi.Point3f, end.position, photon) + mi.Frame3f(normal).to_world(
        mi.Vector3f(offset.x, offset.y, 0)
    )
    body, power = dr.gather(mi.UInt32, end.body, photon), dr.gather(mi.Float, end.left, photon) / SPLATS
    dr.eval(position, normal, body, power)
    return Photons(position, normal, body, power)


def caustics(photons: Photons | None, first: FirstSurface, blur_px: float) -> Float32[np.ndarray, "h w"]:
    """Irradiance over pi on what an imager sees [W m^-2 sr^-1].

    blur_px: standard deviation to which it is smoothed, within each body and direction of its surface.

    A pixel whose middle lies on a photon's surface shows it. Its share of that surface measures z^3 / (d f^2 cos), at
    Z-depth z and distance d, and cos between the normal and the way to the imager.
    """
    import drjit as dr

    if photons is None:
        return np.zeros(first.shape, np.float32)
    pixel, seen, z = first.seen_surface.at(photons.position, photons.normal, photons.body, photons.power > 0)
    way = first.imager.origin - photons.position
    distance = dr.norm(way)
    cosine = dr.dot(way, photons.normal) / distance
    fx, fy, _, _ = first.imager.calibration
    white = photons.power * cosine * fx * fy * distance / (dr.pi * z * z * z)
    white = dr.select(seen & (cosine > 0), white, 0)
    pixel = dr.select(seen, pixel, 0)
    dr.eval(white, pixel)
    # Summed on the host, in the photons' order: on the device the order, and so the rounding, is left to chance.
    sums = np.bincount(pixel.numpy(), white.numpy(), first.shape[0] * first.shape[1])
    return _smoothed(sums.reshape(first.shape).astype(np.float32), first.surface, blur_px)


def _smoothed(image: Float32[np.ndarray, "h w"], surface: SurfaceMap, sigma: float) -> Float32[np.ndarray, "h w"]:
    """Blurred without a leak from one body, or one of six directions, to another."""
    largest = np.argmax(np.abs(surface.normal), axis=-1)
    facing = np.take_along_axis(surface.normal, largest[..., None], axis=-1)[..., 0] > 0
    key = surface.body.astype(np.int32) * 6 + 2 * largest + facing
    out = np.zeros_like(image)
    for one in np.unique(key[image > 0]):
        own = key == one
        rows, columns = np.flatnonzero(own.any(axis=1)), np.flatnonzero(own.any(axis=0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        mask = own[box].astype(np.float32)
        share = cv2.GaussianBlur(mask, (0, 0), sigma, borderType=cv2.BORDER_CONSTANT)
        # What lies beside an edge gets what would have left over it.
        light = cv2.GaussianBlur(
            image[box] * mask / np.maximum(share, 1e-6), (0, 0), sigma, borderType=cv2.BORDER_CONSTANT
        )
        out[box] += light * mask
    return out
