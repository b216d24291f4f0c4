"""The README's picture and figures: those of the run that `make demo` makes, on the paper's bench.

python -m docs.figures.demo     # makes the run if it is not there; needs Chromium
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from docs.figures.drawing import FOLDER
from studies.cli.main import main as franbv

OUT = Path("runs/demo")
COMMAND = ["reconstruct", "--part", "D", "--bench", "paper", "--planner", "fra", "--seed", "0", "--out", str(OUT)]
"""What `make demo` runs."""
README = FOLDER.parent.parent / "README.md"
BEGIN, END = "<!-- of `python -m docs.figures.demo` -->\n", "<!-- end -->\n"
"""Around what is written into it."""
SIZE, SCALE = (1280, 2187), 0.75
"""Of the window [px], at which the page is as wide as it gets, and pixels of the picture per pixel of it."""
LEFT_OUT = "<style>nav, #space, #space + p, #scene { display: none }</style></head>"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars")  # fmt: skip


def figures(summary: dict) -> str:
    """The run in a sentence, from its summary."""
    return (
        f"It took {summary['acquisitions']} acquisitions, {summary['recovery_acquisitions']} of them to recover "
        f"{summary['recovery_activations']} reflective regions. In the end the map held\n"
        f"{100 * summary['coverage_map_5mm']:.1f} % of the visible surface to within 5 mm; recovery views brought "
        f"{100 * summary['recovery_contribution']:+.1f} points of it.\n"
    )


def with_figures(text: str, sentence: str) -> str:
    """The README's text with this sentence between its marks."""
    before, found, rest = text.partition(BEGIN)
    _, ended, after = rest.partition(END)
    if not (found and ended):
        raise ValueError(f"the README lacks {BEGIN.strip()} or {END.strip()}")
    return before + BEGIN + sentence + END + after


def main() -> int:
    """Draw it."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        print(f"needs one of {', '.join(BROWSERS)}", file=sys.stderr)
        return 2
    status = franbv(COMMAND)
    if status:
        return status
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        page.write_text((OUT / "report.html").read_text().replace("</head>", LEFT_OUT, 1))
        shown = Path(folder) / "shown.png"
        window = (f"--window-size={SIZE[0]},{SIZE[1]}", f"--force-device-scale-factor={SCALE}")
        files = (f"--user-data-dir={folder}/profile", f"--screenshot={shown}")
        command = [browser, *FLAGS, *window, *files, page.as_uri()]
        subprocess.run(command, check=True, capture_output=True, timeout=120)
        shutil.copyfile(shown, FOLDER / "demo.png")
    README.write_text(with_figures(README.read_text(), figures(json.loads((OUT / "run.json").read_text())["summary"])))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
