# SPDX-License-Identifier: LGPL-3.0-or-later
"""Starts, stops and resumes runs by clicks on the page of a portal.

portal_browser.py CHROMIUM URL PROJECT RUNS PICTURE
"""
import sys
import tempfile
import time

from browser import Browser

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
                if not shot and len(resumed) >= min(3, n - 1):
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
            b.type(".search input", "y_plus")
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
            report = b.until(
                "document.querySelector('a[href$=\\'.report.html\\']').href")
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
