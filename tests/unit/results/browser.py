"""A headless Chromium for tests of pages, driven over its debugging pipe: no package needed."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import time

FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-dev-shm-usage", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", "--force-device-scale-factor=1", "--force-color-profile=srgb",
    "--remote-debugging-pipe",
)  # fmt: skip
PROGRAMS = ("chromium", "chromium-browser", "google-chrome", "chrome")
PATIENCE = 120.0


def find_browser():
    """Path of a browser, None where there is none."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


class Browser:
    """One tab of 1280 x 720; use it in a ``with`` statement.

    Attributes
    ----------
    events
        Everything the browser told since the last page was opened.
    """

    def __init__(self, program, folder, width=1280, height=720):
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        flags = " ".join((*FLAGS, f"--window-size={width},{height}", f"--user-data-dir={folder}"))
        # The browser speaks on descriptors 3 and 4.
        command = f"exec {program} {flags} about:blank 3<&{to_browser} 4>&{from_browser}"
        self._process = subprocess.Popen(
            ["bash", "-c", command], pass_fds=(to_browser, from_browser),
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(to_browser)
        os.close(from_browser)
        self._buffer, self._number, self._session, self.events = b"", 0, None, []
        pages = self.call("Target.getTargets")["targetInfos"]
        page = next(target for target in pages if target["type"] == "page")
        attached = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._session = None
        try:
            self.call("Browser.close")
        finally:
            self._process.wait(30)
            os.close(self._out)
            os.close(self._in)

    def call(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data) :]
        while True:
            answer = self._receive()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]
            self.events.append(answer)

    def evaluate(self, expression):
        """Value of a JavaScript expression, awaited."""
        answer = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def open(self, url):
        """Open a page and wait until it says that it is ready."""
        self.call("Page.navigate", url="about:blank")
        self.events.clear()
        self.call("Page.navigate", url=url)
        limit = time.monotonic() + PATIENCE
        while self.evaluate("document.documentElement?.dataset?.ready") != "yes":
            assert time.monotonic() < limit, self.problems()
            time.sleep(0.02)

    def wait(self, condition):
        """Wait until a JavaScript condition holds."""
        limit = time.monotonic() + PATIENCE
        while not self.evaluate(f"Boolean({condition})"):
            assert time.monotonic() < limit, condition
            time.sleep(0.02)

    def press(self, key):
        for kind in ("rawKeyDown", "keyUp"):
            text = {"text": key} if len(key) == 1 and kind == "rawKeyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, **text)

    def drag(self, begin, end):
        """Press the mouse at one place, move it to another and let go."""
        for kind, (x, y), buttons in (
            ("mousePressed", begin, 1), ("mouseMoved", end, 1), ("mouseReleased", end, 0),
        ):  # fmt: skip
            self.call(
                "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons,
                clickCount=1,
            )  # fmt: skip

    def screenshot(self, **clip):
        """Bytes of a PNG of the whole page or of x, y, width, height."""
        self.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
        wish = {"clip": {**clip, "scale": 1}} if clip else {}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **wish)["data"])

    def problems(self):
        """Errors and warnings of the console, but that a screenshot reads pixels."""
        kinds = {"Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled"}
        told = [event for event in self.events if event.get("method") in kinds]
        return [event for event in told if "due to ReadPixels" not in json.dumps(event)]

    def requests(self):
        """Addresses of what the page asked for, itself left out."""
        asked = [e["params"] for e in self.events if e.get("method") == "Network.requestWillBeSent"]
        found = [item["request"]["url"] for item in asked if item.get("type") != "Document"]
        return [url for url in found if not url.startswith(("data:", "blob:"))]

    def _receive(self):
        limit = time.monotonic() + PATIENCE
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._in], [], [], max(0.0, limit - time.monotonic()))
            assert ready, "the browser does not answer"
            data = os.read(self._in, 1 << 20)
            assert data, "the browser has ended"
            self._buffer += data
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)
