"""Headless Chromium: opens a page and tells what it asked the network for and what it said on its console."""

import json
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
"""The browser's path, None where there is none."""

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--enable-logging=stderr",
    "--virtual-time-budget=4000",
)
BROWSER_ITSELF = "not an origin"
"""Initiator of the requests that Chromium makes on its own account (updates, time)."""


@dataclass(frozen=True)
class Visit:
    """What happened on a page."""

    dom: str
    """The page after its scripts ran."""
    console: list[str]
    """Every message on the console, errors and warnings included."""
    requests: list[str]
    """URLs that the page asked the network for."""


def visit(page: Path, folder: Path, screenshot: Path | None = None, size: tuple[int, int] = (1280, 2400)) -> Visit:
    """Open a local page with a fresh profile in `folder`."""
    log = folder / "net.json"
    output = [f"--screenshot={screenshot}"] if screenshot else ["--dump-dom"]
    done = subprocess.run(
        [str(CHROMIUM), *FLAGS, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={folder / 'profile'}",
         f"--log-net-log={log}", *output, page.resolve().as_uri()],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    console = re.findall(r"CONSOLE[^\]]*\] (.*)", done.stderr)
    events = [event["params"] for event in json.loads(log.read_text())["events"] if "params" in event]
    requests = [e["url"] for e in events if "initiator" in e and e["initiator"] != BROWSER_ITSELF]
    return Visit(done.stdout, console, [url for url in requests if not url.startswith("file:")])
