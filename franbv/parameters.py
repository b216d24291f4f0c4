"""Every number of the method in one frozen model, each with its unit and its source.

"Table" is the parameter table of the FRA-NBV paper; "text" is the paper's prose; "choice" is ours, with
the reason. Lengths [m], angles [deg] where the name says so. The studies load it from YAML; unknown keys are refused.
"""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

Positive = Annotated[float, Field(gt=0)]
Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=1)]
PolarAngle = Annotated[float, Field(ge=0, le=90)]
Vector = tuple[float, float, float]
RankBy = Literal["distance", "depth"]
Weighting = Literal["geometric", "harmonic"]


def _number(default, description: str):
    return Field(default=default, description=description)


LEAST_UPDATE = 1e-3
"""Of an occupancy from 0.5 [-] (choice: a weaker one needs hundreds of rays to say anything)."""


class Parameters(BaseModel):
    """All parameters of PB-NBV and FRA-NBV: those of the paper's table, and what the paper leaves open.

    Frozen. Unknown keys, numbers out of range, and corners, odds or angles in the wrong order raise pydantic's
    ValidationError. Nothing of the sensor, the arm or the part is in here, nor how a study evaluates a run.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    # -- acquisition -------------------------------------------------------------------------------------------------
    n_frames: Count = _number(15, "N_k, depth frames taken from each pose [-]. Table.")

    roll_deg: Annotated[float, Field(ge=-180, le=180)] = _number(
        0.0,
        "Turn of the camera in its mount about its optical axis, clockwise as it looks [deg]: 0 = baseline horizontal, "
        "90 = on end. Every pose that the planner asks for carries it. Choice: 0, as on a tripod; on a robot whatever "
        "the bracket has. The commands set it from the simulated sensor's own, so that the two cannot disagree.",
    )

    # -- voxel map ---------------------------------------------------------------------------------------------------
    voxel_size: Positive = _number(0.0075, "s_v, voxel side [m]. Table.")
    workspace_min: Vector = _number(
        (-0.2475, -0.2475, -0.015),
        "Centre of the mapped box's lowest voxel [m]. Choice: the 67 x 67 x 43 voxels that the parameter table of the "
        "authors' project page has, around the origin, two layers below the table so that its surface is inside.",
    )
    workspace_max: Vector = _number(
        (0.2475, 0.2475, 0.30),
        "Centre of the mapped box's highest voxel [m]. Choice: as `workspace_min`.",
    )
    hit_probability: Share = _number(0.7, "Occupancy of a voxel in which a ray ends [-]. OctoMap's default.")
    miss_probability: Share = _number(
        0.48,
        "Occupancy of a voxel that a ray crosses [-]. Choice: nearer to 0.5 than OctoMap's 0.4, so that false depth "
        "does not undo in one view what another hit; of the readings it comes nearest to the paper's four objects "
        "(docs/comparison.md).",
    )
    min_probability: Share = _number(0.12, "Lower clamp of the occupancy [-]. OctoMap's default (0.1192).")
    max_probability: Share = _number(0.97, "Upper clamp of the occupancy [-]. OctoMap's default (0.971).")
    occupied_probability: Share = _number(
        0.5,
        "Occupancy above which a voxel is occupied; from 0.5 to here it is uncertain [-]. Choice: 0.5, OctoMap's "
        "default; at hit_probability one hit does not make a voxel occupied.",
    )
    frames_into_map: Literal["median", "each"] = _number(
        "median",
        "What of a burst enters the map: the median of its frames once, or every frame. Choice: median; the frames of "
        "one pose share what is wrong with them, so that each of them would count it anew.",
    )
    carve_on_missing: bool = _number(
        False,
        "Whether pixels without depth carve their rays free. Choice: no, it would erase the very holes; an ablation.",
    )

    # -- object ------------------------------------------------------------------------------------------------------
    table_height: float = _number(0.0, "World z of the table top [m]. Convention of the world frame.")
    table_clearance: Positive = _number(
        0.005,
        "Voxels whose centre is less than this above the table belong to it [m]. Choice: with voxel centres at "
        "multiples of s_v this removes the layer that holds the table top, and no more.",
    )
    min_component_voxels: Count = _number(
        5, "Smallest connected component kept as object [voxels]. Choice: floaters of false depth are smaller."
    )
    min_component_share: Share = _number(
        0.1,
        "Components below this share of the largest are dropped [-]. Choice: floaters inflate the box and push the "
        "candidates away.",
    )
    prior_min: Vector = _number(
        (-0.1, -0.1, 0.0), "Lower corner of the box that stands in until a voxel is occupied [m]. Choice: 20 cm parts."
    )
    prior_max: Vector = _number(
        (0.1, 0.1, 0.12), "Upper corner of the box that stands in until a voxel is occupied [m]. Choice: 20 cm parts."
    )

    # -- ellipsoids --------------------------------------------------------------------------------------------------
    max_components: Count = _number(
        20, "Largest number of mixture components tried by BIC [-]. Choice: with 10 most fits end at the cap."
    )
    covariance: Literal["spherical", "full"] = _number(
        "spherical",
        "Covariance of the mixture components. Choice: as in the published PB-NBV code; full is an ablation.",
    )
    enclosing_tolerance: Positive = _number(
        0.01, "Relative tolerance of the minimum-volume enclosing ellipsoid [-]. Choice: far below a voxel."
    )

    # -- utility -----------------------------------------------------------------------------------------------------
    weight_base: Share = _number(
        0.5, "Weight of an ellipsoid is weight_base^rank [-]. Published PB-NBV code; 1 turns the weights off."
    )
    weighting: Weighting = _number(
        "geometric",
        "How the weight falls with the rank: weight_base^rank, or 1 / (rank + 1). Published PB-NBV code; the text, "
        "below eq. (2), says that it falls.",
    )
    rank_by: RankBy = _number(
        "distance",
        "What ellipsoids are ranked by: distance of the centre from the camera, or its Z-depth. Text, below eq. (2); "
        "depth is an ablation.",
    )
    area_supersampling: Count = _number(
        4,
        "Sub-pixels per pixel side for clipped areas [-]. Choice: a 60 x 40 image is too coarse for small ellipsoids.",
    )

    # -- candidates --------------------------------------------------------------------------------------------------
    n_candidates: Count = _number(32, "N_pos, candidate poses per iteration [-]. Table.")
    stand_off: Positive = _number(0.20, "gamma; candidates stand at gamma plus the box's half diagonal [m]. Table.")
    n_rings: Count = _number(4, "Rings of candidates on the hemisphere [-]. Choice: 32 poses about 30 deg apart.")
    polar_min_deg: PolarAngle = _number(20.0, "Polar angle of the upper ring [deg]. Choice: straight down adds little.")
    polar_max_deg: PolarAngle = _number(80.0, "Polar angle of the lower ring [deg]. Choice: clear of the table.")
    first_elevation_deg: PolarAngle = _number(45.0, "Elevation of the first view [deg]. Choice: sees top and sides.")

    # -- stop rules --------------------------------------------------------------------------------------------------
    max_iterations: Count = _number(15, "N_max, NBV iterations; recovery acquisitions do not count [-]. Table.")
    stagnation_change: Share = _number(
        0.01, "tau_stag, change of the best utility over the largest absolute utility so far [-]. Table."
    )
    stagnation_against: Literal["largest", "last"] = _number(
        "largest",
        "What a change is relative to: the largest absolute utility so far, or the last one. Choice: the largest, "
        "since U crosses zero and a ratio to the last value would not settle.",
    )
    stagnation_iterations: Count = _number(5, "Consecutive iterations below tau_stag that end the run [-]. Table.")

    # -- reflective regions ------------------------------------------------------------------------------------------
    invalid_share: Share = _number(0.5, "eta at and above which a pixel is frequently invalid [-]. Eq. (7).")
    detection_ellipsoids: Literal["updated", "previous"] = _number(
        "updated",
        "Ellipsoids that a burst's holes are held against: those with that burst in the map, or those before it. "
        'Choice: updated; the text, section V-A, says "the current estimate".',
    )
    silhouette_of: Literal["all", "occupied"] = _number(
        "all", "Ellipsoids whose projection is I_o: E_o and E_f, or E_o alone. Text, section V-A."
    )
    located_on: Literal["first_frontier", "nearest_frontier", "any"] = _number(
        "first_frontier",
        "Where a pixel's ray must end: at its first hit of all ellipsoids, if that one is of the frontier; at the "
        "nearest one of the frontier, whatever lies before it; or at the first hit of any. Text, below eq. (9).",
    )
    cluster_radius_voxels: Positive = _number(
        2.0, "DBSCAN eps [s_v]. Choice: neighbours survive a one-voxel gap, at any resolution of the map."
    )
    cluster_min_samples: Count = _number(5, "DBSCAN min_samples [pixels]. Choice: a blob of at least a pixel's cross.")

    regions_recovered: Literal["largest", "all"] = _number(
        "largest", "Regions of a burst that are recovered. Text, section V-B; all, by volume, is another reading."
    )
    recoveries_in_turn: Count = _number(
        1,
        "Recoveries after which an NBV iteration searches no more [-]: as long as it has made fewer, the last burst of "
        "a recovery is searched for regions, too, and what is found there is recovered next. Further regions of one "
        "burst, with `regions_recovered` all, count as well, but are recovered however many they are. Choice: 1, so "
        "that bursts of recoveries are never searched; the text tells of no recovery that follows from another.",
    )

    # -- recovery ----------------------------------------------------------------------------------------------------
    lateral_offset: Positive = _number(0.10, "rho, lateral offset of the recovery poses [m]. Table.")
    recovery_distance: Positive = _number(0.10, "d, stand-off of the recovery poses along n_r [m]. Table.")
    n_recovery_poses: Count = _number(4, "Poses of the diamond [-]. Text, eq. (12).")
    diamond_angle_deg: float = _number(0.0, "theta of the first pose of the diamond [deg]. Text, eq. (12).")
    diamond_turn_deg: float = _number(
        45.0, "Turn of the diamond when too few poses remain [deg]. Choice: halfway to the next pose of four."
    )
    min_recovery_poses: Count = _number(
        2, "Fewer reachable poses than this turn the diamond once [-]. Choice: one pose gives no angular diversity."
    )
    min_z_margin: float = _number(
        0.01, "Recovery poses keep the sensor's Min-Z plus this from the region [m]. Choice: depth noise and box error."
    )
    recovery_order: Literal["utility", "random"] = _number(
        "utility", "Order of the recovery poses. Text, eq. (14); random is an ablation."
    )
    recovered_share: Share = _number(0.3, "tau_rec, Gamma above which a recovery ends [-]. Table.")
    capacity: Literal["volume", "sheet"] = _number(
        "volume",
        "N_cap, what Gamma is a share of: all voxels of the enlarged box, or those of a sheet across it, which is all "
        "that a surface can fill. Text, eq. (15), has the first.",
    )

    @model_validator(mode="after")
    def _ordered(self) -> "Parameters":
        if not all(lo < hi for lo, hi in zip(self.workspace_min, self.workspace_max, strict=True)):
            raise ValueError(f"workspace_min {self.workspace_min} is not below workspace_max {self.workspace_max}")
        if not all(lo < hi for lo, hi in zip(self.prior_min, self.prior_max, strict=True)):
            raise ValueError(f"prior_min {self.prior_min} is not below prior_max {self.prior_max}")
        if not self.min_probability < self.miss_probability < 0.5 < self.hit_probability < self.max_probability:
            raise ValueError("occupancy must obey min < miss < 0.5 < hit < max")
        weakest = min(self.hit_probability - 0.5, 0.5 - self.miss_probability)
        if weakest < LEAST_UPDATE:
            raise ValueError(f"hit and miss must be at least {LEAST_UPDATE} away from 0.5, or they tell nothing")
        if not 0.5 <= self.occupied_probability < self.max_probability:
            raise ValueError("occupied_probability must be at least 0.5 and below max_probability")
        if self.polar_max_deg == 0.0:
            raise ValueError("polar_max_deg must be above 0, or all candidates stand in one place")
        if not self.polar_min_deg <= self.polar_max_deg:
            raise ValueError(f"polar_min_deg {self.polar_min_deg} is above polar_max_deg {self.polar_max_deg}")
        return self
