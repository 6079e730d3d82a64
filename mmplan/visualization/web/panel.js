"use strict";
// The widgets: what they show and change is the page's state, `page`.

function element(tag, parent, attributes = {}) {
  const made = document.createElement(tag);
  Object.assign(made, attributes);
  if (parent) parent.append(made);
  return made;
}

function choice(parent, name, options, chosen) {
  const label = element("label", parent, { textContent: `${name} ` });
  const select = element("select", label);
  options.forEach((text, value) => element("option", select, { textContent: text, value }));
  select.addEventListener("change", () => chosen(Number(select.value)));
  return select;
}

function tick(parent, name, checked, changed) {
  const label = element("label", parent);
  const box = element("input", label, { type: "checkbox", checked });
  label.append(name);
  box.addEventListener("change", () => changed(box.checked));
}

function table(parent, header, rows) {
  const made = element("table", parent);
  const head = element("tr", element("thead", made));
  for (const text of header) element("th", head, { textContent: text });
  const body = element("tbody", made);
  for (const row of rows) {
    const line = element("tr", body);
    for (const text of row) element("td", line, { textContent: text });
  }
}

class Timeline {
  constructor(page, root) {
    this.page = page;
    const { marks, duration, clearance } = page.content;
    const row = element("div", root, { className: "row" });
    this.button = element("button", row, { id: "play", textContent: "Play" });
    this.button.addEventListener("click", () => page.toggle());
    const speeds = [0.25, 0.5, 1, 2];
    const select = choice(row, "speed", speeds, (k) => { page.speed = speeds[k]; });
    select.id = "speed";
    select.value = 2;
    this.clock = element("span", row);
    this.text = element("span", row, { className: "quiet" });
    this.slider = element("input", root, {
      id: "time", type: "range", min: 0, max: duration, step: 0.001, value: 0 });
    this.slider.setAttribute("aria-label", "time, s");
    this.slider.addEventListener("input", () => page.goTo(Number(this.slider.value)));
    this.marks = element("div", root, { className: "marks" });
    for (const mark of marks) {
      const button = element("button", this.marks, {
        textContent: mark.name,
        title: `${mark.name} (${mark.object}): ${mark.start.toFixed(2)} to ${mark.end.toFixed(2)} s` });
      button.style.flexGrow = mark.end - mark.start;
      button.addEventListener("click", () => page.goTo(mark.start));
    }
    if (clearance) this.makePlot(root);
  }

  makePlot(root) {
    this.plot = element("canvas", root, { className: "clearance", id: "clearance" });
    this.plot.title = "clearance along time; the lower, the nearer";
    this.plot.addEventListener("click", (event) => {
      this.page.goTo((event.offsetX / this.plot.clientWidth) * this.page.content.duration);
    });
  }

  update() {
    const { page } = this, { marks, duration } = page.content;
    this.button.textContent = page.playing ? "Pause" : "Play";
    this.slider.value = page.time;
    this.clock.textContent = `${page.time.toFixed(2)} / ${duration.toFixed(2)} s`;
    marks.forEach((mark, k) => {
      const later = k + 1 < marks.length && page.time >= marks[k + 1].start;
      this.marks.children[k].className = page.time >= mark.start && !later ? "now" : "";
    });
    if (this.plot) this.updatePlot();
  }

  updatePlot() {
    const { times, distances, pairs } = this.page.content.clearance;
    let now = 0;
    while (now + 1 < times.length && times[now + 1] <= this.page.time) now++;
    this.text.textContent =
      `clearance ${(1000 * distances[now]).toFixed(1)} mm: ${pairs[now].join(" / ")}`;
    const { plot } = this, ratio = window.devicePixelRatio || 1;
    const width = (plot.width = plot.clientWidth * ratio);
    const height = (plot.height = plot.clientHeight * ratio);
    const pen = plot.getContext("2d");
    const most = Math.max(...distances, 1e-3), end = this.page.content.duration;
    const x = (t) => (t / end) * width;
    // By its square root, so that what is near shows.
    const y = (d) => height - 2 - Math.sqrt(Math.max(d, 0) / most) * (height - 12 * ratio);
    pen.beginPath();
    pen.moveTo(0, height);
    times.forEach((t, k) => pen.lineTo(x(t), y(distances[k])));
    pen.lineTo(width, height);
    pen.fillStyle = "#c7dcf5";
    pen.fill();
    pen.strokeStyle = "#2f6fd0";
    pen.stroke();
    pen.fillStyle = "#555";
    pen.font = `${10 * ratio}px sans-serif`;
    pen.fillText(`clearance, up to ${(1000 * most).toFixed(0)} mm`, 4, 10 * ratio);
    pen.fillStyle = "#c03020";
    pen.fillRect(x(this.page.time) - ratio / 2, 0, ratio, height);
  }
}

class CandidatePanel {
  constructor(page, root) {
    this.page = page;
    this.all = page.content.searches.flatMap((search, task) => search.candidates.map(
      (candidate) => ({ ...candidate, task })));
    if (this.all.length === 0) return;
    const details = element("details", root, { id: "candidates" });
    element("summary", details, { textContent: "Candidates of the optimizer" });
    const row = element("div", details, { className: "row" });
    this.step(row, "‹", -1);
    const many = page.content.searches.length > 1;
    const labels = this.all.map((c) =>
      `${many ? `task ${c.task + 1}: ` : ""}${c.label}: ${c.total.toFixed(1)}`);
    this.select = element("select", row, { id: "candidate" });
    this.select.style.minWidth = 0;
    ["none shown", ...labels].forEach((text, k) =>
      element("option", this.select, { textContent: text, value: k - 1 }));
    this.select.addEventListener("change", () => this.show(Number(this.select.value)));
    this.step(row, "›", 1);
    const ends = element("div", details);
    ["start", "goal"].forEach((name, end) =>
      tick(ends, name, true, (on) => { page.shownEnds[end] = on; page.changed(); }));
    tick(ends, "distances", true, (on) => { page.showDistances = on; page.changed(); });
    this.terms = element("div", details);
  }

  step(row, text, by) {
    element("button", row, { textContent: text }).addEventListener("click", () => {
      const n = this.all.length + 1;
      this.show(((Number(this.select.value) + 1 + by + n) % n) - 1);
    });
  }

  show(number) {
    this.select.value = number;
    this.page.candidate = number < 0 ? null : this.all[number];
    this.terms.replaceChildren();
    if (number >= 0) this.tabulate(this.all[number]);
    this.page.changed();
  }

  tabulate({ ends }) {
    const number = (value) => (value === undefined ? "" : value.toFixed(1));
    element("h2", this.terms, { textContent: "score by term" });
    const names = Object.keys(ends[0].terms);
    table(this.terms, ["", "start", "goal"], [
      ...names.map((name) => [name, ...ends.map((end) => number(end.terms[name]))]),
      ["score", ...ends.map((end) => number(end.total))]]);
    ends.forEach((end, k) => {
      element("h2", this.terms, {
        textContent: `clutter by link at the ${["start", "goal"][k]}` });
      table(this.terms, ["link", "mm", "points"], end.links.map((link) => [
        link.link,
        link.distance === null ? "–" : (1000 * link.distance).toFixed(0),
        number(link.points)]));
    });
  }
}

class CyclePanel {
  constructor(page, root) {
    const cycles = page.content.searches.flatMap((search) => search.cycles);
    if (cycles.length === 0) return;
    const details = element("details", root, { id: "populations" });
    element("summary", details, { textContent: "Populations over the cycles" });
    const label = element("div", details, { textContent: "not shown" });
    const slider = element("input", details, {
      id: "cycle", type: "range", min: 0, max: cycles.length, step: 1, value: 0 });
    slider.setAttribute("aria-label", "cycle");
    element("div", details, {
      className: "quiet",
      textContent: "Bases on the floor: blue for the start, orange for the goal, the paler the worse." });
    slider.addEventListener("input", () => {
      page.cycle = cycles[Number(slider.value) - 1] || null;
      label.textContent = page.cycle ? page.cycle.label : "not shown";
      page.changed();
    });
  }
}
