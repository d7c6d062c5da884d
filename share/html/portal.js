/* SPDX-License-Identifier: LGPL-3.0-or-later */
// Functions of the list of runs beyond plain forms: it is updated continuously,
// and buttons work without loading a page.
"use strict";

const seen = new Map();            // last markup of each run
const list = () => document.getElementById("list");

// Keep logs and lists of files open or closed as the user left them, and runs
// selected for a comparison.
function keepState(from, to) {
  for (const old of from.querySelectorAll("details[id]")) {
    const now = to.querySelector("#" + old.id);
    if (now && old.dataset.byHand) {
      now.open = old.open;
      now.dataset.byHand = "1";
    }
  }
  const picked = from.querySelector(".pick input"),
        pick = to.querySelector(".pick input");
  if (picked && pick) pick.checked = picked.checked;
}

// A selector of the focused control, so that the focus stays when its run is
// replaced.
function focusOf(run) {
  const e = document.activeElement;

  if (!e || !run.contains(e)) return null;
  const action = e.closest("form")?.getAttribute("action");
  if (action) return `form[action="${action}"] button`;
  if (e.tagName === "A") return `a[href="${e.getAttribute("href")}"]`;
  if (e.tagName === "SUMMARY") return `#${e.parentElement.id} > summary`;
  return null;
}

function toEnd(run) {
  for (const log of run.querySelectorAll("pre")) log.scrollTop = log.scrollHeight;
}

function replace(old, now) {
  const focus = focusOf(old);

  keepState(old, now);
  old.replaceWith(now);
  if (focus) (now.querySelector(focus) ||
              now.querySelector(".buttons button, .buttons a"))?.focus();
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
      if (old) replace(old, now);
    }
    if (!before && list().firstElementChild !== now) list().prepend(now);
    if (before && before.nextElementSibling !== now) before.after(now);
    if (now !== old) toEnd(now);
    before = now;
  }
  for (const run of list().querySelectorAll("article"))
    if (!next.querySelector("#" + run.id)) {
      seen.delete(run.id);
      run.remove();
    }
  for (const p of list().querySelectorAll(":scope > p")) p.remove();
  list().append(...next.querySelectorAll(":scope > p"));
  list().dataset.active = next.dataset.active;
}

let offline = null;
function tellOffline(is) {
  if (is && !offline) {
    offline = document.createElement("p");
    offline.className = "message offline";
    offline.setAttribute("role", "alert");
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

// Stop, resume and delete without loading a page; the reason of a refusal is
// shown at the run.
async function send(e) {
  if (e.target.method !== "post") return;
  e.preventDefault();
  e.submitter.disabled = true;
  try {
    const answer = await fetch(e.target.action, { method: "POST",
      redirect: "manual" });
    if (answer.status >= 400) {
      const note = document.createElement("p");
      note.className = "message";
      note.textContent = await answer.text();
      e.target.after(note);
    }
  } finally {
    again();
  }
}

if (list()) {
  for (const run of list().querySelectorAll("article")) {
    seen.set(run.id, run.outerHTML);
    toEnd(run);
  }
  document.getElementById("runs").addEventListener("submit", send);
  document.addEventListener("click", e => {
    const part = e.target.closest("summary")?.parentElement;
    if (part?.id) part.dataset.byHand = "1";
  });
  document.addEventListener("visibilitychange", again);
  again();
}

// An upload shows that it is going on.
document.querySelector("form.upload")?.addEventListener("submit", e => {
  const button = e.target.querySelector("button");
  button.textContent = "Uploading …";
  button.setAttribute("aria-busy", "true");
});
