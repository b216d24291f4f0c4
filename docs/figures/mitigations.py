"""The picture of docs/advise.md: which remedy wins on which metal and finish.

python -m docs.figures.mitigations FOLDER     # of `franbv study mitigations --preset metals`; needs Chromium
"""

import argparse
from pathlib import Path

from docs.figures.page_picture import write_page_picture
from studies.run.stored_run import REPORT

SIZE, SCALE = (1280, 1180), 0.7
"""Of the window [px], which shows answer and map, and its scale in the picture."""


def main(folder: Path) -> None:
    """Draw it."""
    write_page_picture(folder / REPORT, "mitigations", SIZE, SCALE, "nav")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.mitigations")
    parser.add_argument("folder", type=Path)
    main(parser.parse_args().folder)
