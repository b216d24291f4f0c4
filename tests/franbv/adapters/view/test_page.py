"""The page in a browser: it comes up, takes the run and draws it, and is silent about all but what it is known for."""

import time
from pathlib import Path
from urllib.parse import urlsplit

import cv2
import numpy as np
import pytest

from franbv.adapters.view.opening import live_page
from tests.franbv.adapters.recording.recorded_run import PARAMETERS, infrared
from tests.franbv.adapters.view.conftest import run_before
from tests.studies.browser import CHROMIUM

pytest.importorskip("rerun")
from franbv.adapters.view.run_view import Colour
from tests.franbv.adapters.view.watched_browser import WatchedBrowser

OTHER_HOSTS = {"fonts.googleapis.com", "fonts.gstatic.com", "api.github.com", "app.rerun.io", "tel.rerun.io"}
"""Of the viewer's own page: a font, its newest version, its examples, counts of its use. docs say so."""
UNSEEN_WITHOUT_A_RUN = 100
"""Pixels in the colour of the frontier's edges (choice: some edges; the page itself has none)."""
PATIENCE_S = 400.0
"""Until the run is drawn [s]: the page's shaders are compiled and run on the processor."""


def amber_pixels(png: bytes) -> int:
    """How much of a picture has the colour of the frontier."""
    picture = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1].astype(int)
    return int(np.count_nonzero(np.abs(picture - Colour.FRONTIER).max(axis=2) < 25))


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_the_page_draws_the_run_without_an_error(tmp_path: Path):
    """No error on the console, the frontier in its colour, and data from this computer alone."""
    urls: list[str] = []
    with live_page("Box", PARAMETERS.invalid_share, urls.append) as view:
        run_before(lambda a: view.observe(a, coverage=a.index / 100, infrared=infrared(a.index)))
        with WatchedBrowser(str(CHROMIUM), tmp_path / "profile") as browser:
            browser.open(urls[0])
            end, picture = time.monotonic() + PATIENCE_S, b""
            while time.monotonic() < end:
                browser.watch(5.0)
                picture = browser.screenshot()
                if amber_pixels(picture) > UNSEEN_WITHOUT_A_RUN:
                    break
            (tmp_path / "page.png").write_bytes(picture)
            errors = [words for words in browser.console if words.startswith("error")]
            hosts = {urlsplit(url).hostname for url in browser.requests if url.startswith("http")}
    assert amber_pixels(picture) > UNSEEN_WITHOUT_A_RUN
    assert errors == []
    assert hosts <= {"127.0.0.1"} | OTHER_HOSTS
