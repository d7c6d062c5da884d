/* SPDX-License-Identifier: LGPL-3.0-or-later */
// The 3-D view of a surface, for the report and the portal. WebGL 2 alone: the
// page of the portal forbids scripts to compile further scripts.
'use strict';

// Decompresses a scene as written by src/cli/scene (zlib).
async function unpackScene(bytes) {
  const stream = new Blob([bytes]).stream()
    .pipeThrough(new DecompressionStream('deflate'));
  return new DataView(await new Response(stream).arrayBuffer());
}

// For each corner of each triangle: position, and the barycentric coordinates
// by which edges are drawn. by: the arrays with one byte per triangle.
function expandScene(facts, data) {
  const n = facts.triangles, from = 12 * facts.points;
  const place = new Float32Array(9 * n), side = new Uint8Array(9 * n);
  let last = 0;
  for (let i = 0; i < 3 * n; i++) {
    last = (last + data.getUint32(from + 4 * i, true)) >>> 0;
    for (let k = 0; k < 3; k++)
      place[3 * i + k] = data.getFloat32(12 * last + 4 * k, true);
    side[3 * i + i % 3] = 255;
  }
  const bytes = from + 12 * n, by = [];
  for (let at = bytes; at + n <= data.byteLength && n; at += n)
    by.push(new Uint8Array(data.buffer, at, n));
  return { place, side, by };
}

// --- vectors ----------------------------------------------------------------

const vec = {
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  unit: a => a.map(v => v / (Math.hypot(...a) || 1)),
};

// --- camera -----------------------------------------------------------------

// An orthographic camera around the box of the body.
function createCamera(canvas, facts) {
  const toward = vec.unit(facts.toward);
  const start = { turn: Math.atan2(toward[1], toward[0]),
    lift: Math.asin(toward[2]), zoom: 1, at: [0, 0, 0] };
  const eye = { ...start, at: [...start.at] };

  function frame() {
    const to = [Math.cos(eye.lift) * Math.cos(eye.turn),
      Math.cos(eye.lift) * Math.sin(eye.turn), Math.sin(eye.lift)];
    const right = [-Math.sin(eye.turn), Math.cos(eye.turn), 0];
    return { toward: to, right, up: vec.cross(to, right) };
  }

  return {
    eye, start, frame,

    // Zooms so that the bounding box of the body just fits.
    fit() {
      const f = frame(), aspect = canvas.clientWidth / canvas.clientHeight;
      const extent = v => v.reduce((sum, x, k) =>
        sum + Math.abs(x) * facts.half[k], 0);
      const size = Math.max(extent(f.right) / Math.max(aspect, 1),
        extent(f.up) * Math.min(aspect, 1));
      eye.zoom = 0.92 * facts.radius / (size || facts.radius);
    },

    look(turn, lift) {
      Object.assign(eye, { turn, lift, at: [0, 0, 0] });
      this.fit();
    },

    // Scales of the two directions of the picture.
    scales() {
      const aspect = canvas.clientWidth / canvas.clientHeight || 1;
      const s = eye.zoom / (1.02 * facts.radius);
      return [aspect > 1 ? s / aspect : s, aspect > 1 ? s : s * aspect];
    },

    // Column-major, with a depth range far beyond the body.
    matrix() {
      const f = frame(), [sx, sy] = this.scales();
      const rows = [[f.right, sx], [f.up, sy],
        [f.toward, -1 / (60 * facts.radius)]];
      const m = new Float32Array(16);
      rows.forEach(([v, scale], r) => {
        for (let c = 0; c < 3; c++) m[4 * c + r] = v[c] * scale;
        m[12 + r] = -vec.dot(v, eye.at) * scale;
      });
      m[15] = 1;
      return { m, f };
    },

    move(dx, dy) {
      const f = frame(), size = Math.min(canvas.clientHeight,
        canvas.clientWidth) * eye.zoom / 2;
      const scale = 1.02 * facts.radius / size;
      for (let k = 0; k < 3; k++)
        eye.at[k] -= (dx * f.right[k] - dy * f.up[k]) * scale;
    },

    turn(dx, dy) {
      eye.turn -= dx * 0.007;
      eye.lift = Math.max(-1.57, Math.min(1.57, eye.lift + dy * 0.007));
    },
  };
}

// --- programs ---------------------------------------------------------------

const surfaceVertex = `#version 300 es
  in vec3 place, colour, side;
  uniform mat4 m;
  out vec3 p, c, s;
  void main() {
    p = place; c = colour; s = side;
    gl_Position = m * vec4(place, 1.0);
  }`;
const surfaceFragment = `#version 300 es
  precision highp float;
  in vec3 p, c, s;
  out vec4 pixel;
  uniform vec3 toward, up;
  uniform float edges, chosen;
  void main() {
    vec3 n = normalize(cross(dFdx(p), dFdy(p)));
    float front = abs(dot(n, toward));
    float light = min(0.5 + 0.44 * front + 0.14 * abs(dot(n, up)), 1.0);
    vec3 width = fwidth(s);
    vec3 near = smoothstep(vec3(0.0), width * 1.1, s);
    float line = 1.0 - min(near.x, min(near.y, near.z));
    float small = max(width.x, max(width.y, width.z));
    line *= edges * (1.0 - smoothstep(0.12, 0.4, small));
    vec3 base = mix(c, vec3(1.0, 0.74, 0.16), 0.88 * chosen);
    pixel = vec4(base * light * (1.0 - 0.6 * line), 1.0);
  }`;
const planeVertex = `#version 300 es
  in vec2 at;
  uniform mat4 m;
  uniform vec3 o, u, v;
  out vec2 t;
  void main() {
    t = vec2(at.x, 1.0 - at.y);
    gl_Position = m * vec4(o + (2.0 * at.x - 1.0) * u +
                           (2.0 * at.y - 1.0) * v, 1.0);
  }`;
const planeFragment = `#version 300 es
  precision highp float;
  in vec2 t;
  out vec4 pixel;
  uniform sampler2D picture;
  void main() {
    vec4 c = texture(picture, t);
    if (c.a < 0.5) discard;
    pixel = vec4(c.rgb, 1.0);
  }`;
const marksVertex = `#version 300 es
  in vec3 place;
  uniform mat4 m;
  uniform float size;
  void main() { gl_Position = m * vec4(place, 1.0); gl_PointSize = size; }`;
const marksFragment = `#version 300 es
  precision highp float;
  out vec4 pixel;
  void main() {
    float r = length(gl_PointCoord - 0.5);
    if (r > 0.5) discard;
    pixel = vec4(r > 0.38 ? vec3(1.0) : vec3(0.75, 0.1, 0.1), 1.0);
  }`;

// A program with the locations of its attributes and uniforms by name.
function buildProgram(gl, vertex, fragment) {
  const program = gl.createProgram(), at = {};
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error('a shader cannot be compiled');
  for (let i = gl.getProgramParameter(program, gl.ACTIVE_ATTRIBUTES); i--;) {
    const { name } = gl.getActiveAttrib(program, i);
    at[name] = gl.getAttribLocation(program, name);
  }
  for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i--;) {
    const { name } = gl.getActiveUniform(program, i);
    at[name] = gl.getUniformLocation(program, name);
  }
  return { program, at };
}

function buildBuffer(gl, data, usage) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, usage || gl.STATIC_DRAW);
  return buffer;
}

// --- picking ----------------------------------------------------------------

// The triangle at a point of the canvas, or -1. Triangles that show their back
// are not drawn and not picked.
function pickTriangle(view, x, y) {
  const { place } = view.scene, { m } = view.camera.matrix();
  const px = 2 * x / view.canvas.clientWidth - 1;
  const py = 1 - 2 * y / view.canvas.clientHeight;
  let best = -1, depth = Infinity;

  view.facts.patches.forEach((patch, i) => {
    if (!view.shown.patch[i]) return;
    for (let t = patch.first; t < patch.first + patch.count; t++) {
      const c = [];
      for (let j = 9 * t; j < 9 * t + 9; j += 3)
        for (let r = 0; r < 3; r++)
          c.push(m[r] * place[j] + m[4 + r] * place[j + 1] +
                 m[8 + r] * place[j + 2] + m[12 + r]);
      const side = (i, j) => (c[3 * j] - c[3 * i]) * (py - c[3 * i + 1]) -
                             (c[3 * j + 1] - c[3 * i + 1]) * (px - c[3 * i]);
      const a = side(1, 2), b = side(2, 0), d = side(0, 1), sum = a + b + d;
      if (a < 0 || b < 0 || d < 0 || sum <= 0) continue;
      const z = (a * c[2] + b * c[5] + d * c[8]) / sum;
      if (z < depth) {
        depth = z;
        best = t;
      }
    }
  });
  return best;
}

// --- input ------------------------------------------------------------------

// Mouse, touch and keys. A press that does not move picks.
function listenToView(view, pick) {
  const { canvas, camera } = view, fingers = new Map();
  let travel = 0;

  canvas.addEventListener('pointerdown', e => {
    if (!fingers.size) travel = 0;
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    canvas.setPointerCapture(e.pointerId);
  });
  canvas.addEventListener('pointerup', e => {
    if (fingers.delete(e.pointerId) && !fingers.size && travel < 4 && pick) {
      const box = canvas.getBoundingClientRect();
      pick(pickTriangle(view, e.clientX - box.left, e.clientY - box.top), e);
    }
  });
  canvas.addEventListener('pointercancel', e => fingers.delete(e.pointerId));
  canvas.addEventListener('pointermove', e => {
    const old = fingers.get(e.pointerId);
    if (!old) return;
    const dx = e.clientX - old[0], dy = e.clientY - old[1];
    const others = [...fingers].filter(([id]) => id !== e.pointerId);
    travel += Math.hypot(dx, dy);
    if (others.length === 1) {
      const [x, y] = others[0][1];
      camera.eye.zoom *= Math.hypot(e.clientX - x, e.clientY - y) /
                         (Math.hypot(old[0] - x, old[1] - y) || 1);
      camera.move(dx / 2, dy / 2);
    } else if (e.shiftKey || e.buttons & 6) {
      camera.move(dx, dy);
    } else {
      camera.turn(dx, dy);
    }
    fingers.set(e.pointerId, [e.clientX, e.clientY]);
    view.draw();
  });
  canvas.addEventListener('contextmenu', e => e.preventDefault());
  canvas.addEventListener('wheel', e => {
    // Within a long page the wheel zooms once the view has the focus.
    if (view.needsFocus && document.activeElement !== canvas) return;
    e.preventDefault();
    const k = Math.exp(-e.deltaY * (e.deltaMode ? 0.05 : 0.0015));
    const box = canvas.getBoundingClientRect();
    const x = e.clientX - box.left - box.width / 2;
    const y = e.clientY - box.top - box.height / 2;
    camera.move(-x, -y);
    camera.eye.zoom *= k;
    camera.move(x, y);
    view.draw();
  }, { passive: false });
  canvas.addEventListener('keydown', e => {
    const step = { ArrowLeft: [-30, 0], ArrowRight: [30, 0],
      ArrowUp: [0, -30], ArrowDown: [0, 30] }[e.key];
    if (step) camera[e.shiftKey ? 'move' : 'turn'](...step);
    else if (e.key === '+' || e.key === '=') camera.eye.zoom *= 1.25;
    else if (e.key === '-') camera.eye.zoom /= 1.25;
    else if (e.key === '0') camera.look(camera.start.turn, camera.start.lift);
    else return;
    e.preventDefault();
    view.draw();
  });
}

// --- the view ---------------------------------------------------------------

// A view of the scene `data` (unpackScene). The caller sets members of
// view.shown and calls view.draw(). facts: counts, box and patches of the
// scene; pick(triangle, event) is called for a click.
function createView(canvas, facts, data, pick) {
  const gl = canvas.getContext('webgl2', { alpha: true, antialias: true,
    preserveDrawingBuffer: true });
  if (!gl) throw new Error('there is no WebGL 2');
  const scene = expandScene(facts, data);
  const surface = buildProgram(gl, surfaceVertex, surfaceFragment);
  const plane = buildProgram(gl, planeVertex, planeFragment);
  const mark = buildProgram(gl, marksVertex, marksFragment);
  const place = buildBuffer(gl, scene.place), side = buildBuffer(gl, scene.side);
  const colour = buildBuffer(gl, new Uint8Array(9 * facts.triangles),
    gl.DYNAMIC_DRAW);
  const square = buildBuffer(gl, new Float32Array([0, 0, 1, 0, 0, 1, 1, 1]));
  const points = gl.createBuffer(), pictures = new Map();
  let waiting = false, n_mark = 0;

  function bind(location, buffer, size, type, normalised) {
    if (location === undefined) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, normalised, 0, 0);
  }

  function drawSurface(m, f) {
    gl.useProgram(surface.program);
    bind(surface.at.place, place, 3, gl.FLOAT, false);
    bind(surface.at.side, side, 3, gl.UNSIGNED_BYTE, true);
    bind(surface.at.colour, colour, 3, gl.UNSIGNED_BYTE, true);
    gl.uniformMatrix4fv(surface.at.m, false, m);
    gl.uniform3fv(surface.at.toward, f.toward);
    gl.uniform3fv(surface.at.up, f.up);
    gl.uniform1f(surface.at.edges, view.shown.edges ? 1 : 0);
    // Normals point into the fluid, so that a body shows its outside, and an
    // outer boundary only its far side.
    if (!view.shown.backs) gl.enable(gl.CULL_FACE);
    facts.patches.forEach((p, i) => {
      if (!view.shown.patch[i] || !p.count) return;
      gl.uniform1f(surface.at.chosen, view.shown.chosen.has(i) ? 1 : 0);
      gl.drawArrays(gl.TRIANGLES, 3 * p.first, 3 * p.count);
    });
    gl.disable(gl.CULL_FACE);
  }

  function textureOf(image) {
    if (pictures.has(image)) return pictures.get(image);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
    for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, side, gl.LINEAR);
    pictures.set(image, texture);
    return texture;
  }

  // Pictures in planes: { o, u, v, image }.
  function drawPlanes(m) {
    gl.useProgram(plane.program);
    bind(plane.at.at, square, 2, gl.FLOAT, false);
    gl.uniformMatrix4fv(plane.at.m, false, m);
    for (const p of view.shown.planes) {
      gl.bindTexture(gl.TEXTURE_2D, textureOf(p.image));
      gl.uniform3fv(plane.at.o, p.o);
      gl.uniform3fv(plane.at.u, p.u);
      gl.uniform3fv(plane.at.v, p.v);
      gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    }
  }

  function drawMarks(m) {
    gl.useProgram(mark.program);
    bind(mark.at.place, points, 3, gl.FLOAT, false);
    gl.uniformMatrix4fv(mark.at.m, false, m);
    gl.uniform1f(mark.at.size, 13);
    gl.disable(gl.DEPTH_TEST);
    gl.drawArrays(gl.POINTS, 0, n_mark);
    gl.enable(gl.DEPTH_TEST);
  }

  // Attributes of one program must not stay enabled for the next.
  function release(program) {
    for (const v of Object.values(program.at))
      if (typeof v === 'number') gl.disableVertexAttribArray(v);
  }

  function paint() {
    waiting = false;
    const scale = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * scale));
    const height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const { m, f } = view.camera.matrix();
    drawSurface(m, f);
    release(surface);
    if (view.shown.planes.length) {
      drawPlanes(m);
      release(plane);
    }
    if (n_mark) {
      drawMarks(m);
      release(mark);
    }
    if (view.onPaint) view.onPaint();
  }

  const view = {
    canvas, facts, scene, needsFocus: false, camera: createCamera(canvas, facts),
    shown: { edges: !facts.merged, backs: false, planes: [], chosen: new Set(),
      patch: facts.patches.map(p => p.body) },

    draw() {
      if (!waiting) requestAnimationFrame(paint);
      waiting = true;
    },

    // One colour for each triangle, by number of patch and triangle.
    colour(of) {
      const bytes = new Uint8Array(9 * facts.triangles);
      facts.patches.forEach((p, i) => {
        for (let t = p.first; t < p.first + p.count; t++) {
          const c = of(i, t);
          for (let k = 0; k < 9; k++) bytes[9 * t + k] = c[k % 3];
        }
      });
      gl.bindBuffer(gl.ARRAY_BUFFER, colour);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, bytes);
      view.draw();
    },

    // Points, relative to the centre of the scene, that are always visible.
    mark(list) {
      n_mark = list.length;
      gl.bindBuffer(gl.ARRAY_BUFFER, points);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(list.flat()),
        gl.STATIC_DRAW);
      view.draw();
    },

    // Moves a point to the centre and shows a sphere around it.
    focus(at, radius) {
      view.camera.eye.at = [...at];
      view.camera.eye.zoom = facts.radius / radius;
      view.draw();
    },

    patchOf(t) {
      return facts.patches.findIndex(p =>
        t >= p.first && t < p.first + p.count);
    },

    // Number of pixels drawn, for tests.
    drawn() {
      const pixels = new Uint8Array(4 * canvas.width * canvas.height);
      gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA,
        gl.UNSIGNED_BYTE, pixels);
      let n = 0;
      for (let i = 3; i < pixels.length; i += 4) n += pixels[i] > 0;
      return n;
    },

    // Where a point of the scene is on the canvas, in pixels of the page.
    project(x) {
      const { m } = view.camera.matrix();
      const row = r => m[r] * x[0] + m[4 + r] * x[1] + m[8 + r] * x[2] +
                       m[12 + r];
      return [(1 + row(0)) / 2 * canvas.clientWidth,
        (1 - row(1)) / 2 * canvas.clientHeight];
    },
  };
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  listenToView(view, pick);
  view.camera.fit();
  new ResizeObserver(view.draw).observe(canvas);
  return view;
}
