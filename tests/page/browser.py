"""A browser without a window, spoken to by the DevTools protocol over a pipe: no driver, no network."""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
         "--remote-debugging-pipe", "about:blank"]


def program():
    """Where the browser is; a machine without one fails."""
    found = next((path for path in map(shutil.which, PROGRAMS) if path), None)
    assert found, "no Chromium here: tools/setup.sh test installs it"
    return found


class Browser:
    """One page. Errors of its console and of its scripts are kept."""

    def __init__(self, width=1280, height=900):
        self.profile = tempfile.mkdtemp(prefix="joulepath-page-")
        to_read, self.to = os.pipe()
        self.answers, to_write = os.pipe()
        command = 'exec 3<&"$0" 4>&"$1"; shift; exec "$@"'
        self.process = subprocess.Popen(["bash", "-c", command, str(to_read), str(to_write), program(),
                                         f"--user-data-dir={self.profile}", *FLAGS],
                                        pass_fds=(to_read, to_write), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.buffer, self.number, self.session, self.errors = b"", 0, None, []
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")
        self.resize(width, height)

    def close(self):
        self.session = None
        try:
            self.send("Browser.close")
            self.process.wait(5)
        except (OSError, AssertionError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.to)
        os.close(self.answers)
        shutil.rmtree(self.profile, ignore_errors=True)

    # ---- The protocol ----

    def receive(self):
        while b"\0" not in self.buffer:
            data = os.read(self.answers, 1 << 20)
            assert data, "the browser has ended"
            self.buffer += data
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)

    def note(self, message):
        method, parameters = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(parameters["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.errors.append(json.dumps(parameters["args"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.errors.append(parameters["entry"]["text"])

    def send(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                assert "error" not in answer, answer
                return answer["result"]
            self.note(answer)

    # ---- What a person does ----

    def resize(self, width, height, ratio=1, phone=False):
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=ratio, mobile=phone)

    def open(self, address):
        """A file, or an address with a fragment."""
        self.send("Page.navigate", url=address if "://" in str(address) else Path(address).resolve().as_uri())
        self.wait("document.readyState === 'complete'")

    def ask(self, expression):
        answer = self.send("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait(self, condition, seconds=10.0):
        end = time.monotonic() + seconds
        while not self.ask(condition):
            assert time.monotonic() < end, f"not within {seconds} s: {condition}"
            time.sleep(0.02)

    def centre(self, selector):
        """Of an element, after it was scrolled into view."""
        return self.ask(f"""(() => {{ const e = document.querySelector({json.dumps(selector)});
            e.scrollIntoView({{block: "center"}}); const b = e.getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2]; }})()""")

    def mouse(self, kind, x, y, **more):
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", **more)

    def click(self, selector):
        x, y = self.centre(selector)
        self.mouse("mousePressed", x, y, clickCount=1, buttons=1)
        self.mouse("mouseReleased", x, y, clickCount=1)

    def drag(self, begin, end, steps=4):
        self.mouse("mousePressed", *begin, clickCount=1, buttons=1)
        for i in range(1, steps + 1):
            at = [a + (b - a) * i / steps for a, b in zip(begin, end)]
            self.mouse("mouseMoved", *at, buttons=1)
        self.mouse("mouseReleased", *end, clickCount=1)

    def press(self, key, code=0, text=""):
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key, windowsVirtualKeyCode=code, text=text)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code)

    def choose(self, selector, value):
        """Of a list, as the browser tells its page when a person has chosen."""
        self.ask(f"""(() => {{ const e = document.querySelector({json.dumps(selector)}); e.value = {json.dumps(value)};
            e.dispatchEvent(new Event("input", {{bubbles: true}})); e.dispatchEvent(new Event("change", {{bubbles: true}})); }})()""")

    def shoot(self, path, whole=False):
        picture = self.send("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        Path(path).write_bytes(base64.b64decode(picture["data"]))
