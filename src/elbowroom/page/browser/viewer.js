"use strict";
// a small viewer: triangles, lines and points of a room, turned by dragging
const Viewer = (() => {
  const MESH_V = `#version 300 es
    uniform mat4 view, project; uniform mat4 place; in vec3 at; out vec3 seen;
    void main() { vec4 here = view * place * vec4(at, 1.0); seen = here.xyz; gl_Position = project * here; }`;
  const MESH_F = `#version 300 es
    precision highp float; uniform vec3 colour; in vec3 seen; out vec4 paint;
    void main() { vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
      paint = vec4(colour * (0.55 + 0.45 * abs(dot(normal, normalize(vec3(0.25, 0.5, 1.0))))), 1.0); }`;
  const DOT_V = `#version 300 es
    uniform mat4 view, project; uniform float size, scale; in vec3 at;
    void main() { vec4 here = view * vec4(at, 1.0); gl_Position = project * here; gl_PointSize = max(2.0, size * scale / -here.z); }`;
  const DOT_F = `#version 300 es
    precision mediump float; uniform vec3 colour; out vec4 paint; void main() { paint = vec4(colour, 1.0); }`;

  let gl = null, mesh = null, dots = null, canvas = null, wanted = false;
  const bodies = [], lines = [];
  let clouds = [];
  const eye = {target: [0, 0, 1], far: 6, turn: -0.8, tilt: 0.35};

  function begin(parent) {
    canvas = document.createElement("canvas");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", parent.getAttribute("aria-label"));
    gl = canvas.getContext("webgl2", {antialias: true});
    if (!gl) return false;
    parent.append(canvas);
    mesh = program(MESH_V, MESH_F);
    dots = program(DOT_V, DOT_F);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
    canvas.onpointerdown = event => canvas.setPointerCapture(event.pointerId);
    canvas.onpointermove = event => {
      if (!event.buttons) return;
      if (event.shiftKey || event.buttons === 2) shift(event.movementX, event.movementY);
      else { eye.turn -= 0.008 * event.movementX; eye.tilt = Math.min(1.55, Math.max(-1.55, eye.tilt + 0.008 * event.movementY)); }
      draw();
    };
    canvas.oncontextmenu = event => event.preventDefault();
    canvas.addEventListener("wheel", event => { event.preventDefault(); eye.far = Math.min(60, Math.max(0.3, eye.far * Math.exp(event.deltaY / 800))); draw(); }, {passive: false});
    canvas.onkeydown = event => {
      const by = {ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1]}[event.key];
      if (by) { event.preventDefault(); eye.turn += by[0]; eye.tilt = Math.min(1.55, Math.max(-1.55, eye.tilt + by[1])); draw(); }
    };
    new ResizeObserver(draw).observe(canvas);
    return true;
  }

  function program(vertex, fragment) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.bindAttribLocation(made, 0, "at");
    gl.linkProgram(made);
    const of = {};
    for (let n = 0; n < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); n++) {
      const name = gl.getActiveUniform(made, n).name;
      of[name] = gl.getUniformLocation(made, name);
    }
    return {made, of};
  }

  function buffer(values) {
    const array = gl.createVertexArray(), made = gl.createBuffer();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, made);
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    return {array, made, count: values.length / 3};
  }

  const IDENTITY = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  const shade = colour => colour.map(part => part / 255);

  function addBody(triangles, colour) { bodies.push({...buffer(triangles), colour: shade(colour), place: IDENTITY, shown: false}); }
  function addLines(ends, colour) { lines.push({...buffer(ends), colour: shade(colour)}); }

  // 12 numbers a body, row by row: turn and place
  function placeBodies(rows) {
    bodies.forEach((body, number) => {
      body.shown = rows !== null;
      if (rows === null) return;
      const r = rows.subarray(12 * number, 12 * number + 12);
      body.place = new Float32Array([r[0], r[4], r[8], 0, r[1], r[5], r[9], 0, r[2], r[6], r[10], 0, r[3], r[7], r[11], 1]);
    });
  }

  function setClouds(given) {
    for (const one of clouds) { gl.deleteBuffer(one.made); gl.deleteVertexArray(one.array); }
    clouds = given.filter(one => one.points.length).map(one => ({...buffer(one.points), colour: shade(one.colour), size: one.size, above: one.above}));
  }

  function look(target, far) { eye.target = target; eye.far = far; draw(); }

  function shift(x, y) {
    const [right, up] = axes(), by = eye.far / 600;
    eye.target = eye.target.map((value, n) => value - by * x * right[n] + by * y * up[n]);
  }

  function axes() {
    const [c, s, ct, st] = [Math.cos(eye.turn), Math.sin(eye.turn), Math.cos(eye.tilt), Math.sin(eye.tilt)];
    return [[-s, c, 0], [-st * c, -st * s, ct], [ct * c, ct * s, st]];
  }

  function draw() { if (!wanted) { wanted = true; requestAnimationFrame(paint); } }

  function paint() {
    wanted = false;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    gl.viewport(0, 0, width, height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [right, up, back] = axes();
    const at = eye.target.map((value, n) => value + eye.far * back[n]);
    const off = axis => -(axis[0] * at[0] + axis[1] * at[1] + axis[2] * at[2]);
    const view = new Float32Array([right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, off(right), off(up), off(back), 1]);
    const focal = 1.6, near = 0.02, end = 100;
    const project = new Float32Array([focal * height / width, 0, 0, 0, 0, focal, 0, 0, 0, 0, (end + near) / (near - end), -1, 0, 0, 2 * end * near / (near - end), 0]);
    gl.useProgram(mesh.made);
    gl.uniformMatrix4fv(mesh.of.view, false, view);
    gl.uniformMatrix4fv(mesh.of.project, false, project);
    for (const body of bodies) if (body.shown) {
      gl.uniformMatrix4fv(mesh.of.place, false, body.place);
      gl.uniform3fv(mesh.of.colour, body.colour);
      gl.bindVertexArray(body.array);
      gl.drawArrays(gl.TRIANGLES, 0, body.count);
    }
    gl.useProgram(dots.made);
    gl.uniformMatrix4fv(dots.of.view, false, view);
    gl.uniformMatrix4fv(dots.of.project, false, project);
    gl.uniform1f(dots.of.scale, focal * height / 2);
    for (const [kind, all] of [[gl.LINES, lines], [gl.POINTS, clouds]]) for (const one of all) {
      one.above ? gl.disable(gl.DEPTH_TEST) : gl.enable(gl.DEPTH_TEST);
      gl.uniform1f(dots.of.size, one.size ?? 1);
      gl.uniform3fv(dots.of.colour, one.colour);
      gl.bindVertexArray(one.array);
      gl.drawArrays(kind, 0, one.count);
    }
    gl.enable(gl.DEPTH_TEST);
  }

  return {begin, addBody, addLines, placeBodies, setClouds, look, draw};
})();
