"""A real browser for tests of pages: headless Chromium through chromedriver, spoken to in W3C WebDriver over HTTP.

Nothing but the standard library: a session, a page, scripts in it, its console, its size, a picture.
"""

from __future__ import annotations

import base64
import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

CHROMIUM = next((p for n in ("chromium", "chromium-browser", "google-chrome") if (p := shutil.which(n))), None)
DRIVER = shutil.which("chromedriver")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-dev-shm-usage",
         "--disable-background-networking", "--disable-component-update", "--disable-sync"]  # fmt: skip
WHY_NOT = "no browser: install chromium and chromium-driver to run this test"


class Browser:
    """A session with an empty profile in `folder`; use as a context."""

    def __init__(self, folder: Path, *flags: str) -> None:
        assert CHROMIUM and DRIVER, WHY_NOT
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            port = s.getsockname()[1]
        self._log = open(folder / "driver.log", "wb")  # noqa: SIM115
        self._process = subprocess.Popen([DRIVER, f"--port={port}"], stdout=self._log, stderr=subprocess.STDOUT)
        self._at = f"http://127.0.0.1:{port}"
        options = {"binary": CHROMIUM, "args": [*FLAGS, f"--user-data-dir={folder / 'profile'}", *flags]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        try:
            self._wait(30.0)
            self._at += (
                "/session/" + self._ask("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
            )
        except BaseException:
            self._stop()
            raise

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *reason: Any) -> None:
        try:
            self._ask("DELETE", "")
        finally:
            self._stop()

    def _stop(self) -> None:
        self._process.terminate()
        self._process.wait(20.0)
        self._log.close()

    def _wait(self, patience: float) -> None:
        end = time.monotonic() + patience
        while True:
            try:
                if self._ask("GET", "/status")["ready"]:
                    return
            except urllib.error.URLError:
                if time.monotonic() > end or self._process.poll() is not None:
                    raise
            time.sleep(0.05)

    def _ask(self, method: str, path: str, data: dict[str, Any] | None = None) -> Any:
        text = None if method != "POST" else json.dumps(data or {}).encode()
        request = urllib.request.Request(self._at + path, text, {"Content-Type": "application/json"}, method=method)
        direct = urllib.request.build_opener(
            urllib.request.ProxyHandler({})
        )  # never through a proxy: it is this machine
        try:
            with direct.open(request, timeout=120.0) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].splitlines()[0]) from None

    def open(self, page: Path) -> None:
        """Load a file."""
        self._ask("POST", "/url", {"url": page.resolve().as_uri()})

    def run(self, script: str, *arguments: Any) -> Any:
        """What a script in the page returns."""
        return self._ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def tell(self, command: str, **parameters: Any) -> Any:
        """A command of Chromium's DevTools protocol."""
        return self._ask("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def size(self, width: int, height: int, mobile: bool = False) -> None:
        """Size of the page's window in CSS pixels, as of a telephone if asked."""
        self.tell("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def console(self) -> list[str]:
        """Messages of the console since the last call: errors, warnings and what scripts log."""
        return [f"{m['level']}: {m['message']}" for m in self._ask("POST", "/se/log", {"type": "browser"})]

    def picture(self, path: Path, whole: bool = False) -> None:
        """A PNG of the window, or of the whole page."""
        shot = self.tell(
            "Page.captureScreenshot", captureBeyondViewport=whole, **({"clip": self._all()} if whole else {})
        )
        path.write_bytes(base64.b64decode(shot["data"]))

    def _all(self) -> dict[str, float]:
        box = self.tell("Page.getLayoutMetrics")["cssContentSize"]
        return {"x": 0, "y": 0, "width": box["width"], "height": box["height"], "scale": 1}
