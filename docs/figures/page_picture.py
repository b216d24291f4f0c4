"""Pictures of pages, and sentences with a run's own figures, for the README."""

import shutil
import subprocess
import tempfile
from pathlib import Path

from docs.figures.drawing import FOLDER
from materials.input_error import InputError

README = FOLDER.parent.parent / "README.md"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars")  # fmt: skip


def browser() -> str:
    """The program; InputError where there is none."""
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        raise InputError(f"needs one of {', '.join(BROWSERS)} to draw a page; install it")
    return found


def write_page_picture(page: Path, name: str, size: tuple[int, int], scale: float, left_out: str) -> None:
    """Write `name`.png beside the scripts: the top of a page in a window of `size` [px].

    scale: pixels of the picture per pixel of the window. left_out: CSS selectors of what is not shown.
    """
    hidden = f"<style>{left_out} {{ display: none !important }}</style></head>"
    with tempfile.TemporaryDirectory() as folder:
        copy, shown = Path(folder) / "page.html", Path(folder) / "shown.png"
        copy.write_text(page.read_text().replace("</head>", hidden, 1))
        window = (f"--window-size={size[0]},{size[1]}", f"--force-device-scale-factor={scale}")
        files = (f"--user-data-dir={folder}/profile", f"--screenshot={shown}")
        command = [browser(), *FLAGS, *window, *files, copy.as_uri()]
        subprocess.run(command, check=True, capture_output=True, timeout=120)
        shutil.copyfile(shown, FOLDER / f"{name}.png")


def write_figures(sentence: str, script: str) -> None:
    """Put a sentence into the README, between the marks of a script."""
    README.write_text(with_figures(README.read_text(), sentence, script))


def with_figures(text: str, sentence: str, script: str) -> str:
    """A text with this sentence between the marks of a script."""
    begin, end = f"<!-- of `python -m {script}` -->\n", "<!-- end -->\n"
    before, found, rest = text.partition(begin)
    _, ended, after = rest.partition(end)
    if not (found and ended):
        raise ValueError(f"the README lacks {begin.strip()} or {end.strip()}")
    return before + begin + sentence + end + after
