/* SPDX-License-Identifier: LGPL-3.0-or-later */
// The form of a run: search, marks of changed and wrong settings, and editors
// for tables. The tables stay text areas for the server, which reads them as in
// a deck; an editor rewrites the text on each change.

export const settings = document.getElementById("settings");

export function make(tag, props, ...children) {
  const e = document.createElement(tag);
  for (const [name, value] of Object.entries(props || {})) {
    if (name in e && name !== "list" && name !== "form") e[name] = value;
    else e.setAttribute(name, value);
  }
  e.append(...children);
  return e;
}

// --- marks ------------------------------------------------------------------

function markChanged(row) {
  const control = row.querySelector("[data-default]");
  row.classList.toggle("changed", control.value !== "" &&
                       control.value !== control.dataset.default);
}

function countChanged(group) {
  const head = group.querySelector("summary, legend");
  const n = group.querySelectorAll(".changed").length;
  let told = head.querySelector("span");

  if (!told) {
    told = document.createElement("span");
    head.append(" ", told);
  }
  told.textContent = n ? n + " changed" : "";
}

// Removes the marks of the last error.
export function clearWrong() {
  for (const e of settings.querySelectorAll("p.wrong")) e.remove();
  document.querySelector("#form > .message")?.remove();
  for (const e of settings.querySelectorAll(".bad"))
    if (e.tagName !== "BUTTON") e.classList.remove("bad");
  for (const e of settings.querySelectorAll("[aria-invalid]")) {
    e.removeAttribute("aria-invalid");
    delete e.dataset.wrong;
  }
}

// Marks a field, shows the message there and moves the focus to it. Returns
// false if the form has no such field. line: of a table, from 1 with its head.
export function markWrong(field, message, line) {
  const control = field && settings.querySelector(
    `[name="${CSS.escape(field)}"]`);

  clearWrong();
  if (!control) return false;
  const row = control.closest(".row") || control.closest("label") ||
              control.closest(".group") || control.parentElement;
  control.setAttribute("aria-invalid", "true");
  row.classList.add("bad");
  for (let e = control; e; e = e.parentElement)
    if (e.tagName === "DETAILS") e.open = true;
  showAll();
  row.append(make("p", { className: "wrong", id: "wrong", role: "alert" },
    message));
  if (control.editor) control.editor.mark(line);
  row.scrollIntoView({ block: "center" });
  (control.editor ? control.editor.first(line) : control).focus();
  return true;
}

// --- search -----------------------------------------------------------------

const searched = { open: new Map(), field: null };

function matches(text, words) {
  const lower = text.toLowerCase();
  return words.every(w => lower.includes(w));
}

// Shows the settings that contain all words. A group whose title matches is
// shown as a whole.
function search(text) {
  const words = text.trim().toLowerCase().split(/\s+/).filter(w => w);
  let found = 0;

  for (const group of settings.querySelectorAll(".group")) {
    const title = group.querySelector("summary, legend").textContent;
    const whole = matches(title, words);
    let n = 0;

    for (const row of group.querySelectorAll(".row")) {
      const control = row.querySelector("[name]");
      const hit = whole || matches(row.textContent + " " + title + " " +
                                   (control ? control.name : ""), words);
      row.hidden = !hit;
      n += hit;
    }
    if (group.querySelector("textarea"))
      n += whole || matches(group.textContent, words);
    if (group.tagName === "DETAILS") {
      if (!searched.open.has(group)) searched.open.set(group, group.open);
      group.open = words.length ? n > 0 : searched.open.get(group);
    }
    group.hidden = words.length > 0 && !n;
    found += n;
  }
  if (!words.length) searched.open.clear();
  else document.getElementById("all").open = true;
  searched.said.textContent = words.length ? found + " found" : "";
}

function showAll() {
  if (!searched.field || !searched.field.value) return;
  searched.field.value = "";
  search("");
}

function addSearch() {
  const field = make("input", { type: "search",
    placeholder: "Search all settings",
    ariaLabel: "Search all settings" });

  searched.field = field;
  searched.said = make("span", { className: "about", role: "status" });
  field.addEventListener("input", () => search(field.value));
  settings.querySelector(".title").after(
    make("p", { className: "search" }, field, searched.said));
}

// --- tables -----------------------------------------------------------------

// Splits a line of a table as the deck does; throws if a quote is not closed.
function splitLine(line) {
  const words = [];
  let at = 0;

  for (;;) {
    while (line[at] === " " || line[at] === "\t") at++;
    if (at >= line.length || line[at] === "#") return words;
    let word = "", quoted = line[at] === '"';
    if (quoted) {
      for (at++;; at++) {
        if (at >= line.length) throw new Error("a quotation mark is not closed");
        if (line[at] !== '"') word += line[at];
        else if (line[at + 1] === '"') word += line[at++];
        else break;
      }
      at++;
    } else {
      while (at < line.length && !" \t#".includes(line[at])) word += line[at++];
      if (word === "-") word = "";
    }
    words.push(quoted && word === "" ? '""' : word);
  }
}

// The rows of a table, as objects by column.
function parseRows(text) {
  const lines = text.split("\n").map(l => splitLine(l.replace("\r", "")))
    .filter(w => w.length);
  const names = lines.shift() || [];

  return lines.map(words => {
    if (words.length !== names.length)
      throw new Error(`${words.length} values for ${names.length} columns`);
    return Object.fromEntries(names.map((n, i) => [n, words[i]]));
  });
}

function quote(value) {
  if (value === undefined || value === "") return "-";
  if (value === '""') return value;
  return /[\s#"]/.test(value) || value === "-"
    ? '"' + value.replaceAll('"', '""') + '"' : value;
}

function printRows(rows, columns) {
  const kept = rows.filter(r => Object.values(r).some(v => v));
  const used = columns.map(c => c.name).filter(n => kept.some(r => r[n]));
  const cells = [used, ...kept.map(r => used.map(n => quote(r[n])))];

  if (!kept.length) return "";
  const width = used.map((n, i) => Math.max(...cells.map(r => r[i].length)));
  return cells.map(r => r.map((v, i) => v.padEnd(width[i])).join("  ")
    .trimEnd()).join("\n") + "\n";
}

// Columns that are always shown, and those that a kind of source needs.
const basic = {
  sources: ["kind", "x0", "y0", "z0", "h0", "r0"],
  layers: ["id", "grow", "first", "y_plus", "ratio", "count"],
  surface: ["patch", "adjacent", "size"],
  patches: ["id", "bc", "name"],
};
const needed = {
  line: ["x1", "y1", "z1", "h1", "r1"],
  vgrid_line: ["x1", "y1", "z1", "h1"],
  triangle: ["x1", "y1", "z1", "x2", "y2", "z2"],
  box: ["x1", "y1", "z1"],
  cylinder: ["x1", "y1", "z1", "h1", "r1"],
};

class TableEditor {
  constructor(area) {
    this.area = area;
    this.columns = JSON.parse(area.dataset.columns);
    this.shown = new Set(basic[area.id] || []);
    this.box = make("div", { className: "editor" });
    area.after(this.box);
    area.closest(".group").querySelector(".columns").hidden = true;
    area.editor = this;
    this.read();
  }

  // Takes the rows from the text area; if that has an error, the text stays.
  read() {
    try {
      this.rows = parseRows(this.area.value);
      for (const r of this.rows)
        for (const name of Object.keys(r)) if (r[name]) this.shown.add(name);
      this.problem = "";
    } catch (e) {
      this.rows = null;
      this.problem = e.message;
    }
    this.render();
  }

  write() {
    this.area.value = printRows(this.rows, this.columns);
    this.area.dispatchEvent(new Event("input", { bubbles: true }));
  }

  control(row, column) {
    const label = `${column.name}, row ${this.rows.indexOf(row) + 1}`;
    const field = column.words.length
      ? make("select", {}, make("option", { value: "" }, "–"),
        ...column.words.map(w => make("option", { value: w }, w)))
      : make("input", { autocomplete: "off", spellcheck: false });

    field.ariaLabel = label;
    field.title = column.help + (column.unit ? ` [${column.unit}]` : "");
    field.value = row[column.name] === '""' ? "" : row[column.name] || "";
    if (column.words.length && row[column.name] && !field.value) {
      field.append(make("option", { value: row[column.name] },
        row[column.name]));
      field.value = row[column.name];
    }
    field.addEventListener("change", () => {
      row[column.name] = field.value.trim();
      if (column.name === "kind") {
        for (const n of needed[field.value] || []) this.shown.add(n);
        this.render();
      }
      this.write();
    });
    return field;
  }

  line(row, columns) {
    const remove = make("button", { type: "button", className: "small",
      ariaLabel: `Remove row ${this.rows.indexOf(row) + 1}` }, "×");
    remove.addEventListener("click", () => {
      this.rows.splice(this.rows.indexOf(row), 1);
      this.render();
      this.write();
    });
    return make("tr", {}, ...columns.map(c =>
      make("td", {}, this.control(row, c))), make("td", {}, remove));
  }

  buttons(hidden) {
    const add = make("button", { type: "button", className: "small" },
      "Add row");
    const more = make("select", { ariaLabel: "Add a column" },
      make("option", { value: "" }, "Add a column …"),
      ...hidden.map(c => make("option", { value: c.name, title: c.help },
        `${c.name} – ${c.help}`)));
    const text = make("button", { type: "button", className: "small" },
      this.area.hidden ? "Edit as text" : "Edit as table");

    add.addEventListener("click", () => {
      this.rows.push({});
      this.render();
      this.first(this.rows.length + 1).focus();
    });
    more.addEventListener("change", () => {
      this.shown.add(more.value);
      this.render();
    });
    text.addEventListener("click", () => {
      this.area.hidden = !this.area.hidden;
      if (this.area.hidden) this.read();
      else this.render();
    });
    if (!this.rows || !this.area.hidden) return make("p", { className: "tools" },
      text);
    return make("p", { className: "tools" }, add, hidden.length ? more : "",
      text);
  }

  render() {
    const columns = this.columns.filter(c => c.required ||
                                             this.shown.has(c.name));
    const hidden = this.columns.filter(c => !columns.includes(c));
    const parts = [];

    if (!this.rendered) this.area.hidden = true;
    this.rendered = true;
    if (!this.rows) {
      this.area.hidden = false;
      parts.push(make("p", { className: "wrong" }, this.problem));
    } else if (this.area.hidden && this.rows.length) {
      const head = make("tr", {}, ...columns.map(c => make("th", {
        scope: "col", title: c.help }, c.name,
      c.unit ? make("i", {}, ` ${c.unit}`) : "")), make("th", {}));
      parts.push(make("div", { className: "scroll" }, make("table", {},
        make("thead", {}, head), make("tbody", {},
          ...this.rows.map(r => this.line(r, columns))))));
    }
    this.box.replaceChildren(...parts, this.buttons(hidden));
  }

  // The line of the table at which an error is.
  mark(line) {
    const rows = this.box.querySelectorAll("tbody tr");
    if (line > 1 && rows[line - 2]) rows[line - 2].classList.add("bad");
  }

  first(line) {
    const row = this.box.querySelectorAll("tbody tr")[line - 2];
    return (row || this.box).querySelector("input, select, button") ||
           this.area;
  }
}

// --- formats ----------------------------------------------------------------

// Buttons that add formats to the list or remove them.
const formats = ["b8.ugrid", "cgns", "su2", "openfoam", "cogsg", "vtu",
  "fluent.msh", "meshb"];

function addFormats(field) {
  const box = make("span", { className: "chips", role: "group",
    ariaLabel: "File formats" });
  const list = () => field.value.split(",").map(w => w.trim())
    .filter(w => w && w !== "auto");
  const update = () => {
    for (const b of box.children)
      b.ariaPressed = String(list().includes(b.textContent));
  };

  for (const format of formats) {
    const b = make("button", { type: "button", className: "chip" }, format);
    b.addEventListener("click", () => {
      const now = list();
      field.value = (now.includes(format) ? now.filter(f => f !== format)
        : [...now, format]).join(",") || "auto";
      field.dispatchEvent(new Event("input", { bubbles: true }));
      update();
    });
    box.append(b);
  }
  field.addEventListener("input", update);
  field.closest(".row").append(box);
  update();
}

// --- main -------------------------------------------------------------------

if (settings) {
  addSearch();
  for (const group of settings.querySelectorAll(".group")) countChanged(group);
  for (const area of settings.querySelectorAll("textarea.table")) {
    const line = Number(area.dataset.wrong || 0);
    new TableEditor(area).mark(line);
  }
  addFormats(settings.elements["s.write"]);
  document.getElementById("all").open = Boolean(
    document.querySelector("#all [aria-invalid]"));
  settings.addEventListener("input", e => {
    const row = e.target.closest(".row");
    if (row && row.querySelector("[data-default]")) {
      markChanged(row);
      countChanged(row.closest(".group"));
    }
  });
  // The Enter key in a field does not submit the form.
  settings.addEventListener("keydown", e => {
    if (e.key === "Enter" && e.target.tagName === "INPUT") e.preventDefault();
  });
  document.getElementById("wrong")?.scrollIntoView({ block: "center" });
}
