/* SPDX-License-Identifier: LGPL-3.0-or-later */
// The geometry of a project before a run: the 3-D view with its patches, the
// check, its defects, and the forecast.
import { clearWrong, make, markWrong, settings } from "./form.js";

const DEFECT = [206, 36, 44], SOUND = 255;

const geometry = document.getElementById("geometry");
let view = null, seen3d = null;      // the view, and the result it shows
const chosen = new Set();            // numbers of the chosen patches

// --- requests ---------------------------------------------------------------

class LookError extends Error {
  constructor(message, field, line) {
    super(message);
    this.field = field;
    this.line = line;
  }
}

function wait(ms) {
  return new Promise(done => setTimeout(done, ms));
}

// Starts a look and waits for its result; tell(stage, share) is called
// meanwhile.
async function look(kind, tell) {
  const body = new URLSearchParams(new FormData(settings));
  const answer = await fetch("looks/" + kind, { method: "POST", body });
  const made = await answer.json();

  if (!answer.ok) throw new LookError(made.error, made.field, made.line);
  look.id[kind] = made.id;
  for (let ms = 60;; ms = Math.min(ms * 1.5, 700)) {
    await wait(ms);
    const now = await (await fetch("looks/" + made.id)).json();
    if (now.state === "done") return { id: made.id, ...now.result };
    if (now.state !== "running") throw new LookError(now.error);
    tell(now.stage, now.share);
  }
}
look.id = {};

function stopLook(kind) {
  if (look.id[kind]) fetch(`looks/${look.id[kind]}/stop`, { method: "POST" });
}

// --- numbers ----------------------------------------------------------------

const whole = n => Math.round(n).toLocaleString("en");
function about(n) {
  if (!(n > 0)) return "0";
  const digits = Math.max(0, Math.floor(Math.log10(n)) - 2);
  return "~" + whole(Math.round(n / 10 ** digits) * 10 ** digits);
}
function bytes(n) {
  const unit = ["B", "kB", "MB", "GB", "TB"];
  let k = 0;
  for (; n >= 1000 && k < 4; k++) n /= 1000;
  return `${k && n < 10 ? n.toFixed(1) : Math.round(n)} ${unit[k]}`;
}
function time(s) {
  if (s < 100) return s.toPrecision(2).replace(/\.0$/, "") + " s";
  const minutes = Math.round(s / 60);
  return minutes < 100 ? `${minutes} min`
    : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

// --- conditions -------------------------------------------------------------

const conditions = { 4: "viscous wall", 5: "inviscid wall", 1: "symmetry",
  3: "farfield", 0: "freestream" };

function conditionName(code) {
  if (code === null || code === undefined || code === "") return "none";
  return conditions[code] ? `${code} ${conditions[code]}` : String(code);
}

// --- rows of the deck for patches -------------------------------------------

const areaOf = id => settings.elements[id];

// The row of a table that is about this patch alone, by number or name.
function rowOf(id, patch) {
  const rows = areaOf(id).editor.rows || [];
  return rows.find(r => r.id === String(patch.id) ||
                        (patch.name && r.id === patch.name));
}

function setCell(id, patch, column, value) {
  const editor = areaOf(id).editor;
  let row = rowOf(id, patch);

  if (!editor.rows) return;
  if (!row) editor.rows.push(row = { id: String(patch.id) });
  row[column] = value;
  if (Object.entries(row).every(([k, v]) => k === "id" || !v))
    editor.rows.splice(editor.rows.indexOf(row), 1);
  editor.shown.add(column);
  editor.render();
  editor.write();
}

const edited = patch => ({
  bc: rowOf("patches", patch)?.bc || "",
  name: rowOf("patches", patch)?.name || "",
  grow: rowOf("layers", patch)?.grow || "",
});

// --- table of patches -------------------------------------------------------

const panel = {};

// Patches that the program adds, such as a farfield, are not in the file and
// cannot be changed.
function choose(id, add) {
  if (seen3d.patches.find(p => p.id === id)?.added) return;
  if (!add) {
    const only = chosen.size === 1 && chosen.has(id);
    chosen.clear();
    if (only) id = null;
  }
  if (id !== null) {
    if (chosen.has(id)) chosen.delete(id);
    else chosen.add(id);
  }
  showChosen();
}

function showChosen() {
  if (view) {
    view.shown.chosen = new Set(seen3d.patches.flatMap((p, i) =>
      chosen.has(p.id) ? [i] : []));
    view.draw();
  }
  for (const row of panel.body.rows) {
    const on = chosen.has(Number(row.dataset.id));
    row.classList.toggle("chosen", on);
    row.querySelector("input").checked = on;
  }
  renderSelection();
}

function patchRow(p, i) {
  const box = make("input", { type: "checkbox",
    ariaLabel: `Select patch ${p.id} ${p.name}`, disabled: p.added });
  const colour = seen3d.scene.patches[i].colour;
  const swatch = make("span", { className: "swatch" });
  const mine = edited(p), changed = v => (v ? "changed" : "");
  const eye = make("input", { type: "checkbox", className: "eye",
    ariaLabel: `Show patch ${p.id} ${p.name}`, checked: view
      ? view.shown.patch[i] : p.body });
  const grows = mine.grow && mine.grow !== "auto" ? mine.grow
    : p.layers === null ? "–" : p.layers ? "yes" : "no";

  swatch.style.background = `rgb(${colour})`;
  box.addEventListener("change", () => choose(p.id, true));
  eye.addEventListener("change", () => {
    if (!view) return;
    view.shown.patch[i] = eye.checked;
    view.draw();
  });
  const row = make("tr", {},
    make("td", {}, box), make("td", {}, swatch, String(p.id)),
    make("td", { className: changed(mine.name) }, mine.name || p.name || "–"),
    make("td", { className: changed(mine.bc) },
      conditionName(mine.bc || (p.usm3d ?? p.fun3d))),
    make("td", { className: changed(mine.grow), title: p.reason || "" }, grows),
    make("td", { className: "number" }, whole(p.faces)),
    make("td", {}, eye));
  row.dataset.id = p.id;
  if (p.added) row.title = "added by the program";
  row.addEventListener("click", e => {
    if (e.target.tagName !== "INPUT")
      choose(p.id, e.shiftKey || e.ctrlKey || e.metaKey);
  });
  return row;
}

function filterPatches() {
  const text = panel.filter.value.trim().toLowerCase();
  for (const row of panel.body.rows)
    row.hidden = !row.textContent.toLowerCase().includes(text);
}

function renderPatches() {
  panel.body.replaceChildren(...seen3d.patches.map(patchRow));
  panel.filter.hidden = seen3d.patches.length < 9;
  filterPatches();
  showChosen();
}

// The bar that changes all chosen patches at once.
function renderSelection() {
  const list = seen3d ? seen3d.patches.filter(p => chosen.has(p.id)) : [];
  const bar = panel.selection;

  if (!list.length) {
    bar.replaceChildren(make("p", { className: "about" },
      "Click a patch in the view or in the table to set its condition, layers " +
      "and name; Shift adds to the selection."));
    return;
  }
  const first = edited(list[0]), p = list[0];
  const condition = make("select", {},
    make("option", { value: "" }, "as in the file" + (list.length === 1
      ? `: ${conditionName(p.usm3d ?? p.fun3d)}` : "")),
    ...Object.keys(conditions).sort((a, b) => b - a).map(c =>
      make("option", { value: c }, conditionName(c))));
  const layers = make("select", {}, ...[["", "by condition"], ["yes", "yes"],
    ["no", "no"]].map(([v, t]) => make("option", { value: v }, t)));
  const name = make("input", { value: first.name, placeholder: p.name,
    autocomplete: "off", maxLength: 79 });

  if (first.bc && !conditions[first.bc])
    condition.append(make("option", { value: first.bc }, first.bc));
  condition.value = first.bc;
  layers.value = first.grow === "auto" ? "" : first.grow;
  const set = (id, column, value) => {
    for (const one of list) setCell(id, one, column, value);
    renderPatches();
  };
  condition.addEventListener("change", () =>
    set("patches", "bc", condition.value));
  layers.addEventListener("change", () => set("layers", "grow", layers.value));
  name.addEventListener("change", () =>
    set("patches", "name", name.value.trim()));
  const none = make("button", { type: "button", className: "small" },
    "Clear selection");
  none.addEventListener("click", () => {
    chosen.clear();
    showChosen();
  });
  const label = (text, control) => make("label", {}, text, control);
  bar.replaceChildren(
    make("b", { role: "status" }, list.length === 1
      ? `Patch ${p.id} ${first.name || p.name}` : `${list.length} patches`),
    label("condition ", condition), label("layers ", layers),
    list.length === 1 ? label("name ", name) : "", none);
}

// --- view -------------------------------------------------------------------

// Keys of the view beyond those that move it.
function patchKeys(e) {
  const list = seen3d.patches.filter((p, i) => view.shown.patch[i] &&
                                               !p.added);
  const at = list.findIndex(p => chosen.has(p.id));
  const step = { n: 1, p: -1 }[e.key];

  if (e.key === "Escape") chosen.clear();
  else if (step && list.length) {
    const next = at < 0 ? (step > 0 ? 0 : list.length - 1)
      : (at + step + list.length) % list.length;
    chosen.clear();
    chosen.add(list[next].id);
  } else return;
  e.preventDefault();
  showChosen();
}

function colourView() {
  const { patches } = seen3d.scene, kind = view.scene.by[0];
  const ill = seen3d.surface.defects > 0;

  view.colour((i, t) => {
    const c = patches[i].colour;
    if (kind[t] !== SOUND) return DEFECT;
    return ill ? c.map(v => 0.35 * v + 0.65 * 226) : c;
  });
}

// A new canvas for each scene: a canvas keeps its WebGL context.
async function showScene(result) {
  const data = await unpackScene(await (await fetch(
    `looks/${result.id}/scene`)).arrayBuffer());
  const canvas = make("canvas", { tabIndex: 0, role: "img",
    ariaLabel: "3-D view of the surface. Arrow keys rotate, plus and minus " +
    "zoom, 0 resets, n and p choose the next and the previous patch. The " +
    "table lists the patches." });
  const eye = view && { ...view.camera.eye };

  panel.box.querySelector("canvas")?.remove();
  panel.box.prepend(canvas);
  view = createView(canvas, result.scene, data, (t, e) => {
    const i = t < 0 ? -1 : view.patchOf(t);
    canvas.focus({ preventScroll: true });
    if (i >= 0) choose(seen3d.patches[i].id, e.shiftKey || e.ctrlKey);
    else if (chosen.size) choose(null, false);
  });
  view.needsFocus = true;
  view.shown.edges = panel.edges.checked && !result.scene.merged;
  view.shown.backs = result.surface.defects > 0;
  if (eye && seen3d) Object.assign(view.camera.eye, eye);
  view.onPaint = () => {
    panel.box.dataset.drawn ||= view.drawn();  // for tests
  };
  canvas.addEventListener("keydown", patchKeys);
  canvas.view = view;  // for tests
}

async function show(result, words) {
  try {
    await showScene(result);
    panel.box.classList.remove("empty");
  } catch (e) {
    view = null;
    panel.status.textContent = "The 3-D view is not available: " + e.message;
  }
  seen3d = result;
  panel.words.textContent = words + `: ${whole(result.size.triangles)} ` +
    `triangles, ${result.size.patches} patches` +
    (result.scene.merged ? " (reduced for this view)" : "");
  if (view) {
    colourView();
    view.mark([]);
  }
  renderPatches();
  renderFindings();
}

// --- findings ---------------------------------------------------------------

const relative = at => at.map((v, k) => v - seen3d.scene.centre[k]);

function defectLine(d) {
  if (!d.at || !view)
    return make("li", {}, d.text);
  const b = make("button", { type: "button", className: "link" }, d.text);
  b.addEventListener("click", () => {
    view.mark([relative(d.at)]);
    view.focus(relative(d.at), 0.12 * seen3d.scene.radius);
    view.canvas.focus({ preventScroll: true });
    view.canvas.scrollIntoView({ block: "nearest" });
  });
  return make("li", {}, b);
}

// The defects by kind, with the first ones of each.
function defects() {
  const { count, first } = seen3d.surface;
  return Object.entries(count).filter(([, n]) => n).map(([kind, n]) => {
    const list = first.filter(d => d.kind === kind);
    return make("details", { open: true, className: "defects" },
      make("summary", {}, `${kind}: ${whole(n)}`),
      make("ul", {}, ...list.map(defectLine),
        n > list.length ? make("li", { className: "about" },
          `and ${whole(n - list.length)} more, all red in the view`) : ""));
  });
}

function renderFindings() {
  const r = seen3d, parts = [];

  parts.push(make("p", { className: "verdict " + (r.ok ? "good" : "bad") },
    r.ok ? "The surface is accepted." : r.error));
  parts.push(make("p", { className: "about" }, r.flow.statement +
    (r.ok ? r.layers ? ". Layers grow on the patches marked yes."
      : ". No layers grow." : "")));
  parts.push(...defects());
  if (view && r.surface.defects) {
    const all = make("button", { type: "button", className: "small" },
      "Mark the listed defects");
    all.addEventListener("click", () => view.mark(r.surface.first
      .filter(d => d.at).map(d => relative(d.at))));
    parts.push(all);
  }
  if (r.notes.length)
    parts.push(make("details", {}, make("summary", {},
      `${r.notes.length} note${r.notes.length > 1 ? "s" : ""}`),
    make("ul", {}, ...r.notes.map(n => make("li", {}, n)))));
  panel.findings.replaceChildren(...parts);
}

// --- actions ----------------------------------------------------------------

// Runs an action with its button as Stop, and shows progress and errors.
async function act(button, kind, words, action) {
  const label = button.textContent;

  if (button.dataset.busy) {
    stopLook(kind);
    return;
  }
  clearWrong();
  button.dataset.busy = "1";
  button.textContent = "Stop " + label.toLowerCase();
  panel.status.className = "about";
  panel.status.textContent = words + " …";
  try {
    await action((stage, share) => {
      panel.status.textContent = `${words}: ${stage || "starting"}` +
        (share === null ? "" : ` ${Math.round(100 * share)} %`);
    });
    panel.status.textContent = "";
  } catch (e) {
    panel.status.className = "message";
    panel.status.textContent = e.message;
    if (e.field) markWrong(e.field, e.message, e.line);
  }
  delete button.dataset.busy;
  button.textContent = label;
}

function tile(name, value, title) {
  return make("div", { title: title || "" }, make("dt", {}, name),
    make("dd", {}, value));
}

function renderForecast(r) {
  const best = r.best, files = Object.entries(r.files || {});
  const box = panel.forecast;

  box.hidden = false;
  box.classList.remove("stale");
  box.replaceChildren(make("h3", {}, "Forecast"), make("dl",
    { className: "figures" },
    tile("Cells", about(r.mesh.cells)),
    r.mesh.prisms > 0 ? tile("of them prisms", about(r.mesh.prisms)) : "",
    tile("Points", about(r.mesh.points)),
    tile("Memory", bytes(best.memory_bytes), "peak, of all ranks"),
    tile("Time", time(best.seconds), `${best.ranks} rank(s) with ` +
      `${best.threads} thread(s) each; rates of the reference machine`),
    tile("Subdomains", whole(r.tree.leaves)),
    files.length ? tile("Files", files.map(([k, v]) => `${k} ${bytes(v)}`)
      .join(", ")) : ""));
  const poor = ["limited", "unresolved", "inside_body", "outside_domain"]
    .filter(k => r.sources?.[k]?.length);
  for (const k of poor)
    box.append(make("p", { className: "note" },
      `Sources ${k.replace("_", " ")}: ${r.sources[k].length}`));
}

async function plan(tell) {
  const result = await look("plan", tell);
  renderForecast(result);
  return result;
}

// Changes `scale` until the forecast has the target number of cells. The number
// of cells follows a power of the scale, which is estimated again at each step.
async function fitScale(tell) {
  const target = Number(panel.target.value.replaceAll(/[ ,]/g, ""));
  const field = settings.elements["s.scale"];
  let power = -2.5, last = null;

  if (!(target > 0))
    throw new LookError("Enter the target number of cells, as in 5e6.");
  for (let k = 0; k < 7; k++) {
    const scale = Number(field.value || field.dataset.default);
    const cells = (await plan(tell)).mesh.cells;
    if (Math.abs(cells / target - 1) < 0.03) return;
    if (last && Math.abs(Math.log(scale / last.scale)) > 1e-6) {
      const slope = Math.log(cells / last.cells) /
                    Math.log(scale / last.scale);
      if (!(slope < -0.3))
        throw new LookError("The number of cells hardly follows the scale: " +
          "set the edge lengths of the surface, or let it be remeshed " +
          "(remesh_surface).", "s.remesh_surface");
      power = Math.max(slope, -4);
    }
    last = { scale, cells };
    field.value = Number((scale * Math.exp(Math.log(target / cells) / power))
      .toPrecision(3));
    field.dispatchEvent(new Event("input", { bubbles: true }));
  }
}

async function check(tell) {
  const result = await look("check", tell);
  await show(result, "Checked surface, as it will be meshed");
}

// --- layout -----------------------------------------------------------------

function toolButton(text, title, press) {
  const b = make("button", { type: "button", className: "small", title }, text);
  b.addEventListener("click", () => view && press());
  return b;
}

function buildTools() {
  const half = Math.PI / 2, from = (turn, lift) => () => {
    view.camera.look(turn, lift);
    view.draw();
  };
  panel.edges = make("input", { type: "checkbox", checked: true });
  panel.edges.addEventListener("change", () => {
    if (!view) return;
    view.shown.edges = panel.edges.checked;
    view.draw();
  });
  return make("div", { className: "tools" },
    toolButton("Reset", "Initial view (0)", () => {
      const { start } = view.camera;
      from(start.turn, start.lift)();
    }),
    toolButton("x", "Along x", from(Math.PI, 0)),
    toolButton("y", "Along y", from(-half, 0)),
    toolButton("z", "From above", from(-half, half - 1e-4)),
    make("label", {}, panel.edges, " edges"));
}

function buildTable() {
  const all = make("input", { type: "checkbox", ariaLabel: "Select all" });
  const head = make("tr", {}, make("th", {}, all),
    ...["No.", "Name", "Condition", "Layers", "Triangles", "Show"].map(t =>
      make("th", { scope: "col" }, t)));

  all.addEventListener("change", () => {
    chosen.clear();
    for (const row of panel.body.rows)
      if (all.checked && !row.hidden && !row.querySelector("input").disabled)
        chosen.add(Number(row.dataset.id));
    showChosen();
  });
  panel.body = make("tbody", {});
  panel.filter = make("input", { type: "search", hidden: true,
    placeholder: "Filter patches", ariaLabel: "Filter patches" });
  panel.filter.addEventListener("input", filterPatches);
  return make("div", { className: "patchlist" }, panel.filter,
    make("div", { className: "scroll" }, make("table",
      { className: "patches" }, make("thead", {}, head), panel.body)));
}

function buildTarget() {
  const scale = settings.elements["s.scale"].closest(".row");
  const fit = make("button", { type: "button", className: "small" },
    "Fit scale");

  panel.target = make("input", { id: "target", autocomplete: "off",
    className: "number", placeholder: "any" });
  panel.target.setAttribute("aria-describedby", "about.target");
  fit.addEventListener("click", () =>
    act(fit, "plan", "Fitting the scale", fitScale));
  scale.before(make("div", { className: "row" },
    make("label", { htmlFor: "target" }, "Target number of cells"),
    make("span", { className: "value" }, panel.target, fit),
    make("span", { className: "helpbox" }, make("span",
      { className: "help", id: "about.target" },
      "Sets the scale by forecasts until the mesh has about this many cells"))));
}

function buildActions() {
  const start = document.getElementById("start");
  const button = (text, kind, words, action) => {
    const b = make("button", { type: "button", id: text.toLowerCase() }, text);
    b.addEventListener("click", () => act(b, kind, words, action));
    return b;
  };
  panel.status = make("p", { className: "about", id: "status",
    role: "status" });
  panel.forecast = make("div", { id: "forecast", hidden: true, role: "status" });
  start.prepend(panel.forecast, panel.status,
    button("Check", "check", "Check", check),
    button("Plan", "plan", "Forecast", plan));
}

function build() {
  panel.box = make("div", { className: "viewbox empty" });
  panel.words = make("p", { className: "about" }, "Reading the surface …");
  panel.selection = make("div", { className: "selection" });
  panel.findings = make("div", { id: "findings" });
  geometry.append(make("div", { className: "viewhead" }, panel.words,
    buildTools()), panel.box, panel.selection, buildTable(), panel.findings);
  buildTarget();
  buildActions();
  // Changes of the settings make the forecast outdated.
  settings.addEventListener("input", e => {
    if (e.target.name) panel.forecast.classList.add("stale");
    if (["patches", "layers"].includes(e.target.name) && seen3d && !e.isTrusted)
      showChosen();
  });
}

async function open() {
  build();
  try {
    const result = await look("view", (stage, share) => {
      panel.words.textContent = `Reading the surface: ${stage || "starting"}` +
        (share === null ? "" : ` ${Math.round(100 * share)} %`);
    });
    await show(result, "Surface as in the file");
  } catch (e) {
    panel.words.textContent = "";
    geometry.classList.add("unreadable");
    panel.findings.replaceChildren(make("p", { className: "message",
      role: "alert" }, e.message));
    if (e.field) markWrong(e.field, e.message, e.line);
  }
}

if (geometry && settings) open();
