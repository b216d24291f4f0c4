"""What of a method is changed to see what it is good for: one model, resolved into a planner and its parameters."""

from typing import Annotated, Literal, NamedTuple

import numpy as np
import tyro
from jaxtyping import Bool
from pydantic import Field

from franbv.known_planners import PLANNERS
from franbv.parameters import Parameters
from franbv.planners import Planner, fra, pb, ray_entropy
from franbv.reflective_regions import FILTERS, View, first_hit_of_any, located
from franbv.robust.planner import RobustChange, partly_robust
from franbv.volumetric_information import DEFAULT_GAIN, Gain
from studies.base.config import Config

FilterName = Literal["persistence", "erosion", "frontier"]
"""The detector's filters in the paper's order, without the silhouette, which the erosion implies."""
IMAGE_FILTERS = {"persistence": "persistent_invalid", "erosion": "inside_eroded_silhouette"}
"""Those that judge pixels in the image, by the names that the detector knows them by."""

ROBUST_BASES = {"pb": pb, "fra": fra}
"""Planners that can take over pieces of fra-robust."""

TURN_DEG = 45.0
"""Turn of the diamond: halfway to the next pose of four [deg]."""


class Ablation(Config):
    """Changes to the method. Each flag changes one thing; what is left out stays as the parameters have it."""

    carve_on_missing: bool = False
    """Pixels without depth carve their rays free."""
    n_frames: Literal[1, 5, 15] | None = None
    """N_k, frames per pose [-]."""
    without_filter: FilterName | None = None
    """Filter of the detector that is left out. persistence: a pixel counts that is invalid in the first frame.
    erosion: up to the silhouette's edge. frontier: the first ellipsoid on the ray may be an occupied one."""
    turned_diamond: bool = False
    """The diamond of recovery poses is turned by 45 deg."""
    n_recovery_poses: Literal[4, 6, 8] | None = None
    """Recovery poses on the circle [-]."""
    random_order: bool = False
    """Recovery poses are taken in random order, not by utility."""
    recovered_share: Annotated[float | None, Field(ge=0.1, le=0.6), tyro.conf.arg(metavar="0.1..0.6")] = None
    """tau_rec, Gamma above which a recovery ends [-]."""
    full_covariance: bool = False
    """The mixtures' components may have any shape."""
    unweighted: bool = False
    """Every ellipsoid counts whole, however many are nearer."""
    ranked_by_depth: bool = False
    """Ellipsoids are ranked by Z-depth, not by their distance from the camera."""
    gain: Gain | None = None
    """RE: what a voxel is worth to a ray."""
    within_object: bool = False
    """RE: rays count within the object's box only."""
    robust: tuple[RobustChange, ...] | None = None
    """What of fra-robust pb or fra take over. map: evidence that false depth cannot undo. views: what is left to be
    measured, times the chance to succeed, which without the map is not known."""

    def changed(self, parameters: Parameters) -> Parameters:
        """The parameters with those changes that are a matter of numbers."""
        changes = {
            "carve_on_missing": True if self.carve_on_missing else None,
            "n_frames": self.n_frames,
            "diamond_angle_deg": parameters.diamond_angle_deg + TURN_DEG if self.turned_diamond else None,
            "n_recovery_poses": self.n_recovery_poses,
            "recovery_order": "random" if self.random_order else None,
            "recovered_share": self.recovered_share,
            "covariance": "full" if self.full_covariance else None,
            "weight_base": 1.0 if self.unweighted else None,
            "rank_by": "depth" if self.ranked_by_depth else None,
        }
        return parameters.model_copy(update={name: value for name, value in changes.items() if value is not None})

    def of_functions(self) -> "Ablation":
        """Those changes that are not in the parameters: what remains to be said once the parameters are changed."""
        return Ablation(
            without_filter=self.without_filter, gain=self.gain, within_object=self.within_object, robust=self.robust
        )

    def misfit(self, planner: str) -> str | None:
        """Why this planner cannot be changed so, or None."""
        if planner != "fra" and self.without_filter:
            return f"planner {planner} has no filters; leave out without_filter or choose fra"
        if planner != "re" and (self.gain or self.within_object):
            return f"planner {planner} casts no rays; leave out gain and within_object or choose re"
        if self.robust is not None and self.without_filter:
            return "without_filter and robust are changes of two kinds; leave one of them out"
        if self.robust is not None and planner not in ROBUST_BASES:
            takers = " or ".join(ROBUST_BASES)
            return f"planner {planner} takes over nothing of fra-robust; leave out robust or choose {takers}"
        return None


def build_planner(name: str, ablation: Ablation) -> Planner:
    """The planner of this name with those functions exchanged that the ablation exchanges."""
    if ablation.robust is not None:
        return partly_robust(ROBUST_BASES[name](), ablation.robust)
    if name == "fra":
        left_out = IMAGE_FILTERS.get(ablation.without_filter or "")
        filters = {name: keeps for name, keeps in FILTERS.items() if name != left_out}
        if ablation.without_filter == "persistence":
            filters = {"invalid_in_first_frame": invalid_in_first_frame, **filters}
        locate = first_hit_of_any if ablation.without_filter == "frontier" else located
        return fra(filters, locate)
    if name == "re":
        return ray_entropy(ablation.gain or DEFAULT_GAIN, ablation.within_object)
    return PLANNERS[name].build()


def invalid_in_first_frame(view: View) -> Bool[np.ndarray, "h w"]:
    """What a camera that takes one frame knows: without this test every pixel of the silhouette would be invalid."""
    return view.burst.depths[0] == 0


class NamedAblation(NamedTuple):
    """An ablation of the comparison."""

    words: str
    planner: str
    change: Ablation


ABLATIONS: dict[str, NamedAblation] = {
    "carve_on_missing": NamedAblation("pixels without depth carve", "fra", Ablation(carve_on_missing=True)),
    "n_frames_1": NamedAblation("one frame per pose", "fra", Ablation(n_frames=1)),
    "n_frames_5": NamedAblation("five frames per pose", "fra", Ablation(n_frames=5)),
    "no_persistence": NamedAblation("no persistence filter", "fra", Ablation(without_filter="persistence")),
    "no_erosion": NamedAblation("no erosion of the silhouette", "fra", Ablation(without_filter="erosion")),
    "no_frontier_test": NamedAblation("no frontier test", "fra", Ablation(without_filter="frontier")),
    "turned_diamond": NamedAblation("diamond turned by 45 deg", "fra", Ablation(turned_diamond=True)),
    "poses_6": NamedAblation("six recovery poses", "fra", Ablation(n_recovery_poses=6)),
    "poses_8": NamedAblation("eight recovery poses", "fra", Ablation(n_recovery_poses=8)),
    "random_order": NamedAblation("recovery poses in random order", "fra", Ablation(random_order=True)),
    **{
        f"tau_rec_{percent}": NamedAblation(f"tau_rec {percent} %", "fra", Ablation(recovered_share=percent / 100))
        for percent in (10, 20, 40, 50, 60)
    },
    "full_covariance": NamedAblation("components of any shape", "fra", Ablation(full_covariance=True)),
    "unweighted": NamedAblation("no weights by nearness", "fra", Ablation(unweighted=True)),
    "ranked_by_depth": NamedAblation("ellipsoids ranked by Z-depth", "fra", Ablation(ranked_by_depth=True)),
    "pb_robust_map": NamedAblation("PB, map of fra-robust", "pb", Ablation(robust=("map",))),
    "fra_robust_map": NamedAblation("FRA, map of fra-robust", "fra", Ablation(robust=("map",))),
    "pb_robust_views": NamedAblation("PB, views of fra-robust", "pb", Ablation(robust=("views",))),
    "fra_robust_both": NamedAblation("FRA, map and views of fra-robust", "fra", Ablation(robust=("map", "views"))),
    "re_occlusion_aware": NamedAblation("RE, unknown voxels half empty", "re", Ablation(gain="occlusion_aware")),
    "re_unobserved": NamedAblation("RE, untouched voxels only", "re", Ablation(gain="unobserved")),
    "re_entropy": NamedAblation("RE, entropy up to the first surface", "re", Ablation(gain="entropy")),
    "re_rear_side": NamedAblation("RE, rear sides", "re", Ablation(gain="rear_side")),
    "re_within_object": NamedAblation("RE, within the object's box", "re", Ablation(within_object=True)),
    "re_unobserved_within_object": NamedAblation(
        "RE, untouched voxels of the object's box", "re", Ablation(gain="unobserved", within_object=True)
    ),
}
"""By the names that the comparison's flag takes."""
