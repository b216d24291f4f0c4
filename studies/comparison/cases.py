"""The runs of a comparison: every arm of it on every part, all arms from the same starts with the same noise."""

from collections.abc import Iterator

from studies.comparison.links import LINKED_PLANNERS, LINKS, LinkChange, arm_name
from studies.comparison.preset import ComparisonPreset
from studies.run.ablation import ABLATIONS, Ablation
from studies.run.batch import PlannedRun
from studies.run.reconstruct import ReconstructSettings, resolved_run
from studies.run.starts.runs import seed_at


def planned_runs(preset: ComparisonPreset) -> list[PlannedRun]:
    """All runs; all arms of the first start before the second start, so that a stopped study is a smaller one.

    Of a start, one arm after the other goes over the parts: neighbours in the list, which are made at the same time,
    have no burst in common, while later arms find those of earlier ones.
    """
    arms = [
        *preset.planners,
        *preset.ablations,
        *(arm_name(planner, link) for link in preset.links for planner in LINKED_PLANNERS),
    ]
    planned = [*_of_planners(preset), *_of_ablations(preset), *_of_links(preset)]
    return sorted(planned, key=lambda planned: (planned.run, arms.index(planned.arm)))


def _of_planners(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    starts = {
        **dict.fromkeys(preset.whole_parts, preset.start_numbers),
        **dict.fromkeys(preset.other_ablated_parts, preset.changed_start_numbers),
    }
    for part, numbers in starts.items():
        for planner in preset.planners:
            for run in numbers:
                yield PlannedRun(part, planner, run, run_settings(preset, part, planner, run, Ablation()))


def _of_ablations(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    for part in preset.ablated_parts:
        for name in preset.ablations:
            for run in preset.changed_start_numbers:
                _, planner, change = ABLATIONS[name]
                yield PlannedRun(part, name, run, run_settings(preset, part, planner, run, change))


def _of_links(preset: ComparisonPreset) -> Iterator[PlannedRun]:
    for part in preset.ablated_parts:
        for link in preset.links:
            for planner in LINKED_PLANNERS:
                for run in preset.changed_start_numbers:
                    plain, config = (
                        run_settings(preset, part, planner, run, Ablation(), change) for change in (None, LINKS[link])
                    )
                    if config != plain:  # the study may stand at what the link changes to
                        yield PlannedRun(part, arm_name(planner, link), run, config)


def run_settings(
    preset: ComparisonPreset, part: str, planner: str, run: int, ablation: Ablation, link: LinkChange | None = None
) -> ReconstructSettings:
    """What `franbv reconstruct` would be told for this run.

    The start and the seed depend on the azimuth alone, so that a comparison with more runs takes over those of one with
    fewer of the same starts.
    """
    azimuth = 360.0 * run / preset.starts
    settings = ReconstructSettings(
        part=part,
        material=preset.material_of(part),
        bench=preset.bench,
        lamps=preset.lamps,
        sensor=preset.sensor,
        planner=planner,
        azimuth_deg=azimuth,
        seed=seed_at(preset.seed, azimuth),
        parameters=preset.parameters,
        ablation=ablation,
    )
    return resolved_run(link.changed(settings) if link else settings)
