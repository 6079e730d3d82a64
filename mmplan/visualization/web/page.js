"use strict";
// The page: its state, what is drawn of it, and how the camera moves.

const ENDS = [[0.16, 0.45, 0.84], [0.88, 0.42, 0.08]]; // start, goal
const GHOST = 0.6;

class Page {
  constructor(content, numbers) {
    this.content = content;
    this.numbers = numbers;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.hidden = new Set();
    this.candidate = null;
    this.shownEnds = [true, true];
    this.showDistances = true;
    this.cycle = null;
    this.drawing = new Drawing(document.getElementById("view"));
    this.parts = content.parts.map((part) => ({ ...part, surface: this.surface(part) }));
    this.pipe = this.surface(content.pipe);
    this.coin = this.surface(content.coin);
    this.times = this.floats(content.times, content.moments);
    const c = content.camera;
    this.camera = { ...c, azimuth: (c.azimuth * Math.PI) / 180, elevation: (c.elevation * Math.PI) / 180 };
    this.makePanel();
    new Steering(this);
    this.ask();
  }

  floats(offset, count) { return new Float32Array(this.numbers, offset, count); }

  surface({ vertices, normals, triangles }) {
    return this.drawing.surface(
      new Float32Array(this.numbers, vertices[0], vertices[1]),
      new Int8Array(this.numbers, normals[0], normals[1]),
      new Uint32Array(this.numbers, triangles[0], triangles[1]));
  }

  makePanel() {
    const panel = document.getElementById("panel");
    element("h1", panel, { textContent: this.content.title });
    element("div", panel, { textContent: this.content.subtitle, className: "quiet" });
    const layers = element("div", panel);
    for (const layer of this.content.layers)
      tick(layers, layer, true, (on) => {
        if (on) this.hidden.delete(layer);
        else this.hidden.add(layer);
        this.changed();
      });
    new CandidatePanel(this, panel);
    new CyclePanel(this, panel);
    if (this.content.marks.length)
      this.timeline = new Timeline(this, document.getElementById("timeline"));
  }

  toggle() {
    if (!this.playing && this.time >= this.content.duration) this.time = 0;
    this.playing = !this.playing;
    this.before = null;
    this.changed();
  }

  goTo(time) {
    this.time = Math.min(Math.max(time, 0), this.content.duration);
    this.changed();
  }

  changed() { this.ask(); }

  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => { this.asked = false; this.show(now); });
  }

  show(now) {
    if (this.playing) {
      if (this.before) this.time += ((now - this.before) / 1000) * this.speed;
      this.before = now;
      if (this.time >= this.content.duration) {
        this.time = this.content.duration;
        this.playing = false;
      }
    }
    if (this.timeline) this.timeline.update();
    this.fit();
    this.drawing.draw([...this.items()], this.seen());
    document.body.dataset.time = this.time.toFixed(3);
    if (this.playing) this.ask();
  }

  fit() {
    const { canvas } = this.drawing, ratio = Math.min(window.devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  }

  seen() {
    const { target, azimuth, elevation, distance } = this.camera;
    const level = Math.cos(elevation);
    const away = [level * Math.cos(azimuth), level * Math.sin(azimuth), Math.sin(elevation)];
    const eye = target.map((value, k) => value + distance * away[k]);
    return { ...this.camera, eye, room: Math.max(3, this.content.camera.distance * 0.6) };
  }

  // The matrices of all carriers at the time shown; the first carrier is the world.
  matrices() {
    const count = this.content.carriers.length - 1;
    let k = 0;
    while (k + 2 < this.times.length && this.times[k + 1] <= this.time) k++;
    const next = Math.min(k + 1, this.times.length - 1);
    const span = this.times[next] - this.times[k];
    const share = span > 0 ? Math.min(1, (this.time - this.times[k]) / span) : 0;
    const poses = this.floats(this.content.poses, 7 * count * this.times.length);
    const pose = (moment, carrier) => {
      const start = 7 * (moment * count + carrier);
      return poses.subarray(start, start + 7);
    };
    const all = [IDENTITY];
    for (let c = 0; c < count; c++)
      all.push(poseMatrix(blended(pose(k, c), pose(next, c), share)));
    return all;
  }

  *items() {
    const matrices = this.matrices();
    for (const part of this.parts)
      if (!this.hidden.has(part.layer))
        yield {
          surface: part.surface,
          matrix: matrices[part.carrier],
          colour: part.colour,
          casts: part.solid };
    if (this.candidate) yield* this.candidateItems();
    if (this.cycle) yield* this.cycleItems();
  }

  *candidateItems() {
    for (let end = 0; end < 2; end++) {
      if (!this.shownEnds[end]) continue;
      const { poses, links } = this.candidate.ends[end];
      for (const part of this.parts) {
        if (!(part.carrier in poses) || !part.solid) continue;
        const colour = ENDS[end].map((value, k) => 0.5 * value + 0.5 * part.colour[k]);
        yield {
          surface: part.surface,
          matrix: poseMatrix(poses[part.carrier]),
          colour: [...colour, GHOST],
          ghost: true };
      }
      if (this.showDistances)
        for (const { from, to } of links)
          if (from) yield {
            surface: this.pipe, matrix: between(from, to, 0.004), colour: [0.8, 0.1, 0.1, 1] };
    }
  }

  *cycleItems() {
    for (let end = 0; end < 2; end++) {
      const { positions, scores } = this.cycle.ends[end];
      const best = Math.max(...scores, 1e-9);
      for (let k = positions.length - 1; k >= 0; k--) {
        const [x, y] = positions[k];
        yield {
          surface: this.coin,
          matrix: disc(x, y, 0.012 + 0.006 * end, scores[k] > 0 ? 0.03 : 0.018),
          colour: [...ENDS[end], 0.25 + (0.75 * scores[k]) / best] };
      }
    }
  }
}

// Drag turns, Shift or the right button moves, the wheel or two fingers zoom.
class Steering {
  constructor(page) {
    this.page = page;
    this.pointers = new Map();
    const canvas = page.drawing.canvas;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("pointermove", (event) => this.moved(event));
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    window.addEventListener("resize", () => page.changed());
    window.addEventListener("keydown", (event) => {
      if (event.key !== " " || event.target.closest("button, input, select")) return;
      event.preventDefault();
      if (page.timeline) page.toggle();
    });
  }

  moved(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId);
    this.pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (others.length) {
      const [x, y] = others[0][1];
      const was = Math.hypot(before[0] - x, before[1] - y);
      this.zoom(was / Math.max(1, Math.hypot(event.clientX - x, event.clientY - y)));
    } else if (event.shiftKey || event.buttons & 2) this.shift(dx, dy);
    else this.turn(dx, dy);
  }

  turn(dx, dy) {
    const { camera } = this.page;
    camera.azimuth -= 0.006 * dx;
    camera.elevation = Math.min(1.55, Math.max(-0.3, camera.elevation + 0.006 * dy));
    this.page.changed();
  }

  shift(dx, dy) {
    const { camera } = this.page, a = camera.azimuth, e = camera.elevation;
    const step = camera.distance / this.page.drawing.canvas.clientHeight;
    const right = [-Math.sin(a), Math.cos(a), 0];
    const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
    camera.target = camera.target.map((v, k) => v + step * (dy * up[k] - dx * right[k]));
    this.page.changed();
  }

  zoom(factor) {
    const { camera } = this.page;
    camera.distance = Math.min(40, Math.max(0.15, camera.distance * factor));
    this.page.changed();
  }
}

// The numbers are compressed and written in base64.
async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

async function start() {
  const content = JSON.parse(document.getElementById("content").textContent);
  document.title = content.title;
  try {
    const numbers = await unpacked(document.getElementById("numbers").textContent);
    window.page = new Page(content, numbers);
    document.body.dataset.ready = "yes";
  } catch (error) {
    element("div", document.body, {
      className: "fault", textContent: `This page cannot be drawn: ${error.message}.` });
    throw error;
  }
}

start();
