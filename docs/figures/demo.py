"""The README's picture and figures: those of the run that `make demo` makes, on the paper's bench.

python -m docs.figures.demo     # makes the run if it is not there; needs Chromium
"""

import json
from pathlib import Path

from docs.figures.page_picture import browser, write_figures, write_page_picture
from studies.cli.main import main as franbv

OUT = Path("runs/demo")
COMMAND = ["reconstruct", "--part", "D", "--bench", "paper", "--planner", "fra", "--seed", "0", "--out", str(OUT)]
"""What `make demo` runs."""
SIZE, SCALE = (1280, 2187), 0.75
"""Of the window [px], at which the page is as wide as it gets, and pixels of the picture per pixel of it."""
LEFT_OUT = "nav, #space, #space + p, #scene"


def figures(summary: dict) -> str:
    """The run in a sentence, from its summary."""
    return (
        f"It took {summary['acquisitions']} acquisitions, {summary['recovery_acquisitions']} of them to recover "
        f"{summary['recovery_activations']} reflective regions. In the end the map held\n"
        f"{100 * summary['coverage_map_5mm']:.1f} % of the visible surface to within 5 mm; recovery views brought "
        f"{100 * summary['recovery_contribution']:+.1f} points of it.\n"
    )


def main() -> int:
    """Draw it."""
    browser()  # before the run is made
    status = franbv(COMMAND)
    if status:
        return status
    write_page_picture(OUT / "report.html", "demo", SIZE, SCALE, LEFT_OUT)
    write_figures(figures(json.loads((OUT / "run.json").read_text())["summary"]), "docs.figures.demo")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
