"""Headless Chromium by its own protocol, over a pipe: clicks, keys, sizes, requests, axe."""

from __future__ import annotations

import fcntl
import json
import os
import select
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from typing import Any

CHROMIUM = (
    *("chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"),
    *("--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND"),
    "--remote-debugging-pipe",  # the protocol on file descriptors 3 and 4
)
_PATIENCE = 60.0  # seconds, for an answer that never comes
_AXE = """
axe.run().then((found) => found.violations.map((fault) =>
  `${fault.id}: ${fault.help}: ${fault.nodes.map((n) => n.html).join(" ")}`))
"""


class Page:
    """One tab, and all that it reports: messages, requests, exceptions."""

    def __init__(self, send: int, receive: int) -> None:
        self._send, self._receive = send, receive
        self._buffer = b""
        self._count = 0
        self._session: dict[str, str] = {}
        self.events: list[dict[str, Any]] = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters, **self._session}
        os.write(self._send, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return answer["result"]
            self.events.append(answer)

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._receive], [], [], _PATIENCE)
            piece = os.read(self._receive, 1 << 16) if ready else b""
            assert piece, "Chromium does not answer"
            self._buffer += piece
        text, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(text)

    def open(self, path: Path, width: int, **features: str) -> None:
        """Load a file at a width in pixels; features such as prefers_color_scheme="dark"."""
        self.resize(width)
        media = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.call("Emulation.setEmulatedMedia", features=media)
        self.events.clear()
        self.call("Page.navigate", url=path.as_uri())
        while not self.sent("Page.loadEventFired"):
            self.events.append(self._next())
        self.call("Page.bringToFront")

    def resize(self, width: int) -> None:
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
        self.call("Emulation.setDeviceMetricsOverride", **size)

    def run(self, script: str) -> Any:
        """The value of an expression in the page; a promise is waited for."""
        options = {"awaitPromise": True, "returnByValue": True, "userGesture": False}
        done = self.call("Runtime.evaluate", expression=script, **options)
        assert "exceptionDetails" not in done, done["exceptionDetails"]
        return done["result"].get("value")

    def faults(self) -> list[str]:
        """What axe finds; a package for Playwright carries its script."""
        axe = files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8")
        self.run(f"{axe}; undefined")
        return self.run(_AXE)

    def press(self, key: str, code: int) -> None:
        for kind in ("rawKeyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code)

    def click(self, selector: str) -> None:
        """A click of the mouse in the middle of what the selector finds."""
        x, y = self.run(
            f"(() => {{ const e = document.querySelector({json.dumps(selector)});"
            "e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect();"
            "return [b.x + b.width / 2, b.y + b.height / 2]; })()"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def wait_for(self, script: str) -> None:
        """Until an expression is true in the page."""
        for _ in range(200):
            if self.run(script):
                return
            time.sleep(0.05)
        raise AssertionError(f"never true: {script}")

    def sent(self, *kinds: str) -> list[dict[str, Any]]:
        """What the page reported of some kinds."""
        return [e["params"] for e in self.events if e.get("method") in kinds]

    @property
    def requests(self) -> list[str]:
        """What the page asked for beside itself."""
        return [one["request"]["url"] for one in self.sent("Network.requestWillBeSent")][1:]

    @property
    def complaints(self) -> list[str]:
        """The messages in the console."""
        kinds = ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded")
        return list(map(str, self.sent(*kinds)))


@contextmanager
def chromium(folder: Path) -> Iterator[Page]:
    """A tab of a Chromium of its own, which ends with the block."""
    pipes = [*os.pipe(), *os.pipe()]
    # clear of 3 and 4, which the shell sets
    read_there, write, read, write_there = (fcntl.fcntl(n, fcntl.F_DUPFD, 10) for n in pipes)
    for number in pipes:
        os.close(number)
    shell = f'exec "$@" 3<&{read_there} 4>&{write_there}'
    run = subprocess.Popen(
        ["bash", "-c", shell, "bash", *CHROMIUM, f"--user-data-dir={folder / 'profile'}"],
        pass_fds=(read_there, write_there),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(read_there)
    os.close(write_there)
    try:
        yield Page(write, read)
    finally:
        os.close(write)
        os.close(read)
        run.terminate()
        run.wait(30)
