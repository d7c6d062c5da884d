// Functions of the page beyond plain forms: the list of runs is updated
// continuously, buttons work without loading a page, settings can be searched.
"use strict";

const seen = new Map();            // last markup of each run
const list = () => document.getElementById("list");

// Keep logs open or closed as the user left them.
function keepOpen(from, to) {
  for (const old of from.querySelectorAll("details[id]")) {
    const now = to.querySelector("#" + old.id);
    if (now && old.dataset.byHand) {
      now.open = old.open;
      now.dataset.byHand = "1";
    }
  }
}

function toEnd(run) {
  for (const log of run.querySelectorAll("pre")) log.scrollTop = log.scrollHeight;
}

// Replace changed runs only, so that a click on an unchanged one is not lost.
function show(markup) {
  const next = new DOMParser().parseFromString(markup, "text/html")
    .getElementById("list");
  let before = null;

  for (const run of next.querySelectorAll("article")) {
    const old = document.getElementById(run.id), markup = run.outerHTML;
    let now = old;

    if (!old || seen.get(run.id) !== markup) {
      seen.set(run.id, markup);
      now = document.importNode(run, true);
      if (old) {
        keepOpen(old, now);
        old.replaceWith(now);
      }
    }
    if (!before && list().firstElementChild !== now) list().prepend(now);
    if (before && before.nextElementSibling !== now) before.after(now);
    if (now !== old) toEnd(now);
    before = now;
  }
  if (before) for (const p of list().querySelectorAll(":scope > p")) p.remove();
  list().dataset.active = next.dataset.active;
}

let offline = null;
function tellOffline(is) {
  if (is && !offline) {
    offline = document.createElement("p");
    offline.className = "message offline";
    offline.textContent = "The portal does not respond; its runs continue.";
    document.body.append(offline);
  } else if (!is && offline) {
    offline.remove();
    offline = null;
  }
}

async function refresh() {
  try {
    const answer = await fetch("runs");
    if (!answer.ok) throw new Error(answer.status);
    show(await answer.text());
    tellOffline(false);
  } catch (e) {
    tellOffline(true);
  }
}

let timer = 0;
async function again() {
  clearTimeout(timer);
  if (!document.hidden) await refresh();
  timer = setTimeout(again, Number(list().dataset.active) ? 1000 : 4000);
}

document.getElementById("runs").addEventListener("submit", async (e) => {
  e.preventDefault();
  e.submitter.disabled = true;
  try {
    await fetch(e.target.action, { method: "POST", redirect: "manual" });
  } finally {
    again();
  }
});
document.addEventListener("click", (e) => {
  const log = e.target.closest("summary")?.parentElement;
  if (log?.id) log.dataset.byHand = "1";
});
document.addEventListener("visibilitychange", again);

// --- the form ---------------------------------------------------------------

const form = document.getElementById("settings");

function mark(row) {
  const control = row.querySelector("[data-default]");
  row.classList.toggle("changed", control.value !== "" &&
                       control.value !== control.dataset.default);
}

function count(group) {
  const n = group.querySelectorAll(".changed").length;
  let told = group.querySelector("summary span");

  if (!told) {
    told = document.createElement("span");
    group.querySelector("summary").append(" ", told);
  }
  told.textContent = n ? n + " changed" : "";
}

function search(text) {
  for (const group of form.querySelectorAll(".group")) {
    let n = 0;
    for (const row of group.querySelectorAll(".row")) {
      const hit = row.textContent.toLowerCase().includes(text);
      row.hidden = !hit;
      row.style.display = hit ? "" : "none";
      n += hit;
    }
    group.style.display = text && !n ? "none" : "";
    if (text) group.open = n > 0;
  }
}

if (form) {
  const field = document.createElement("input");

  field.type = "search";
  field.placeholder = "Search settings";
  field.setAttribute("aria-label", "Search settings");
  field.addEventListener("input", () =>
    search(field.value.trim().toLowerCase()));
  form.querySelector(".title").append(field);
  for (const group of form.querySelectorAll(".group")) count(group);
  form.addEventListener("input", (e) => {
    const row = e.target.closest(".row");
    if (row) {
      mark(row);
      count(row.closest(".group"));
    }
  });
  // The Enter key in a field does not submit the form.
  form.addEventListener("keydown", (e) => {
    if (e.key === "Enter" && e.target.tagName === "INPUT") e.preventDefault();
  });
}

again();
