# SPDX-License-Identifier: LGPL-3.0-or-later
"""From an uploaded STEP file to finished meshes, with the page of a portal:
patches picked in the 3-D view, errors at their fields, check, forecast, start,
stop, resume, report, comparison, deletion, the defects of a refused surface,
and a sweep; with mouse and keyboard, at 390 and 1,600 pixels.

portal_case.py CHROMIUM URL FOLDER PICTURES
FOLDER has the files to upload: wing.step, open.obj, box.lb8.ugrid, notes.txt
"""
import json
import os
import sys
import tempfile
import time

from browser import Browser

# Limit of any wait, in seconds. It only matters if a page does not work: with
# sanitizers, on a busy machine, a mesh takes minutes.
LONG = 700
TAB, ENTER, SPACE = ("Tab", 9), ("Enter", 13, "\r"), (" ", 32, " ")


def fail(text):
    raise SystemExit("portal_case: " + text)


def expect(value, text):
    if not value:
        fail(text)


class Case:
    def __init__(self, browser, url, folder, pictures):
        self.b, self.url = browser, url
        self.folder, self.pictures = folder, pictures

    # --- small steps

    def picture(self, name):
        self.b.until("[...document.images].every(i => i.loading === 'lazy' || "
                     "i.complete)")
        time.sleep(0.3)  # the view is drawn in the next frame
        self.b.picture(os.path.join(self.pictures, name + ".png"))

    def upload(self, name):
        self.b.go(self.url)
        self.b.files("form.upload input[type=file]",
                     [os.path.join(self.folder, name)])
        self.b.click("form.upload button")
        self.b.until(f"location.search.endsWith('={name}')")

    def drawn(self):
        self.b.until("document.querySelector('.viewbox')?.dataset.drawn")
        return int(self.b.ask(
            "document.querySelector('.viewbox').dataset.drawn"))

    def set(self, **values):
        for name, value in values.items():
            self.b.type(f"[name='s.{name}']", value)

    def rows(self):
        """Numbers of the chosen patches."""
        return self.b.ask("[...document.querySelectorAll('.patches tr.chosen')]"
                          ".map(r => Number(r.dataset.id))")

    def state(self, run):
        return f"document.querySelector('#run-{run}')?.dataset.state"

    def status(self):
        return self.b.ask("document.getElementById('status').className + ' ' + "
                          "document.getElementById('status').innerText")

    def act(self, button, done):
        """Presses a button and waits for its result, or reports why there is
        none."""
        self.b.click(button)
        self.b.until(f"{done} || document.getElementById('status').className "
                     "=== 'message'", LONG)
        expect(not self.status().startswith("message"), self.status())

    # --- parts of the test

    def uploads(self):
        self.upload("notes.txt")
        said = self.b.ask("document.querySelector('.message.warn').innerText")
        expect("not a project" in said, "an upload that is no project: " + said)
        self.upload("wing.step")
        expect(self.drawn() > 20000, "the view is empty")
        self.picture("portal_geometry")

    def picks(self):
        """A click in the view, the keys of the view, the boxes of the table."""
        b = self.b
        at = b.ask("(() => { const c = document.querySelector('canvas'), r = "
                   "c.getBoundingClientRect(), v = c.view, s = v.scene.place;"
                   "const i = v.facts.patches.findIndex(p => /upper/.test("
                   "p.name)); const t = v.facts.patches[i].first;"
                   # a point of that patch that no other patch hides
                   "for (let k = t; k < t + v.facts.patches[i].count; k++) {"
                   "const x = [0, 1, 2].map(j => (s[9 * k + j] + s[9 * k + 3 +"
                   " j] + s[9 * k + 6 + j]) / 3); const p = v.project(x);"
                   "if (v.patchOf(pickTriangle(v, p[0], p[1])) === i)"
                   "return [r.x + p[0], r.y + p[1]]; } return null; })()")
        expect(at, "no triangle of patch 1 is visible")
        b.mouse(*at)
        b.until("document.querySelectorAll('.patches tr.chosen').length === 1")
        expect(self.rows() == [1], f"picked {self.rows()}, not 1")
        expect(b.ask("document.activeElement.tagName") == "CANVAS",
               "a click does not move the focus to the view")
        b.key("n", 78, "n")
        expect(self.rows() == [2], f"n leads to {self.rows()}, not 2")
        turned = "JSON.stringify(document.activeElement.view.camera.eye)"
        before = b.ask(turned)
        b.key("ArrowLeft", 37)
        b.key("+", 187, "+")
        expect(b.ask(turned) != before, "keys do not move the view")
        b.key("0", 48, "0")
        b.key("Escape", 27)
        expect(self.rows() == [], "Escape leaves patches chosen")
        # The keyboard reaches the boxes of the table; the farfield, which the
        # program adds, cannot be chosen.
        b.ask("document.querySelector('.patches thead input').focus()")
        b.key(*SPACE)
        expect(self.rows() == [1, 2, 3, 4, 5], f"all: {self.rows()}")
        b.ask("document.querySelector('.selection select').focus()")
        b.key("4", 52, "4")
        b.until("document.getElementById('patches').value.includes('5   4')")
        text = b.ask("document.getElementById('patches').value").split()
        expect(text == ["id", "bc", "1", "4", "2", "4", "3", "4", "4", "4", "5",
                        "4"], f"the table of patches is {text}")

    def errors(self):
        b = self.b
        self.set(y_plus="1", reynolds="5e6")
        b.click("#check")
        b.until("!!document.querySelector('.row.bad p.wrong')")
        expect(b.ask("document.activeElement.name") == "s.reynolds",
               "the focus is not at the wrong field")
        self.picture("portal_wrong")
        self.set(reference_length="1000")
        # A refused run marks the field as well, and keeps what was typed.
        self.set(hmin="x")
        b.click("button.main")
        b.until("document.querySelector(\"[name='s.hmin']\")?.getAttribute("
                "'aria-invalid') === 'true' && location.pathname.endsWith("
                "'/runs')")
        expect(b.ask("document.querySelector(\"[name='s.hmin']\").value") ==
               "x", "the typed value is lost")
        expect(b.ask("document.getElementById('patches').value").split()[:4] ==
               ["id", "bc", "1", "4"], "the table is lost")
        self.drawn()
        self.set(hmin="")

    def searches(self):
        b = self.b
        b.type(".search input", "farfield")
        hidden = b.ask(
            "[...document.querySelectorAll(\"[name^='farfield.']\")].filter("
            "e => !e.checkVisibility()).map(e => e.name)")
        expect(hidden == [], f"a search for farfield hides {hidden}")
        expect(not b.ask("document.querySelector(\"[name='s.threads']\")"
                         ".checkVisibility()"), "threads is still visible")
        b.type(".search input", "")
        b.key("Backspace", 8)

    def tables(self):
        """A source by the editor of its table."""
        b = self.b
        group = ("[...document.querySelectorAll('.group')].find(g => g."
                 "querySelector('#sources'))")
        b.ask(f"document.getElementById('all').open = {group}.open = true;"
              f"{group}.querySelector('.tools button').click()")
        kind = "document.querySelector('#sources').editor.first(2)"
        b.ask(f"{kind}.value = 'line';"
              f"{kind}.dispatchEvent(new Event('change'))")
        names = b.ask(f"[...{group}.querySelectorAll('th')].map("
                      "e => e.firstChild?.textContent || '')")
        expect("x1" in names, f"a line has no second point: {names}")
        for name, value in (("x0", "0"), ("x1", "1000"), ("h0", "40"),
                            ("r0", "100")):
            b.ask(f"(() => {{ const e = {group}.querySelector(\"[aria-label^='"
                  f"{name},']\"); e.value = '{value}';"
                  "e.dispatchEvent(new Event('change')); })()")
        text = b.ask("document.querySelector('#sources').value").split()
        expect(text[:1] == ["kind"] and "line" in text and "1000" in text,
               f"the table of sources is {text}")
        b.ask(f"{group}.querySelector('td button').click()")
        expect(b.ask("document.querySelector('#sources').value") == "",
               "a removed row stays")
        b.ask(f"document.getElementById('all').open = {group}.open = false")

    def checks(self):
        b = self.b
        self.set(surface_size="200", edges_per_turn="10", scale="2",
                 leaf_cells="5000", threads="1", write="b8.ugrid")
        self.act("#check", "/^Checked/.test(document.querySelector("
                 "'.viewhead').innerText)")
        expect(self.drawn() > 20000, "the checked surface is not drawn")
        said = b.ask("document.querySelector('.verdict').innerText")
        expect("accepted" in said, said)
        expect(b.ask("document.querySelector(\".patches tr[data-id='1']\")"
                     ".cells[4].innerText") == "yes", "patch 1 has no layers")
        self.act("#plan", "!document.getElementById('forecast').hidden")
        self.forecast = b.ask("document.getElementById('forecast').innerText")
        for word in ("Cells", "Memory", "Time"):
            expect(word in self.forecast, f"no {word} in {self.forecast}")
        b.ask("window.scrollTo(0, 0)")
        self.picture("portal_forecast")
        # The forecast is outdated once a setting changes.
        self.set(growth="1.21")
        expect(b.ask("document.getElementById('forecast').classList.contains("
                     "'stale')"), "the old forecast is not marked")
        self.set(growth="")
        b.key("Backspace", 8)

    def fits(self):
        b = self.b
        b.type("#target", "200,000")
        b.ask("[...document.querySelectorAll('button')].find(e => e.textContent"
              " === 'Fit scale').click()")
        b.until("document.getElementById('status').innerText !== ''")
        b.until("document.getElementById('status').innerText === '' || document"
                ".getElementById('status').className === 'message'", LONG)
        expect(not self.status().startswith("message"), self.status())
        cells = b.ask("document.querySelector('#forecast dd').innerText")
        n = int(cells.strip("~").replace(",", ""))
        expect(abs(n / 200000 - 1) < 0.05, f"{cells} cells, not 200,000")
        self.set(scale="2")

    def runs(self):
        """Starts, stops and resumes run 1; run 2 has other settings."""
        b = self.b
        b.type("#title", "Wing")
        # Enough cells to be stopped while subdomains are filled.
        self.set(scale="1.7", growth="1.08", y_plus="50")
        b.click("button.main")
        b.until("location.hash === '#run-1'")
        b.until("/fill|cut/.test(document.querySelector('#run-1 .progress b')"
                f"?.innerText) || {self.state(1)} === 'done'", LONG)
        b.click("#run-1 form[action$='/stop'] button")
        b.until(f"/stopped|done/.test({self.state(1)})", LONG)
        expect(b.ask(self.state(1)) == "stopped", "run 1 was not stopped")
        b.click("#run-1 form[action$='/resume'] button")
        b.until(f"{self.state(1)} === 'running'", LONG)
        b.until(f"{self.state(1)} === 'done'", LONG)
        b.click("#run-1 a[href*='from=']")
        b.until("location.search === '?from=1'")
        self.drawn()
        b.type("#title", "Wing, coarser")
        self.set(scale="2.6")
        b.click("button.main")
        b.until("location.hash === '#run-2'")
        b.until(f"{self.state(2)} === 'done'", LONG)
        b.until("document.querySelector('#run-2 .thumb img').naturalWidth > 0")
        b.ask("window.scrollTo(0, 0)")
        self.picture("portal_runs")
        card = b.ask("document.querySelector('#run-1').innerText")
        expect("valid" in card and "Smallest angle" in card, card)
        listed = json.loads(b.ask(
            "(() => { const r = new XMLHttpRequest(); r.open('GET', 'runs.json',"
            " false); r.send(); return r.responseText; })()"))
        expect(f"{listed[0]['cells']:,}" in card and listed[0]["valid"],
               f"{listed[0]} is not on the card: {card}")

    def results(self):
        b = self.b
        for k in (1, 2):
            b.click(f"#run-{k} .pick input")
        b.click("#compare button")
        b.until("location.search === '?compare=2&compare=1' || "
                "location.search === '?compare=1&compare=2'")
        b.until("document.readyState === 'complete'")
        said = b.ask("document.querySelector('main').innerText")
        expect("scale" in said and "growth" not in said.split(
            "Different settings")[1].split("Pictures")[0],
            "the comparison does not list the different settings")
        self.picture("portal_compare")
        b.go(self.url)
        b.click("#run-1 .buttons a.result")
        b.until("location.search === '?report=1'")
        # The sandbox gives it an origin, and so a target, of its own.
        for _ in range(100):
            targets = b.call("Target.getTargets")["targetInfos"]
            frame = [t["url"] for t in targets if t["type"] == "iframe" or
                     t["url"].endswith(".report.html")]
            if frame:
                break
            time.sleep(0.1)
        expect(frame and frame[0].endswith(".report.html"),
               f"the report is not in the page: {targets}")
        expect(b.ask("(() => { try { return document.querySelector('iframe')"
                     ".contentDocument === null; } catch { return true; } "
                     "})()"), "the page and the report share an origin")
        time.sleep(2)
        self.picture("portal_report")

    def defects(self):
        b = self.b
        self.upload("open.obj")
        expect(self.drawn() > 10000, "a refused surface is not shown")
        said = b.ask("document.getElementById('findings').innerText")
        expect("open edge: 3" in said and "self-intersection: 5" in said, said)
        before = b.ask("JSON.stringify(document.querySelector('canvas').view"
                       ".camera.eye)")
        b.picture(os.path.join(self.pictures, "portal_defects.png"))
        b.click(".defects button.link")
        expect(b.ask("JSON.stringify(document.querySelector('canvas').view"
                     ".camera.eye)") != before, "a defect does not move the view")

    def sweeps(self):
        b = self.b
        self.upload("box.lb8.ugrid")
        self.drawn()
        for name, value in (("leaf_cells", "2000,4000"), ("threads", "1,2")):
            b.type(f"[name='sweep.{name}']", value)
        b.click("button[value=sweep]")
        b.until("location.hash === '#run-3'")
        b.until(f"{self.state(3)} === 'done'", LONG)
        b.click("#run-3 a.result")
        b.until("location.search === '?sweep=3'")
        b.until("document.querySelectorAll('tbody tr').length === 4")
        b.ask("[...document.images].forEach(i => { i.loading = 'eager'; })")
        b.until("[...document.images].length > 4 && [...document.images].every("
                "i => i.naturalWidth > 0)")
        self.picture("portal_sweep")

    def widths(self):
        """No page is wider than the window, and the controls are visible."""
        b = self.b
        for width in (390, 1600):
            b.size(width, 900, width < 500)
            for page in ("", "?project=wing.step", "?report=1",
                         "?compare=1&compare=2", "?sweep=3"):
                b.go(self.url + page)
                time.sleep(0.3)
                wide = b.ask("document.documentElement.scrollWidth")
                expect(wide <= width, f"{page}: {wide} of {width} pixels")
            b.go(self.url + "?project=wing.step")
            self.drawn()
            for control in ("canvas", "#check", "#plan", "button.main",
                            "[name='s.y_plus']", ".patches tbody input"):
                box = b.ask("(() => { const e = document.querySelector("
                            f"{json.dumps(control)}); e.scrollIntoView({{block:"
                            "'center'}); const r = e.getBoundingClientRect();"
                            "return [r.left, r.right, r.height]; })()")
                expect(box[0] >= 0 and box[1] <= width and box[2] > 8,
                       f"{control} is at {box} of {width} pixels")
            b.ask("window.scrollTo(0, 0)")
            if width < 500:
                self.picture("portal_narrow")
        b.size(1600, 1000)

    def keyboard(self):
        """Tab reaches all main controls of the project's page, and a run is
        deleted by keys alone."""
        b = self.b
        b.go(self.url + "?project=wing.step")
        self.drawn()
        b.ask("document.body.focus()")
        missing = {"canvas", "#check", "#plan", "button.main", "#title",
                   ".search input", "[name='s.layers']", ".patches tbody input",
                   "form.upload button", "#compare button", "#target"}
        for _ in range(150):
            b.key(*TAB)
            here = b.ask(f"{json.dumps(sorted(missing))}.filter(s => document"
                         ".activeElement.matches(s))")
            missing -= set(here)
        expect(not missing, f"Tab does not reach {missing}")
        b.go(self.url)
        b.ask("document.querySelector('#delete-2 summary').focus()")
        b.key(*ENTER)
        b.until("document.querySelector('#delete-2').open")
        b.key(*TAB)
        expect(b.ask("document.activeElement.innerText").startswith("Delete"),
               "Tab does not lead to the button")
        b.key(*ENTER)
        b.until("!document.querySelector('#run-2')")
        expect(b.ask("[...document.querySelectorAll('article')].map(r => r.id)")
               == ["run-3", "run-1"], "another run is gone")

    def stays_here(self):
        away = [u for u in self.b.requests
                if not u.startswith((self.url, "data:", "blob:", "about:"))]
        expect(not away, f"requests leave the portal: {away[:3]}")
        expect(len(self.b.requests) > 50, "requests were not recorded")
        # Refused forms are answered by 400, which the console lists.
        bad = [e for e in self.b.errors if "400 (Bad Request)" not in e]
        expect(not bad, f"the browser complains: {bad[:3]}")


def main():
    program, url, folder, pictures = sys.argv[1:]
    with tempfile.TemporaryDirectory() as profile:
        b = Browser(program, profile)
        try:
            b.size(1600, 1000)
            case = Case(b, url, folder, pictures)
            for part in ("uploads", "picks", "errors", "searches", "tables",
                         "checks", "fits", "runs", "results", "defects",
                         "sweeps", "widths", "keyboard", "stays_here"):
                began = time.monotonic()
                getattr(case, part)()
                print(f"{part}: {time.monotonic() - began:.1f} s", flush=True)
        except SystemExit:
            said = b.ask("location.href + [...document.querySelectorAll("
                         "'[role=alert], .message')].map(e => e.innerText)")
            print("the page says:", said, file=sys.stderr)
            b.picture(os.path.join(pictures, "failure.png"))
            raise
        finally:
            b.close()


main()
