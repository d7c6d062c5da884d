# SPDX-License-Identifier: LGPL-3.0-or-later
"""Controls a headless Chromium over its DevTools pipe, for tests of pages."""
import base64
import json
import os
import subprocess
import time


class Browser:
    """One page of a headless Chromium."""

    def __init__(self, program, folder):
        down, self.to = os.pipe()
        self.of, up = os.pipe()
        fds = {3: down, 4: up}

        def place():
            for want, have in fds.items():
                os.dup2(have, want + 10)
            for want in fds:
                os.dup2(want + 10, want)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu",
             "--disable-quic", "--no-first-run", "--hide-scrollbars",
             "--disable-background-networking", "--disable-component-update",
             "--disable-sync", "--remote-debugging-pipe",
             "--enable-unsafe-swiftshader", "--window-size=1360,1100",
             f"--user-data-dir={folder}", "about:blank"],
            close_fds=False, preexec_fn=place,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(down)
        os.close(up)
        self.rest, self.last, self.session = b"", 0, None
        target = self.call("Target.createTarget", url="about:blank")
        self.session = self.call("Target.attachToTarget", flatten=True,
                                 targetId=target["targetId"])["sessionId"]
        self.errors, self.requests = [], []
        for domain in ("Page", "Runtime", "Log", "Network", "DOM"):
            self.call(domain + ".enable")

    def read(self):
        while b"\0" not in self.rest:
            piece = os.read(self.of, 1 << 20)
            if not piece:
                raise SystemExit("chromium has ended")
            self.rest += piece
        message, self.rest = self.rest.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **params):
        self.last += 1
        message = {"id": self.last, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.to, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            if answer.get("method") == "Network.requestWillBeSent":
                self.requests.append(answer["params"]["request"]["url"])
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(str(answer["params"]))
            if (answer.get("method") == "Log.entryAdded" and
                    answer["params"]["entry"]["level"] == "error"):
                self.errors.append(answer["params"]["entry"]["text"])

    def ask(self, script):
        """Returns the value of an expression, or None while a page is loading."""
        try:
            result = self.call("Runtime.evaluate", expression=script,
                               returnByValue=True)
        except RuntimeError:
            return None
        return result["result"].get("value")

    def until(self, script, seconds=120):
        """Waits until the page is complete and the expression is true. Returns its
        value."""
        script = f"document.readyState === 'complete' && ({script})"
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.ask(script)
            if value:
                return value
            time.sleep(0.05)
        raise SystemExit(f"not within {seconds} s: {script}")

    def go(self, url):
        self.call("Page.navigate", url=url)
        self.until(f"location.href.startsWith({json.dumps(url)})")

    def size(self, width, height, mobile=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width,
                  height=height, deviceScaleFactor=1, mobile=mobile)

    def mouse(self, x, y, modifiers=0):
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                      button="left", clickCount=1, modifiers=modifiers)

    def key(self, key, code=0, text="", modifiers=0):
        """Presses a key, as in ("Tab", 9) or ("n", 78, "n")."""
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, code=key,
                      windowsVirtualKeyCode=code, modifiers=modifiers,
                      **({"text": text} if text and kind == "keyDown" else {}))

    def files(self, selector, paths):
        """Chooses files in a file input."""
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", nodeId=root,
                         selector=selector)["nodeId"]
        self.call("DOM.setFileInputFiles", nodeId=node, files=paths)

    def click(self, selector):
        """Clicks in the middle of an element, once it has stopped moving."""
        at, before = None, None
        for _ in range(40):
            at = self.ask(
                f"(() => {{ const e = document.querySelector({selector!r});"
                "if (!e) return null; e.scrollIntoView({block: 'center',"
                "behavior: 'instant'}); const r = e.getBoundingClientRect();"
                "return [r.x + r.width / 2, r.y + r.height / 2]; })()")
            if not at:
                return False
            if at == before:
                break
            before = at
            time.sleep(0.03)
        self.mouse(*at)
        return True

    def type(self, selector, text):
        self.until(f"(() => {{ const e = document.querySelector({selector!r});"
                   "if (!e) return 0; for (let d = e; d; d = d.parentElement)"
                   "if (d.tagName === 'DETAILS') d.open = true;"
                   "e.focus(); e.select?.(); return 1; })()")
        self.call("Input.insertText", text=text)

    def picture(self, path, whole=False):
        shot = self.call("Page.captureScreenshot", format="png",
                         captureBeyondViewport=whole)
        with open(path, "wb") as f:
            f.write(base64.b64decode(shot["data"]))

    def close(self):
        try:
            self.call("Browser.close")
        except (SystemExit, OSError, RuntimeError):
            pass
        self.process.wait(20)
