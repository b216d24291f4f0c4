"""The README's picture and sentence of an advice: those of a finished folder.

python -m docs.figures.advice FOLDER     # of `franbv advise`; needs Chromium
"""

import argparse
from pathlib import Path

from docs.figures.page_picture import write_figures, write_page_picture
from studies.advise.command import rebuild
from studies.advise.stored_advice import read_stored_advice

SIZE, SCALE = (1280, 1130), 0.7
"""Of the window [px], which shows the answer and the first thirty remedies, and its scale in the picture."""


def main(folder: Path) -> None:
    """Draw it."""
    stored = read_stored_advice(folder)
    write_page_picture(rebuild(folder), "advice", SIZE, SCALE, "#none")
    write_figures(f"{stored.title}: {stored.headline}\n", "docs.figures.advice")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.advice")
    parser.add_argument("folder", type=Path)
    main(parser.parse_args().folder)
