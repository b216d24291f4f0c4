"""Coverage of fra-robust, FRA and PB at equal acquisitions: tables of docs/fra_robust.md and robust.png.

`python -m docs.figures.robust FOLDER`: a finished `franbv study comparison --preset robust`.
"""

import sys
from pathlib import Path

from docs.figures.drawing import panels, write
from studies.comparison.cases import planned_runs
from studies.comparison.command import stored_preset
from studies.comparison.equal_acquisitions import lead_after, mean_after, needed
from studies.comparison.method_names import method_name
from studies.comparison.paper import FINAL_COVERAGE
from studies.comparison.records import read_records
from studies.comparison.statistics import Comparison

OURS, LEVELS, MOST = "fra-robust", (5, 10, 15, 20, 30), 30
COLOURS = {"fra": "#d07a1f", "pb": "#7a7a72", OURS: "#1f5fa8"}
FINAL = {"wrongly_free_share": 100.0, "filtered_f_score": 1.0, "filtered_accuracy_mm": 1.0, "accuracy_mm": 1.0}
"""Figures of the final map and cloud, and what they are multiplied with for the table."""


def main(out: Path) -> None:
    """Print both tables and draw the picture."""
    preset = stored_preset(out)
    comparison = Comparison(read_records(out, planned_runs(preset)))
    print("| object, planner | starts |" + "".join(f" {n} |" for n in LEVELS) + " until the paper's FRA |")
    for part in preset.parts:
        for planner in preset.planners:
            means = [mean_after(comparison, part, planner, n) for n in LEVELS]
            cells = "".join(f" {100 * mean.mean:.1f} |" for mean in means if mean)
            reached = needed(comparison, part, planner, FINAL_COVERAGE[part]["fra"].median)
            words = "never" if reached is None or reached.median is None else f"{reached.median:.0f}"
            print(f"| {part}, {planner} | {len(comparison.runs(part, planner))} |{cells} {words} |")
        for other in (planner for planner in preset.planners if planner != OURS):
            leads = [lead_after(comparison, part, OURS, other, n) for n in LEVELS]
            ends = [lead.interval for lead in leads if lead]
            cells = "".join(f" {100 * e.mean:+.1f} ({100 * e.low:.1f} to {100 * e.high:.1f}) |" for e in ends)
            print(f"| {part}, more than {other} | |{cells} |")
    print("| object, planner |" + "".join(f" {name} |" for name in FINAL))
    for part in preset.parts:
        for planner in preset.planners:
            figures = {name: comparison.figure(part, planner, name) for name in FINAL}
            cells = "".join(f" {scale * f.mean:.2f} |" for name, scale in FINAL.items() if (f := figures[name]))
            print(f"| {part}, {planner} |{cells}")
    draw(comparison, preset.parts, preset.planners)


def draw(comparison: Comparison, parts: tuple[str, ...], planners: tuple[str, ...]) -> None:
    """Means with 95 % bands against acquisitions, a panel per object."""
    figure, axes = panels(len(parts), height=2.3)
    for panel, part in zip(axes, parts, strict=True):
        for planner in planners:
            curve = [mean for n in range(1, MOST + 1) if (mean := mean_after(comparison, part, planner, n))]
            x = range(1, len(curve) + 1)
            panel.fill_between(
                x, [100 * c.low for c in curve], [100 * c.high for c in curve], color=COLOURS[planner], alpha=0.2, lw=0
            )
            panel.plot(x, [100 * c.mean for c in curve], color=COLOURS[planner], label=method_name(planner))
        panel.axhline(100 * FINAL_COVERAGE[part]["fra"].median, color="black", lw=0.6, ls=":")
        panel.set(title=part, xlabel="acquisitions", ylim=(0, 101), xlim=(1, MOST))
    axes[0].set_ylabel("map covers [%]")
    axes[0].legend(loc="lower right")
    write(figure, "robust")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
