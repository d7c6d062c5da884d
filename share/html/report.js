// The 3-D view of PROJECT.report.html. Its data are in the page: #facts (JSON)
// and #scene (zlib, base64), written by src/cli/html/html_scene.c. If the
// browser lacks a feature, the page stays unchanged.
(async function () {
  'use strict';
  const say = document.getElementById('say');
  const view = document.getElementById('view');
  const canvas = document.getElementById('canvas');
  const controls = document.getElementById('controls');
  const facts = JSON.parse(document.getElementById('facts').textContent);
  const GREY = 255;

  // --- data ---------------------------------------------------------------

  async function unpack(text) {
    const raw = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    const stream = new Blob([raw]).stream()
      .pipeThrough(new DecompressionStream('deflate'));
    return new DataView(await new Response(stream).arrayBuffer());
  }

  // For each corner of each triangle: position, and the barycentric coordinates
  // by which edges are drawn.
  function expand(data) {
    const n = facts.triangles, from = 12 * facts.points;
    const place = new Float32Array(9 * n), side = new Uint8Array(9 * n);
    let last = 0;
    for (let i = 0; i < 3 * n; i++) {
      last = (last + data.getUint32(from + 4 * i, true)) >>> 0;
      for (let k = 0; k < 3; k++)
        place[3 * i + k] = data.getFloat32(12 * last + 4 * k, true);
      side[3 * i + i % 3] = 255;
    }
    const bytes = from + 12 * n;
    const part = k => new Uint8Array(data.buffer, bytes + k * n, n);
    return { place, side, level: part(0), share: part(1), cause: part(2) };
  }

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

  function colours(scene, by) {
    const n = facts.triangles, out = new Uint8Array(9 * n);
    const palette = palettes();
    const put = (t, c) => {
      for (let i = 0; i < 9; i++) out[9 * t + i] = c[i % 3];
    };
    if (by === 'patch')
      for (const p of facts.patches)
        for (let t = p.first; t < p.first + p.count; t++) put(t, p.colour);
    else
      for (let t = 0; t < n; t++) put(t, palette[by](scene[by][t]));
    return out;
  }

  // --- vectors and matrices (column-major) --------------------------------

  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = a => a.map(v => v / (Math.hypot(...a) || 1));

  const start = { turn: Math.atan2(facts.toward[1], facts.toward[0]),
    lift: Math.asin(unit(facts.toward)[2]), zoom: 1, at: [0, 0, 0] };
  const eye = { ...start };

  function frame() {
    const toward = [Math.cos(eye.lift) * Math.cos(eye.turn),
      Math.cos(eye.lift) * Math.sin(eye.turn), Math.sin(eye.lift)];
    const right = [-Math.sin(eye.turn), Math.cos(eye.turn), 0];
    return { toward, right, up: cross(toward, right) };
  }

  // Zoom so that the bounding box of the body just fits.
  function fit() {
    const f = frame(), aspect = canvas.clientWidth / canvas.clientHeight;
    const extent = v => v.reduce((sum, x, k) =>
      sum + Math.abs(x) * facts.half[k], 0);
    const size = Math.max(extent(f.right) / Math.max(aspect, 1),
      extent(f.up) * Math.min(aspect, 1));
    eye.zoom = 0.92 * facts.radius / (size || facts.radius);
  }

  // Orthographic projection, with a depth range far beyond the body.
  function matrix(width, height) {
    const f = frame(), aspect = width / height;
    const s = eye.zoom / (1.02 * facts.radius);
    const sx = aspect > 1 ? s / aspect : s, sy = aspect > 1 ? s : s * aspect;
    const sz = 1 / (60 * facts.radius);
    const rows = [[f.right, sx], [f.up, sy], [f.toward, -sz]];
    const m = new Array(16).fill(0);
    rows.forEach(([v, scale], r) => {
      for (let c = 0; c < 3; c++) m[4 * c + r] = v[c] * scale;
      m[12 + r] = -dot(v, eye.at) * scale;
    });
    m[15] = 1;
    return { m, f };
  }

  // --- drawing ------------------------------------------------------------

  const surfaceVertex = `
    precision highp float;
    attribute vec3 place, colour, side;
    uniform mat4 m;
    varying vec3 p, c, s;
    void main() {
      p = place; c = colour / 255.0; s = side / 255.0;
      gl_Position = m * vec4(place, 1.0);
    }`;
  const surfaceFragment = `
    #extension GL_OES_standard_derivatives : enable
    precision highp float;
    varying vec3 p, c, s;
    uniform vec3 toward, up;
    uniform float edges;
    void main() {
      vec3 n = normalize(cross(dFdx(p), dFdy(p)));
      float front = abs(dot(n, toward));
      float light = min(0.5 + 0.44 * front + 0.14 * abs(dot(n, up)), 1.0);
      vec3 width = fwidth(s);
      vec3 near = smoothstep(vec3(0.0), width * 1.1, s);
      float line = 1.0 - min(near.x, min(near.y, near.z));
      float small = max(width.x, max(width.y, width.z));
      line *= edges * (1.0 - smoothstep(0.12, 0.4, small));
      gl_FragColor = vec4(c * light * (1.0 - 0.6 * line), 1.0);
    }`;

  function surfaceOf(regl, buffers) {
    return regl({
      vert: surfaceVertex, frag: surfaceFragment,
      attributes: buffers,
      uniforms: { m: regl.prop('m'), toward: regl.prop('f.toward'),
        up: regl.prop('f.up'), edges: regl.prop('edges') },
      // Normals point into the fluid, so that a body shows its outside, and an
      // outer boundary only its far side.
      cull: { enable: true, face: 'back' },
      offset: regl.prop('offset'), count: regl.prop('count'),
    });
  }

  function planeOf(regl) {
    return regl({
      vert: `precision highp float; attribute vec2 at; uniform mat4 m;
        uniform vec3 o, u, v; varying vec2 t;
        void main() { t = vec2(at.x, 1.0 - at.y) ;
          gl_Position = m * vec4(o + (2.0 * at.x - 1.0) * u +
                                 (2.0 * at.y - 1.0) * v, 1.0); }`,
      frag: `precision highp float; uniform sampler2D picture; varying vec2 t;
        void main() { vec4 c = texture2D(picture, t);
          if (c.a < 0.5) discard; gl_FragColor = vec4(c.rgb, 1.0); }`,
      attributes: { at: [[0, 0], [1, 0], [0, 1], [1, 1]] },
      uniforms: { m: regl.prop('m'), o: regl.prop('o'), u: regl.prop('u'),
        v: regl.prop('v'), picture: regl.prop('picture') },
      primitive: 'triangle strip', count: 4,
    });
  }

  function marksOf(regl) {
    return regl({
      vert: `precision highp float; attribute vec3 place; uniform mat4 m;
        void main() { gl_Position = m * vec4(place, 1.0);
          gl_PointSize = 13.0; }`,
      frag: `precision highp float;
        void main() { float r = length(gl_PointCoord - 0.5);
          if (r > 0.5) discard;
          gl_FragColor = vec4(r > 0.38 ? vec3(1.0) : vec3(0.75, 0.1, 0.1),
                              1.0); }`,
      attributes: { place: facts.worst }, uniforms: { m: regl.prop('m') },
      depth: { enable: false }, primitive: 'points',
      count: facts.worst.length,
    });
  }

  // --- controls -----------------------------------------------------------

  const shown = { by: 'patch', edges: !facts.merged, worst: false,
    cut: facts.cuts.map(() => false), patch: facts.patches.map(p => p.body) };

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

  function build(recolour, draw) {
    const by = group('Colour by');
    const names = { patch: 'patch', level: 'number of layers',
      share: 'height / growth-law height', cause: 'cause' };
    for (const k of facts.layers ? Object.keys(names) : ['patch'])
      choice(by, 'radio', names[k], k === 'patch', () => {
        shown.by = k;
        recolour();
      });
    const what = group('Show');
    choice(what, 'checkbox', 'edges', shown.edges, on => {
      shown.edges = on;
      draw();
    });
    facts.cuts.forEach((c, i) =>
      choice(what, 'checkbox', 'cut normal to ' + 'xyz'[c.axis], false, on => {
        shown.cut[i] = on;
        draw();
      }));
    if (facts.worst.length)
      choice(what, 'checkbox', 'worst cells', false, on => {
        shown.worst = on;
        draw();
      });
    const look = group('View');
    const from = (turn, lift) => () => {
      Object.assign(eye, start, { turn, lift });
      fit();
      draw();
    };
    const half = Math.PI / 2;
    button(look, 'reset', from(start.turn, start.lift));
    button(look, 'along x', from(Math.PI, 0));
    button(look, 'along y', from(start.turn > 0 ? half : -half, 0));
    button(look, 'from above (-z)', from(-half, half - 1e-4));
    const patches = group('Patches', 'patches');
    facts.patches.forEach((p, i) =>
      choice(patches, 'checkbox', p.name, shown.patch[i], on => {
        shown.patch[i] = on;
        draw();
      }, p.colour));
  }

  function move(dx, dy) {
    const f = frame(), size = canvas.clientHeight * eye.zoom / 2;
    const scale = 1.02 * facts.radius / size;
    for (let k = 0; k < 3; k++)
      eye.at[k] -= (dx * f.right[k] - dy * f.up[k]) * scale;
  }

  function turn(dx, dy) {
    eye.turn -= dx * 0.007;
    eye.lift = Math.max(-1.57, Math.min(1.57, eye.lift + dy * 0.007));
  }

  function listen(draw) {
    const fingers = new Map();
    canvas.addEventListener('pointerdown', e => {
      fingers.set(e.pointerId, [e.clientX, e.clientY]);
      canvas.setPointerCapture(e.pointerId);
    });
    const leave = e => fingers.delete(e.pointerId);
    canvas.addEventListener('pointerup', leave);
    canvas.addEventListener('pointercancel', leave);
    canvas.addEventListener('pointermove', e => {
      const old = fingers.get(e.pointerId);
      if (!old) return;
      const dx = e.clientX - old[0], dy = e.clientY - old[1];
      const others = [...fingers].filter(([id]) => id !== e.pointerId);
      if (others.length === 1) {
        const [x, y] = others[0][1];
        eye.zoom *= Math.hypot(e.clientX - x, e.clientY - y) /
                    (Math.hypot(old[0] - x, old[1] - y) || 1);
        move(dx / 2, dy / 2);
      } else if (e.shiftKey || e.buttons & 6) {
        move(dx, dy);
      } else {
        turn(dx, dy);
      }
      fingers.set(e.pointerId, [e.clientX, e.clientY]);
      draw();
    });
    canvas.addEventListener('contextmenu', e => e.preventDefault());
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      const k = Math.exp(-e.deltaY * (e.deltaMode ? 0.05 : 0.0015));
      const box = canvas.getBoundingClientRect();
      const x = e.clientX - box.left - box.width / 2;
      const y = e.clientY - box.top - box.height / 2;
      move(-x, -y);
      eye.zoom *= k;
      move(x, y);
      draw();
    }, { passive: false });
    canvas.addEventListener('keydown', e => {
      const step = { ArrowLeft: [-30, 0], ArrowRight: [30, 0],
        ArrowUp: [0, -30], ArrowDown: [0, 30] }[e.key];
      if (step) (e.shiftKey ? move : turn)(...step);
      else if (e.key === '+' || e.key === '=') eye.zoom *= 1.25;
      else if (e.key === '-') eye.zoom /= 1.25;
      else return;
      e.preventDefault();
      draw();
    });
  }

  // --- main ---------------------------------------------------------------

  // Number of pixels drawn, for tests.
  function count(regl) {
    const pixels = regl.read();
    let n = 0;
    for (let i = 3; i < pixels.length; i += 4) n += pixels[i] > 0;
    view.dataset.drawn = n;
  }

  async function run() {
    const scene = expand(await unpack(
      document.getElementById('scene').textContent));
    view.hidden = false;
    const regl = createREGL({ canvas, extensions: ['OES_standard_derivatives'],
      attributes: { alpha: true, antialias: true,
        preserveDrawingBuffer: true } });
    const colour = regl.buffer({ data: colours(scene, shown.by),
      usage: 'dynamic' });
    const surface = surfaceOf(regl, {
      place: regl.buffer(scene.place),
      side: { buffer: regl.buffer(scene.side), type: 'uint8' },
      colour: { buffer: colour, type: 'uint8' },
    });
    const plane = planeOf(regl), marks = facts.worst.length && marksOf(regl);
    const pictures = [];
    let waiting = false;

    function pictureOf(i) {
      if (!pictures[i])
        pictures[i] = regl.texture({
          data: document.getElementById('cut' + facts.cuts[i].picture),
          mag: 'linear', min: 'linear' });
      return pictures[i];
    }

    function planes(m) {
      facts.cuts.forEach((c, i) => {
        if (!shown.cut[i]) return;
        const a = c.axis === 0 ? 1 : 0, b = c.axis === 2 ? 1 : 2;
        const o = [0, 0, 0], u = [0, 0, 0], v = [0, 0, 0];
        o[c.axis] = c.at;
        o[a] = c.centre[0];
        o[b] = c.centre[1];
        u[a] = c.half[0];
        v[b] = c.half[1];
        plane({ m, o, u, v, picture: pictureOf(i) });
      });
    }

    function paint() {
      waiting = false;
      const scale = Math.min(window.devicePixelRatio || 1, 2);
      canvas.width = Math.max(1, Math.round(canvas.clientWidth * scale));
      canvas.height = Math.max(1, Math.round(canvas.clientHeight * scale));
      regl.poll();
      regl.clear({ color: [0, 0, 0, 0], depth: 1 });
      const { m, f } = matrix(canvas.width, canvas.height);
      facts.patches.forEach((p, i) => {
        if (shown.patch[i] && p.count)
          surface({ m, f, edges: shown.edges ? 1 : 0, offset: 3 * p.first,
            count: 3 * p.count });
      });
      planes(m);
      if (shown.worst && marks) marks({ m });
      if (!view.dataset.drawn) count(regl);
    }

    function draw() {
      if (!waiting) requestAnimationFrame(paint);
      waiting = true;
    }

    build(() => {
      colour.subdata(colours(scene, shown.by));
      draw();
    }, draw);
    listen(draw);
    fit();
    new ResizeObserver(draw).observe(canvas);
    say.textContent = 'Drag to rotate, shift-drag to pan, use the wheel or ' +
      'two fingers to zoom.';
    draw();
  }

  try {
    await run();
  } catch (e) {
    view.hidden = true;
    say.textContent = 'WebGL is not available in this browser (' +
      e.message.split('\n')[0] + '); the pictures below show the surface.';
  }
})();
