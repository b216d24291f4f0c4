"""Decisions that the FRA-NBV paper leaves open, two levels each: readings of its text, never a number of the bench.

The first level is that of `franbv.parameters`. Nothing here changes a material, a lamp or the sensor.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from franbv.parameters import Parameters

RECOVERS = "fra"
"""The planner that detects and recovers reflective regions; what others are told of that does not reach them."""


@dataclass(frozen=True)
class Decision:
    """One question to the paper with two answers that its text allows."""

    name: str
    question: str
    first: str
    """The default in words."""
    second: str
    """The alternative."""
    values: tuple[Mapping[str, Any], Mapping[str, Any]]
    """Fields of `Parameters` at the first and the second level."""
    of_recovery: bool
    """Whether only the detector and the recovery read them: PB and RE are then the same at both levels."""
    silent: str
    """Section of the paper, and what is not said there."""

    def changed(self, parameters: Parameters, is_second: bool) -> Parameters:
        """The parameters with this decision taken."""
        return parameters.model_copy(update=dict(self.values[is_second]))


DECISIONS: tuple[Decision, ...] = (
    Decision(
        "detection_ellipsoids",
        "Which ellipsoids are a burst's holes held against?",
        "those with that burst in the map",
        "those before it",
        ({"detection_ellipsoids": "updated"}, {"detection_ellipsoids": "previous"}),
        True,
        "V-A: \u201cthe current estimate\u201d",
    ),
    Decision(
        "located_on",
        "Where must the ray of a hole end?",
        "at its first ellipsoid, which must be of the frontier",
        "at the nearest ellipsoid of the frontier",
        ({"located_on": "first_frontier"}, {"located_on": "nearest_frontier"}),
        True,
        "V-A, after eq. (10): first intersection of all, yet \u201conly points lying on frontier ellipsoids\u201d",
    ),
    Decision(
        "cluster",
        "How near and how many are the points of a cluster?",
        "2 voxels, 5 points",
        "3 voxels, 3 points",
        (
            {"cluster_radius_voxels": 2.0, "cluster_min_samples": 5},
            {"cluster_radius_voxels": 3.0, "cluster_min_samples": 3},
        ),
        True,
        "V-A: DBSCAN without its two numbers",
    ),
    Decision(
        "capacity",
        "What can a recovered region hold at most?",
        "all voxels of the enlarged box",
        "a sheet of voxels across it",
        ({"capacity": "volume"}, {"capacity": "sheet"}),
        True,
        "V-B, eq. (15): the box's voxels, of which a surface can never fill 30 % if it is thick",
    ),
    Decision(
        "silhouette_of",
        "Which ellipsoids make the silhouette?",
        "occupied and frontier",
        "occupied",
        ({"silhouette_of": "all"}, {"silhouette_of": "occupied"}),
        True,
        "V-A: both in the text, though only the occupied ones are known to be object",
    ),
    Decision(
        "miss_probability",
        "How strongly does a ray empty the voxels that it crosses?",
        "occupancy 0.48 a ray",
        "occupancy 0.40 a ray (OctoMap's default)",
        ({"miss_probability": 0.48}, {"miss_probability": 0.4}),
        False,
        "III-A: occupancy without its odds",
    ),
    Decision(
        "frames_into_map",
        "What of a burst enters the map?",
        "its median, once",
        "each of its frames",
        ({"frames_into_map": "median"}, {"frames_into_map": "each"}),
        False,
        "V-A: N_k frames a pose; which of them are integrated is not said",
    ),
    Decision(
        "occupied_probability",
        "From which occupancy on is a voxel occupied?",
        "above 0.5 (one hit)",
        "above 0.7 (two hits)",
        ({"occupied_probability": 0.5}, {"occupied_probability": 0.7}),
        False,
        "III-A: three classes without their limits",
    ),
    Decision(
        "covariance",
        "Which shapes may the mixture's components have?",
        "spheres (PB-NBV's published code)",
        "any ellipsoid",
        ({"covariance": "spherical"}, {"covariance": "full"}),
        False,
        "III-B: GMM without its covariance",
    ),
    Decision(
        "max_components",
        "How many components are tried at most?",
        "20",
        "10",
        ({"max_components": 20}, {"max_components": 10}),
        False,
        "III-B: chosen by BIC, up to where is not said",
    ),
    Decision(
        "weighting",
        "How does an ellipsoid's weight fall with its rank?",
        "0.5^rank (PB-NBV's published code)",
        "1 / (rank + 1)",
        ({"weighting": "geometric"}, {"weighting": "harmonic"}),
        False,
        "III-C, below eq. (2): \u201cprogressively lower weights\u201d",
    ),
    Decision(
        "first_elevation",
        "From how high does the first view look?",
        "45 deg",
        "30 deg",
        ({"first_elevation_deg": 45.0}, {"first_elevation_deg": 30.0}),
        False,
        "VI-A: the first view is not told",
    ),
    Decision(
        "stagnation_against",
        "What is a change of utility relative to?",
        "the largest utility so far",
        "the last one",
        ({"stagnation_against": "largest"}, {"stagnation_against": "last"}),
        False,
        "VI: \u201ca relative utility variation\u201d",
    ),
)
"""All of them; `studies.readings.design` says in which column each stands."""

DECIDED_FIELDS = frozenset(name for decision in DECISIONS for name in decision.values[0])
"""Fields of `Parameters` that the study sets."""


def decided(parameters: Parameters, second: frozenset[str]) -> Parameters:
    """The parameters with all decisions taken: those named at their second level, the others at the first."""
    for decision in DECISIONS:
        parameters = decision.changed(parameters, decision.name in second)
    return parameters


def read_by(planner: str, second: frozenset[str]) -> frozenset[str]:
    """Of the decisions at their second level those that the planner's runs depend on: equal runs are told the same."""
    return frozenset(d.name for d in DECISIONS if d.name in second and (planner == RECOVERS or not d.of_recovery))
