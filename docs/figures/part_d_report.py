"""The README's picture: the top of the report that `make demo` writes, without links and the 3-D part.

make demo && python -m docs.figures.part_d_report     # needs Chromium
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from docs.figures.drawing import FOLDER

REPORT = Path("runs/demo/report.html")
SIZE, SCALE = (1280, 2187), 0.75
"""Of the window [px], at which the page is as wide as it gets, and pixels of the picture per pixel of it."""
LEFT_OUT = "<style>nav, #space, #space + p, #scene { display: none }</style></head>"
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--hide-scrollbars")  # fmt: skip


def main() -> int:
    """Draw it."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None or not REPORT.exists():
        print(f"needs {REPORT}, which `make demo` writes, and one of {', '.join(BROWSERS)}", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.html"
        page.write_text(REPORT.read_text().replace("</head>", LEFT_OUT, 1))
        shown = Path(folder) / "shown.png"
        window = (f"--window-size={SIZE[0]},{SIZE[1]}", f"--force-device-scale-factor={SCALE}")
        files = (f"--user-data-dir={folder}/profile", f"--screenshot={shown}")
        command = [browser, *FLAGS, *window, *files, page.as_uri()]
        subprocess.run(command, check=True, capture_output=True, timeout=120)
        shutil.copyfile(shown, FOLDER / "part_d_report.png")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
