"""The numbers of fra-robust beyond those of `franbv.parameters`, each with its unit and its reason."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from franbv.parameters import Count, Positive, Share


class RobustSettings(BaseModel):
    """Of the map, of what is believed about views, and of the choice among them. Frozen; unknown keys are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    # -- map ---------------------------------------------------------------------------------------------------------
    false_hit: Annotated[float, Field(gt=0, lt=0.5)] = 0.004
    """Probability that a depth which is wrong ends in a given free voxel of its ray [-]. Choice: a few percent of
    depths lie before the surface, spread over the ten to twenty voxels there."""
    mirrors: Share = 0.3
    """Prior probability that a place lets rays pass as mirrors do, with any rate alike [-]. Choice: neither rule nor
    exception; what is known of the material does not enter."""
    passing: Positive = 9.0
    """Elsewhere the rate at which rays pass a surface is distributed as Beta(1, this) [-]. Choice: one in ten, as at
    silhouettes of matte parts."""
    mixed_step: Positive = 0.012
    """A block is mixed if opposite neighbours lie nearer and farther than it by more than this [m]. Choice: a plane
    does that at this camera's resolution beyond 65 deg of incidence alone, where depth is worth little."""
    mixed_trust: Share = 0.1
    """Trust in the depth of a mixed block [-]. Choice: one of ten happens to lie right."""
    support_step: Positive = 0.012
    """A neighbour supports a pixel if its depth differs by less than this [m]. Choice: as `mixed_step`."""
    supporting: Count = 5
    """Of the eight neighbours that must support a pixel, or it is an edge or a floater [-]. Choice: on a straight edge
    of a surface five do."""
    unsupported_trust: Share = 0.3
    """Trust in the depth of other pixels [-]. Choice: then one pass outweighs a hit by one of them, and five views
    together confirm."""
    spared_voxels: Positive = 4.0
    """Of a ray before its end, at most, that it does not pass: a voxel over the cosine of its incidence [s_v]. Choice:
    at 75 deg a ray stays within a voxel of a plane for four."""
    confirmed_hits: Positive = 1.5
    """Hits, weighted by trust, from which a surface counts as confirmed [-]. Choice: two views must agree."""
    contradiction_voxels: Positive = 2.0
    """A ray contradicts confirmed surface if it ends farther than this behind it [s_v]. Choice: noise and the
    surface's place within its voxel make one."""
    least_cosine: Share = 0.3
    """Of the angle between a ray and a surface's normal below which it only grazes it and contradicts nothing [-].
    Choice: at 73 deg a ray stays within a layer of voxels for three of them."""
    passes: Count = 2
    """Rounds of finding surface and taking back what contradicts it, for each burst [-]. Choice: a third changes less
    than one voxel in a hundred."""

    # -- regions -----------------------------------------------------------------------------------------------------
    sure_log_odds: Positive = 4.0
    """Log-odds from which a voxel surely holds surface, for the hull of the object [-]. Choice: one whole hit has 5.3,
    one hit and one whole pass 3.3."""
    least_inside_voxels: Positive = 0.5
    """A pixel looks at the object if its ray comes deeper than this below the hull [s_v]. Choice: as
    far as the hull may be wrong, which runs through the middle of voxels; a wedge is shallow where it is looked at."""
    least_inside_share: Share = 0.5
    """Or than this share of what any ray of the view does [-]. Choice: half, for thin parts and thin first hulls."""
    false_inside_voxels: Positive = 1.5
    """Depth is called false only where the ray comes deeper below the hull than this [s_v]. Choice: half a voxel more
    than for a hole, since right depth of what lies past a rim that is none would be called false."""
    false_behind_voxels: Positive = 1.5
    """Depth is false if it ends farther than this behind confirmed surface, or behind the hull [s_v]. Choice: as
    `contradiction_voxels`, less the half voxel by which a hull through voxels' centres lies within the surface."""
    hollow_voxels: Positive = 4.0
    """Depth that ends within the hull, farther than this behind its face, is suspected [s_v]. Choice: deeper than a
    step or a groove of a part; it takes one more sign to make it false."""
    depth_noise: Positive = 0.006
    """RMS of depth is this times its square [1/m]. D400 depth quality: 0.1 px over f B, which is 17 px m of a D435 at
    640 x 360."""
    noisy: Positive = 3.0
    """Depth that ends deep within the hull is false if its spread over a burst is this times noise [-]. The usual
    three."""
    noisy_on_table: Positive = 1.5
    """Or this times, if it ends on the table [-]. Choice: half, since the table within the hull is no place to see."""
    noisy_beyond: Positive = 1.0
    """Depth that passes the hull whole is false if its spread is this times noise [-]. Choice: any that is more than
    the most that the camera is to have."""
    baseline: Positive = 0.05
    """Between the imagers [m]. The D435's; a D415 has 0.055."""
    steepest: Positive = 0.5
    """Change of disparity from pixel to pixel beyond which a matcher's window does not hold a surface [px per px].
    Choice: two whole steps between the middle and the rim of a 9 x 9 window; 74 deg of incidence at 0.35 m."""
    at_hull_voxels: Positive = 3.0
    """Confirmed surface farther than this behind the hull's face is the far side of the part [s_v]. Choice: beyond what
    grooves have, and thinner than parts are."""
    near_margin: Annotated[float, Field(ge=1)] = 1.05
    """Missing depth beside depth of less than this times the least that the camera measures is missing for being too
    near [-]. Choice: at its edge such a hole has depth just beyond that."""
    bordering: Count = 3
    """Pixels of such depth that a region of missing depth must border on [-]. Choice: one or two may be false."""
    mirror_trials: Positive = 2.0
    """Failures from aslant that any surface begins with, beside one success [-]. Choice: of surface of which nothing is
    known, or a voxel or two, a hole is one of reflection."""
    alike_trials: Positive = 4.0
    """Views from aslant that what is known of surface alike counts as, beside those of a place itself [-]. Choice: as
    many as see a place in a run, at most."""
    dull: Annotated[float, Field(ge=0.5, le=1)] = 0.5
    """Missing or false depth is none of reflection where a larger share of views from aslant measures the surface than
    this [-]. Choice: more often than not."""
    sag: Share = 0.1
    """Of the distance to the nearest measured voxel, by which surface may leave the hull [-]. Choice: a round part that
    is measured every 60 deg."""

    # -- views -------------------------------------------------------------------------------------------------------
    resolution: Positive = 0.005
    """Surface counts as measured if a point lies nearer than this [m]. The paper's threshold of coverage (section VI)
    and two thirds of its voxel."""
    pixels_per_trial: Positive = 20.0
    """Pixels of one view that count as one trial of an incidence and a turn of the camera [-]. Choice: the pixels of a
    patch go together."""
    supposed: Annotated[float, Field(gt=0, lt=1)] = 0.5
    """Chance that there is surface where the hull supposes it, before anything is known [-]. Choice: as likely as
    air."""
    element_trials: Positive = 1.0
    """Failed looks at a place after which success there is held half as likely [-]. Choice: as if one success had been
    seen beforehand."""
    turns_deg: tuple[float, ...] = (0.0, 90.0)
    """Turns of the camera about its axis, beside the mount's, that are offered [deg]. Choice: a baseline along and
    across whatever mirrors; 180 would see the same."""
    least_gain: Share = 0.01
    """Share of the surface that a view must promise, or it is hardly worth it [-]. Choice: one percent, of which late
    views keep a tenth."""
    sensing_s: Positive = 3.0
    """Time of a view besides the motion [s]. Choice: a motion planner's second or two, settling, auto-exposure, and
    half a second of frames."""
    speed: Positive = 0.5
    """Of the camera between two views [m/s]. Choice: a planned motion at half of a collaborative arm's speed."""
    turning_speed: Positive = 1.5
    """Of its turn [rad/s]. Choice: as `speed`."""
