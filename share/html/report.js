/* SPDX-License-Identifier: LGPL-3.0-or-later */
// The 3-D view of PROJECT.report.html, drawn by view.js. Its data are in the
// page: #facts (JSON) and #scene (zlib, base64), written by
// src/cli/html/html_scene.c. If the browser lacks a feature, the page stays
// unchanged.
(async function () {
  'use strict';
  const say = document.getElementById('say');
  const box = document.getElementById('view');
  const canvas = document.getElementById('canvas');
  const controls = document.getElementById('controls');
  const facts = JSON.parse(document.getElementById('facts').textContent);
  const GREY = 255, LEVEL = 0, SHARE = 1, CAUSE = 2;

  function palettes() {
    const half = facts.causeColours.map(c => c.map(v => (v + 245) / 2));
    const grey = [231, 231, 239];
    const pick = (list, k) => k === GREY ? grey : list[k] || grey;
    return {
      level: k => pick(facts.levelColours, k),
      share: k => pick(facts.levelColours, k),
      cause: k => pick(facts.causeColours.concat(half), k),
    };
  }

  function recolour(view, by) {
    const palette = palettes()[by];
    const bytes = view.scene.by[{ level: LEVEL, share: SHARE, cause: CAUSE }[by]];

    view.colour(by === 'patch' ? i => facts.patches[i].colour
                               : (i, t) => palette(bytes[t]));
  }

  // --- controls -----------------------------------------------------------

  function group(name, kind) {
    const box = document.createElement('fieldset');
    const legend = document.createElement('legend');
    legend.textContent = name;
    box.append(legend);
    if (kind) box.className = kind;
    controls.append(box);
    return box;
  }

  function choice(box, type, text, checked, change, colour) {
    const label = document.createElement('label');
    const input = document.createElement('input');
    input.type = type;
    input.checked = checked;
    if (type === 'radio') input.name = box.firstChild.textContent;
    input.addEventListener('change', () => change(input.checked));
    label.append(input);
    if (colour) {
      const key = document.createElement('span');
      key.className = 'key';
      const square = document.createElement('i');
      square.style.background = `rgb(${colour})`;
      key.append(square);
      label.append(key);
    }
    label.append(text);
    box.append(label);
  }

  function button(box, text, press) {
    const b = document.createElement('button');
    b.type = 'button';
    b.textContent = text;
    b.addEventListener('click', press);
    box.append(b);
  }

  // The sections that the check boxes have switched on.
  function planes(on) {
    return facts.cuts.filter((c, i) => on[i]).map(c => {
      const a = c.axis === 0 ? 1 : 0, b = c.axis === 2 ? 1 : 2;
      const o = [0, 0, 0], u = [0, 0, 0], v = [0, 0, 0];
      o[c.axis] = c.at;
      o[a] = c.centre[0];
      o[b] = c.centre[1];
      u[a] = c.half[0];
      v[b] = c.half[1];
      return { o, u, v, image: document.getElementById('cut' + c.picture) };
    });
  }

  function whatToShow(view) {
    const what = group('Show'), cut = facts.cuts.map(() => false);
    choice(what, 'checkbox', 'edges', view.shown.edges, on => {
      view.shown.edges = on;
      view.draw();
    });
    facts.cuts.forEach((c, i) =>
      choice(what, 'checkbox', 'cut normal to ' + 'xyz'[c.axis], false, on => {
        cut[i] = on;
        view.shown.planes = planes(cut);
        view.draw();
      }));
    if (facts.worst.length)
      choice(what, 'checkbox', 'worst cells', false, on =>
        view.mark(on ? facts.worst : []));
  }

  function build(view) {
    const by = group('Colour by');
    const names = { patch: 'patch', level: 'number of layers',
      share: 'height / growth-law height', cause: 'cause' };
    for (const k of facts.layers ? Object.keys(names) : ['patch'])
      choice(by, 'radio', names[k], k === 'patch', () => recolour(view, k));
    whatToShow(view);
    const look = group('View'), { start } = view.camera;
    const from = (turn, lift) => () => {
      view.camera.look(turn, lift);
      view.draw();
    };
    const half = Math.PI / 2;
    button(look, 'reset', from(start.turn, start.lift));
    button(look, 'along x', from(Math.PI, 0));
    button(look, 'along y', from(start.turn > 0 ? half : -half, 0));
    button(look, 'from above (-z)', from(-half, half - 1e-4));
    const patches = group('Patches', 'patches');
    facts.patches.forEach((p, i) =>
      choice(patches, 'checkbox', p.name, view.shown.patch[i], on => {
        view.shown.patch[i] = on;
        view.draw();
      }, p.colour));
  }

  // --- main ---------------------------------------------------------------

  try {
    const packed = Uint8Array.from(
      atob(document.getElementById('scene').textContent), c => c.charCodeAt(0));
    const data = await unpackScene(packed);
    box.hidden = false;
    const view = createView(canvas, facts, data);
    view.onPaint = () => {
      if (!box.dataset.drawn) box.dataset.drawn = view.drawn(); // for tests
    };
    build(view);
    recolour(view, 'patch');
    say.textContent = 'Drag to rotate, shift-drag to pan, use the wheel or ' +
      'two fingers to zoom.';
  } catch (e) {
    box.hidden = true;
    say.textContent = 'WebGL is not available in this browser (' +
      e.message.split('\n')[0] + '); the pictures below show the surface.';
  }
})();
