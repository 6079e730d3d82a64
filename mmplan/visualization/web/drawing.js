"use strict";
// Draws surfaces with WebGL 2, opaque ones first, and the shadows of these.

const VERTEX_SHADER = `#version 300 es
in vec3 position;
in vec3 normal;
uniform mat4 view, model, light;
out vec3 place, facing, lit;
void main() {
  vec4 world = model * vec4(position, 1.0);
  place = world.xyz;
  facing = mat3(model) * normal;
  vec4 seen = light * world;
  lit = seen.xyz * 0.5 + 0.5;
  gl_Position = view * world;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
precision highp sampler2DShadow;
in vec3 place, facing, lit;
uniform vec4 colour;
uniform vec3 eye, sun;
uniform sampler2DShadow shadows;
out vec4 result;
void main() {
  vec3 n = normalize(facing), away = normalize(eye - place);
  if (dot(n, away) < 0.0) n = -n;
  float slope = max(dot(n, sun), 0.0), shade = 0.0;
  for (int i = 0; i < 4; i++) {
    vec2 step = vec2(i % 2, i / 2) - 0.5;
    shade += texture(shadows, vec3(lit.xy + step / 1500.0, lit.z - 0.002 - 0.004 * (1.0 - slope)));
  }
  if (any(greaterThan(abs(lit - 0.5), vec3(0.5)))) shade = 4.0;
  float sky = 0.42 + 0.14 * n.z + 0.16 * max(dot(n, away), 0.0);
  vec3 glow = colour.rgb * (sky + 0.42 * slope * shade / 4.0);
  result = vec4(pow(glow, vec3(0.92)), colour.a);
}`;

const SHADOW_SHADER = `#version 300 es
in vec3 position;
uniform mat4 model, light;
void main() { gl_Position = light * model * vec4(position, 1.0); }`;

const NO_FRAGMENTS = `#version 300 es
void main() {}`;

const SHADOW_SIZE = 2048;
const FADED = 0.98; // colours less opaque than this are drawn last and cast no shadow

class Drawing {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!this.gl) throw new Error("this browser draws no WebGL 2");
    this.lighted = this.program(VERTEX_SHADER, FRAGMENT_SHADER);
    this.shadowing = this.program(SHADOW_SHADER, NO_FRAGMENTS);
    this.makeShadows();
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "position");
    gl.bindAttribLocation(program, 1, "normal");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program) || "the shaders do not link");
    const places = {};
    for (const name of ["view", "model", "light", "colour", "eye", "sun", "shadows"])
      places[name] = gl.getUniformLocation(program, name);
    return { program, places };
  }

  makeShadows() {
    const gl = this.gl;
    this.shadows = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.shadows);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    this.frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.framebufferTexture2D(
      gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.shadows, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  // A surface on the graphics card: positions and normals of vertices, corners.
  surface(positions, normals, triangles) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, positions, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, normals, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.BYTE, true, 4, 0);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: triangles.length };
  }

  // Draws items, each {surface, matrix, colour, casts}, as a camera sees them; those that
  // are opaque and `casts` cast shadows, those that are not and `ghost` have no inside.
  draw(items, camera) {
    const opaque = items.filter((item) => item.colour[3] >= FADED);
    const faded = items.filter((item) => item.colour[3] < FADED);
    const sun = unit([Math.cos(camera.sun), Math.sin(camera.sun), 1.5]);
    const light = this.lightMatrix(camera.target, sun, camera.room);
    this.drawShadows(opaque.filter((item) => item.casts), light);
    this.drawLighted(opaque, faded, camera, sun, light);
  }

  lightMatrix(target, sun, room) {
    const far = target.map((value, k) => value + 2 * room * sun[k]);
    const flat = new Float32Array(IDENTITY);
    flat[0] = flat[5] = 1 / room;
    flat[10] = -1 / (2 * room);
    flat[14] = -1;
    return product(flat, looking(far, target));
  }

  drawShadows(items, light) {
    const gl = this.gl, { program, places } = this.shadowing;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.light, false, light);
    this.drawItems(items, places);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  drawLighted(opaque, faded, camera, sun, light) {
    const gl = this.gl, { program, places } = this.lighted;
    const { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.93, 0.95, 0.97, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    const lens = perspective(camera.fov, width / height, 0.05, 60);
    gl.uniformMatrix4fv(places.view, false, product(lens, looking(camera.eye, camera.target)));
    gl.uniformMatrix4fv(places.light, false, light);
    gl.uniform3fv(places.eye, camera.eye);
    gl.uniform3fv(places.sun, sun);
    gl.bindTexture(gl.TEXTURE_2D, this.shadows);
    gl.uniform1i(places.shadows, 0);
    this.drawItems(opaque, places);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.drawGhosts(faded.filter((item) => item.ghost), places);
    gl.depthMask(false);
    this.drawItems(faded.filter((item) => !item.ghost), places);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  // Ghosts show what is behind them, but nothing of their own inside.
  drawGhosts(items, places) {
    const gl = this.gl;
    gl.colorMask(false, false, false, false);
    this.drawItems(items, places);
    gl.colorMask(true, true, true, true);
    gl.depthFunc(gl.LEQUAL);
    this.drawItems(items, places);
    gl.depthFunc(gl.LESS);
  }

  drawItems(items, places) {
    const gl = this.gl;
    for (const { surface, matrix, colour } of items) {
      gl.uniformMatrix4fv(places.model, false, matrix);
      if (places.colour) gl.uniform4fv(places.colour, colour);
      gl.bindVertexArray(surface.array);
      gl.drawElements(gl.TRIANGLES, surface.count, gl.UNSIGNED_INT, 0);
    }
    gl.bindVertexArray(null);
  }
}
