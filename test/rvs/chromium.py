"""A headless Chromium, driven by its DevTools protocol over the websockets that viser brings."""

import base64
import contextlib
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from websockets.sync.client import connect

# Generous: a loaded machine draws in software.
PATIENCE = 120.0
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless=new",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--no-first-run",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    # Whatever is not on this machine cannot be found.
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost, EXCLUDE 127.0.0.1",
)


# What the protocol says of a page that is left, as the one with the token is at once.
_NAVIGATED = (
    "Inspected target navigated or closed",
    "Execution context was destroyed.",
    "Cannot find context with specified id",
)


def chromium():
    """The browser of this machine, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class NavigatedError(Exception):
    """The page that was asked went to another address meanwhile, and gives no answer."""


class Tab:
    """One page in a browser of its own."""

    def __init__(self, address, width=1280, height=760):
        self._folder = tempfile.mkdtemp(prefix="robomech-chromium-")
        root = ["--no-sandbox"] if os.geteuid() == 0 else []
        command = [chromium(), *FLAGS, *root, f"--user-data-dir={self._folder}"]
        command += [f"--window-size={width},{height}", "about:blank"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self._process = subprocess.Popen(command, start_new_session=True, **quiet)
        self._number = 0
        self.errors = []
        try:
            self._socket = connect(self._debugger(), max_size=None)
            for domain in ("Page", "Runtime", "Log"):
                self.send(f"{domain}.enable")
            size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
            self.send("Emulation.setDeviceMetricsOverride", **size)
            self.open(address)
        except BaseException:
            self.close()
            raise

    def _debugger(self):
        """Wait until the browser says where it listens, and give the address of its page."""
        said = Path(self._folder) / "DevToolsActivePort"
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            assert self._process.poll() is None, "Chromium has ended"
            with contextlib.suppress(OSError, ValueError, IndexError):
                port = int(said.read_text(encoding="utf-8").split()[0])
                return self._page(port)
            time.sleep(0.05)
        raise TimeoutError("Chromium does not start")

    def _page(self, port):
        from urllib.request import urlopen

        with urlopen(f"http://127.0.0.1:{port}/json/list", timeout=PATIENCE) as answer:
            pages = [page for page in json.load(answer) if page["type"] == "page"]
        return pages[0]["webSocketDebuggerUrl"] if pages else int("")

    def send(self, method, **parameters):
        """Call a method of the protocol, noting what the page complains about meanwhile."""
        self._number += 1
        number = self._number
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=PATIENCE))
            if message.get("id") == number:
                if message.get("error", {}).get("message") in _NAVIGATED:
                    raise NavigatedError(method)
                assert "error" not in message, (method, message["error"])
                return message["result"]
            self._note(message)

    def _note(self, message):
        about = message.get("params", {})
        if message.get("method") == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(about["exceptionDetails"])[:2000])
        elif message.get("method") == "Runtime.consoleAPICalled" and about["type"] == "error":
            self.errors.append(json.dumps(about["args"])[:2000])
        elif message.get("method") == "Log.entryAdded" and about["entry"]["level"] == "error":
            self.errors.append(f"{about['entry']['text']} {about['entry'].get('url', '')}")

    def open(self, address):
        """Go to an address."""
        self.send("Page.navigate", url=address)

    def value(self, script):
        """Evaluate JavaScript; a promise is waited for."""
        options = {"returnByValue": True, "awaitPromise": True}
        result = self.send("Runtime.evaluate", expression=script, **options)
        assert "exceptionDetails" not in result, result["exceptionDetails"]
        return result["result"].get("value")

    def wait_for(self, script, patience=PATIENCE):
        """Wait until JavaScript gives something true, on whatever page comes."""
        tried = f"(() => {{ try {{ return Boolean({script}) }} catch (e) {{ return false }} }})()"
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline:
            with contextlib.suppress(NavigatedError):
                if self.value(tried):
                    return
            time.sleep(0.1)
        raise TimeoutError(f"never true: {script}")

    def mouse(self, kind, x, y, buttons=0):
        """Send one event of the mouse: mousePressed, mouseMoved or mouseReleased."""
        button = "none" if kind == "mouseMoved" else "left"
        count = 0 if kind == "mouseMoved" else 1
        event = {"type": kind, "x": x, "y": y, "button": button, "buttons": buttons}
        self.send("Input.dispatchMouseEvent", **event, clickCount=count)

    def click(self, x, y):
        """Click at a place."""
        self.mouse("mouseMoved", x, y)
        # A scene notices what is under the mouse when it draws.
        self.frames(3)
        self.mouse("mousePressed", x, y, buttons=1)
        self.mouse("mouseReleased", x, y)

    def frames(self, count):
        """Wait until the page has drawn so many times."""
        step = "new Promise(r => requestAnimationFrame(r))"
        self.value(f"(async () => {{ for (let i = 0; i < {count}; i++) await {step}; }})()")

    def picture(self, path):
        """Write what is seen as PNG."""
        data = self.send("Page.captureScreenshot", format="png")["data"]
        Path(path).write_bytes(base64.b64decode(data))

    def close(self):
        """End the browser."""
        with contextlib.suppress(Exception):
            self._socket.close()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        shutil.rmtree(self._folder, ignore_errors=True)
