"""A headless Chromium, driven through a pipe by its own protocol: nothing else is needed."""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
import sys
import time
from base64 import b64decode
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

__all__ = ["Browser", "chromium", "opened"]

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
INTO_PLACE = (
    "import os, sys; os.dup2(int(sys.argv[1]), 3); os.dup2(int(sys.argv[2]), 4); "
    "os.execv(sys.argv[3], sys.argv[3:])"
)
"""A browser reads from 3 and writes to 4."""
PATIENCE_S = 30.0
"""Machines that test are slow, and others use them as well."""


def chromium() -> str | None:
    """Where a Chromium is."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


class Browser:
    """One page of a Chromium, and all that it says and asks for."""

    def __init__(self, send: int, receive: int) -> None:
        self._send, self._receive = send, receive
        self._buffer = b""
        self._number = 0
        self._session = ""
        self.complaints: list[str] = []
        self.requests: list[str] = []

    def attach(self) -> None:
        """Opens an empty page and listens to it."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        made = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = made["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self.call(
            "Network.emulateNetworkConditions",
            offline=True,
            latency=0,
            downloadThroughput=0,
            uploadThroughput=0,
        )

    def call(self, method: str, **given: Any) -> dict[str, Any]:
        """A command, and its answer."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": given}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._send, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']['message']}")
                return dict(answer["result"])
            self._heard(answer)

    def run(self, script: str) -> Any:
        """What an expression of the page comes to; a promise is waited for."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        if "exceptionDetails" in answer:
            raise AssertionError(answer["exceptionDetails"])
        return answer["result"].get("value")

    def wait(self, script: str) -> Any:
        """What an expression comes to once it is true."""
        end = time.monotonic() + PATIENCE_S
        while not (found := self.run(script)):
            if time.monotonic() > end:
                raise AssertionError(f"never: {script}; {self.complaints}")
            time.sleep(0.05)
        return found

    def size(self, width: int, height: int, *, phone: bool = False) -> None:
        """The window, of a phone or not."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=2 if phone else 1,
            mobile=phone,
        )
        self.call("Emulation.setTouchEmulationEnabled", enabled=phone)

    def dark(self, on: bool = True) -> None:
        """Whether the reader likes it dark."""
        wanted = {"name": "prefers-color-scheme", "value": "dark" if on else "light"}
        self.call("Emulation.setEmulatedMedia", features=[wanted])

    def open(self, page: Path) -> None:
        """Opens a file, as a double click would, and waits until it stands."""
        self.call("Page.navigate", url=page.resolve().as_uri())
        self.wait("document.readyState === 'complete' && location.protocol === 'file:'")

    def press(self, key: str) -> None:
        """A key."""
        text = {"text": key} if len(key) == 1 else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    def drag(self, element: str, begin: float, end: float) -> None:
        """With the mouse across an element, between two shares of its width."""
        self.run(f"{element}.scrollIntoView({{block: 'center'}})")
        box = self.run(
            f"(() => {{ const b = {element}.getBoundingClientRect();"
            " return [b.left, b.top, b.width, b.height]; })()"
        )
        height = box[1] + 0.5 * box[3]
        places = [box[0] + share * box[2] for share in (begin, 0.5 * (begin + end), end)]

        def mouse(kind: str, x: float, button: str) -> None:
            self.call(
                "Input.dispatchMouseEvent",
                type=kind,
                x=x,
                y=height,
                button=button,
                clickCount=int(kind != "mouseMoved"),
            )

        mouse("mouseMoved", places[0], "none")
        mouse("mousePressed", places[0], "left")
        for place in places[1:]:
            mouse("mouseMoved", place, "left")
        mouse("mouseReleased", places[-1], "left")

    def touch(self, element: str, places: list[tuple[float, ...]]) -> None:
        """With one finger or two on an element, from share to share of its width."""
        left, top, width, height = self.run(
            f"(() => {{ const b = {element}.getBoundingClientRect();"
            " return [b.left, b.top, b.width, b.height]; })()"
        )
        for number, fingers in enumerate(places):
            points = [
                {"x": left + share * width, "y": top + 0.5 * height, "id": k}
                for k, share in enumerate(fingers)
            ]
            kind = "touchMove" if number else "touchStart"
            self.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def picture(self, path: Path, *, whole: bool = False) -> None:
        """What is seen, as a PNG."""
        data = self.call("Page.captureScreenshot", captureBeyondViewport=whole)["data"]
        path.write_bytes(b64decode(data))

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            if not select.select([self._receive], [], [], PATIENCE_S)[0]:
                raise AssertionError(f"the browser is silent; it said {self.complaints}")
            got = os.read(self._receive, 1 << 20)
            if not got:
                raise AssertionError("the browser is gone")
            self._buffer += got
        message, _, self._buffer = self._buffer.partition(b"\0")
        return dict(json.loads(message))

    def _heard(self, event: dict[str, Any]) -> None:
        given = event.get("params", {})
        match event.get("method"):
            case "Runtime.exceptionThrown":
                self.complaints.append(str(given["exceptionDetails"]))
            case "Runtime.consoleAPICalled" if given["type"] in ("error", "warning", "assert"):
                self.complaints.append(str(given["args"]))
            case "Log.entryAdded" if given["entry"]["level"] in ("error", "warning"):
                self.complaints.append(given["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(given["request"]["url"])
            case _:
                pass


@contextmanager
def opened(program: str, folder: Path) -> Iterator[Browser]:
    """A browser of its own, without a network, that ends with the block."""
    import fcntl  # There is none on Windows.

    ours, theirs = os.pipe(), os.pipe()  # to the browser, and from it
    # Out of the way of the places that the browser wants them in.
    ends = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in (ours[0], theirs[1])]
    os.close(ours[0])
    os.close(theirs[1])
    arguments = [
        *("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run"),
        *("--disable-background-networking", "--disable-dev-shm-usage", "--remote-debugging-pipe"),
        f"--user-data-dir={folder}",
    ]
    process = subprocess.Popen(
        [sys.executable, "-c", INTO_PLACE, *map(str, ends), program, *arguments],
        pass_fds=ends,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    for end in ends:
        os.close(end)
    browser = Browser(ours[1], theirs[0])
    try:
        browser.attach()
        yield browser
    finally:
        process.kill()
        process.wait()
        os.close(ours[1])
        os.close(theirs[0])
