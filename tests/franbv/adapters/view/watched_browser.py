"""Headless Chromium that stays open: a page that never comes to rest is watched, asked and pictured as it runs.

It is spoken to by the DevTools protocol over two pipes, so that no port is opened and no package is needed.
"""

import base64
import itertools
import json
import os
import select
import subprocess
import time
from pathlib import Path
from typing import Any

FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--remote-debugging-pipe",
    "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
)  # fmt: skip
"""WebGL is computed: a test computer has no graphics card."""
NO_OTHER_HOST = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
"""Nothing leaves this computer, whatever the page asks for."""
FREELY = ("Access-Control-Allow-Origin", "Access-Control-Allow-Headers")
NOTHING = {"responseCode": 204, "responseHeaders": [{"name": name, "value": "*"} for name in FREELY]}
"""What the page is told that asks another host: a refusal would be an error on its console."""
PATIENCE_S = 120.0
"""How long an answer may take [s]: the page computes its pictures on the processor."""


class WatchedBrowser:
    """A page that is being looked at. A context manager; leaving it ends the browser."""

    def __init__(self, chromium: str, profile: Path, size: tuple[int, int] = (1500, 950)) -> None:
        """profile: a folder that is made."""
        to_browser, self._write = os.pipe()
        self._read, from_browser = os.pipe()
        flags = [*FLAGS, NO_OTHER_HOST, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={profile}"]
        # The browser listens at its descriptor 3 and answers at 4.
        script = f'exec "$@" 3<&{to_browser} 4>&{from_browser}'
        self._process = subprocess.Popen(
            ["bash", "-c", script, "bash", chromium, *flags, "about:blank"],
            pass_fds=(to_browser, from_browser),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._numbers, self._rest = itertools.count(1), b""
        self.console: list[str] = []
        """`level: text` of every message so far."""
        self.requests: list[str] = []
        """URLs that the page asked for."""
        self._session: str | None = None
        page = next(t for t in self._ask("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self._session = self._ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._ask(f"{domain}.enable")
        self._ask("Fetch.enable", patterns=[{"urlPattern": "https://*"}])

    def open(self, url: str) -> None:
        """Go to a page."""
        self._ask("Page.navigate", url=url)

    def watch(self, seconds: float) -> None:
        """Let it run, and listen."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self._heard(left)

    def screenshot(self) -> bytes:
        """The page as PNG."""
        return base64.b64decode(self._ask("Page.captureScreenshot", format="png")["data"])

    def __enter__(self) -> "WatchedBrowser":
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        self._process.wait()
        os.close(self._write)
        os.close(self._read)

    def _ask(self, method: str, **params: Any) -> dict[str, Any]:
        number = self._send(method, params)
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            for message in self._heard(1.0):
                if message.get("id") == number:
                    assert "error" not in message, message
                    return message["result"]
        raise TimeoutError(method)

    def _send(self, method: str, params: dict[str, Any]) -> int:
        number = next(self._numbers)
        session = {} if self._session is None else {"sessionId": self._session}
        message = {"id": number, "method": method, "params": params, **session}
        os.write(self._write, json.dumps(message).encode() + b"\0")
        return number

    def _heard(self, seconds: float) -> list[dict[str, Any]]:
        """Messages that arrive within this time, events noted down."""
        if not select.select([self._read], [], [], seconds)[0]:
            return []
        self._rest += os.read(self._read, 1 << 20)
        *whole, self._rest = self._rest.split(b"\0")
        messages = [json.loads(text) for text in whole]
        for message in messages:
            self._note(message.get("method"), message.get("params", {}))
        return messages

    def _note(self, method: str | None, params: dict[str, Any]) -> None:
        if method == "Runtime.consoleAPICalled":
            words = " ".join(str(arg.get("value", arg.get("description"))) for arg in params["args"])
            self.console.append(f"{params['type']}: {words}")
        elif method == "Runtime.exceptionThrown":
            self.console.append(f"error: {params['exceptionDetails'].get('exception', {}).get('description')}")
        elif method == "Log.entryAdded":
            entry = params["entry"]
            self.console.append(f"{entry['level']}: {entry['text']} {entry.get('url', '')}")
        elif method == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])
        elif method == "Fetch.requestPaused":
            self._send("Fetch.fulfillRequest", {"requestId": params["requestId"], **NOTHING})
