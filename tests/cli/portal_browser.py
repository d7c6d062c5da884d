"""Starts, stops and resumes runs by clicks on the page of a portal. Controls
Chromium over its DevTools pipe.

portal_browser.py CHROMIUM URL PROJECT RUNS PICTURE
"""
import base64
import json
import os
import subprocess
import sys
import tempfile
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
             "--window-size=1360,1100", f"--user-data-dir={folder}",
             "about:blank"],
            close_fds=False, preexec_fn=place,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(down)
        os.close(up)
        self.rest, self.last, self.session = b"", 0, None
        target = self.call("Target.createTarget", url="about:blank")
        self.session = self.call("Target.attachToTarget", flatten=True,
                                 targetId=target["targetId"])["sessionId"]
        self.errors = []
        for domain in ("Page", "Runtime", "Log"):
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

    def until(self, script, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.ask(script)
            if value:
                return value
            time.sleep(0.05)
        raise SystemExit(f"not within {seconds} s: {script}")

    def go(self, url):
        self.call("Page.navigate", url=url)
        self.until("document.readyState === 'complete' && "
                   f"location.href.startsWith({json.dumps(url)})")

    def click(self, selector):
        """Clicks in the middle of an element."""
        at = self.ask(
            f"(() => {{ const e = document.querySelector({selector!r});"
            "if (!e) return null; e.scrollIntoView({block: 'center',"
            "behavior: 'instant'}); const r = e.getBoundingClientRect();"
            "return [r.x + r.width / 2, r.y + r.height / 2]; })()")
        if not at:
            return False
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1],
                      button="left", clickCount=1)
        return True

    def type(self, selector, text):
        self.until(f"(() => {{ const e = document.querySelector({selector!r});"
                   "if (!e) return 0; e.closest('details')?.setAttribute("
                   "'open', ''); e.focus(); e.select?.(); return 1; })()")
        self.call("Input.insertText", text=text)

    def picture(self, path):
        shot = self.call("Page.captureScreenshot", format="png")
        with open(path, "wb") as f:
            f.write(base64.b64decode(shot["data"]))

    def close(self):
        try:
            self.call("Browser.close")
        except (SystemExit, OSError, RuntimeError):
            pass
        self.process.wait(20)


STATES = ("Object.fromEntries([...document.querySelectorAll('article')].map("
          "r => [r.id, r.dataset.state]))")


def start(b, url, project, k):
    """Starts a run from the form, with typed settings."""
    b.go(f"{url}?project={project}")
    b.type("#title", f"run {k}")
    for name, value in (("s.leaf_cells", "12000"), ("s.threads", "1"),
                        ("s.write", "b8.ugrid")):
        b.type(f"[name='{name}']", value)
        if not b.ask(f"document.querySelector(\"[name='{name}']\").closest("
                     "'.row').classList.contains('changed')"):
            raise SystemExit(f"{name} is not marked as changed")
    b.click("button.main")
    b.until(f"document.querySelector('#run-{k}') !== null")


def work(b, n, picture, seconds):
    """Stops each run once it is active and has kept a task, resumes it, and
    waits for its end."""
    stopped, resumed, shot = set(), set(), False
    end = time.monotonic() + seconds
    while True:
        now = b.until(STATES)
        if len(now) == n and all(s == "done" for s in now.values()):
            return stopped, resumed
        if time.monotonic() > end:
            raise SystemExit(f"not all done: {now}")
        for run, state in now.items():
            stage = b.ask(f"document.querySelector('#{run} .progress b')"
                          "?.textContent")
            if (state == "running" and run not in stopped and
                    stage in ("fill", "cut and join")):
                if not shot and len(resumed) > 2:
                    b.ask("window.scrollTo(0, 0)")
                    b.picture(picture)
                    shot = True
                if b.click(f"#{run} form[action$='/stop'] button"):
                    b.until(f"/^(stop|done)/.test(document.querySelector("
                            f"'#{run}').dataset.state)")
                    stopped.add(run)
            elif state == "stopped" and run in stopped:
                if b.click(f"#{run} form[action$='/resume'] button"):
                    b.until(f"document.querySelector('#{run}').dataset.state"
                            " !== 'stopped'")
                    resumed.add(run)
            elif state == "failed":
                raise SystemExit(f"{run} failed: " + b.ask(
                    f"document.querySelector('#{run}').textContent"))
        time.sleep(0.05)


def main():
    program, url, project, n, picture = sys.argv[1:]
    n = int(n)
    with tempfile.TemporaryDirectory() as folder:
        b = Browser(program, folder)
        try:
            b.go(url)
            b.until("document.querySelector('#projects li a') !== null")
            b.click(f"#projects a[href*='{project}']")
            b.until("document.querySelector('#settings') !== null")
            b.type("input[type=search]", "y_plus")
            rows = b.ask("[...document.querySelectorAll('.row')].filter("
                         "r => !r.hidden).length")
            if not 0 < rows < 20:
                raise SystemExit(f"{rows} rows for y_plus")
            for k in range(1, n + 1):
                start(b, url, project, k)
            stopped, resumed = work(b, n, picture, 1200)
            print(f"{n} runs started, {len(stopped)} stopped, "
                  f"{len(resumed)} resumed")
            # Without scripts, all runs are listed.
            b.call("Emulation.setScriptExecutionDisabled", value=True)
            b.go(url)
            if len(b.until(STATES)) != n:
                raise SystemExit("not all runs are listed without scripts")
            b.call("Emulation.setScriptExecutionDisabled", value=False)
            # The report runs in a sandbox of its own.
            b.go(url)
            report = b.until("document.querySelector('a.report').href")
            b.go(report)
            b.until("document.body.innerText.toLowerCase().includes("
                    "'vanguard mesh report')")
            if b.ask("self.origin") != "null":
                raise SystemExit("the report does not run in a sandbox")
            if b.errors:
                raise SystemExit("the browser complains: " + b.errors[0])
        finally:
            b.close()


main()
