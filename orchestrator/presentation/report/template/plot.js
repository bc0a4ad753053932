// One plot: signals of all runs over time, with one unit at the left axis and perhaps another at the right.

const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];
const INKS = ["run-a", "ink", "ink-soft"]; // curves have no hue of a state

class Plot {
  // `spec`: title, unit, least, signals, limits, extra; `plots`: what it is one of.
  constructor(plots, spec) {
    this.plots = plots;
    this.page = plots.page;
    this.spec = { ...spec, signals: [...spec.signals] };
    this.readout = element("div", { class: "readout" });
    this.place = element("div", { class: "canvas", role: "img" });
    const more = element("button", { type: "button", class: "quiet more", "aria-label": `${spec.title}: add a signal`, title: "Add a signal to this plot", on: { click: () => plots.chooser.open(this) } }, "+");
    const close = element("button", { type: "button", class: "quiet close", "aria-label": `${spec.title}: remove`, title: "Remove this plot", on: { click: () => plots.remove(this) } }, "\u00d7");
    this.card = element("section", { class: "card plot", "aria-label": spec.title }, element("div", { class: "plot-title" }, element("b", {}, spec.title), this.readout, element("span", { class: "plot-tools" }, more, close)), this.place);
  }

  get curves() {
    return this.spec.signals.flatMap((name) => this.page.runs.flatMap((run, number) => (run.signals[name] ? [{ run, number, name }] : [])));
  }

  signal(name) { return this.page.runs.map((run) => run.signals[name]).find(Boolean); }

  // Units at the axes; no plot has more than two.
  get units() { return [...new Set(this.spec.signals.map((name) => display(this.signal(name).unit)[0]))]; }

  takes(name) { return this.spec.signals.includes(name) || this.units.includes(display(this.signal(name).unit)[0]) || this.units.length < 2; }

  add(name) {
    if (!this.spec.signals.includes(name)) this.spec.signals.push(name);
    this.build();
  }

  drop(name) {
    this.spec.signals = this.spec.signals.filter((other) => other !== name);
    if (this.spec.signals.length) this.build(); else this.plots.remove(this);
  }

  scale(name) { return this.units.indexOf(display(this.signal(name).unit)[0]) > 0 ? "z" : "y"; }

  values({ run, name }) {
    const [, factor] = display(this.signal(name).unit), first = this.curves[0];
    return Array.from(straightened(run, name, [first.run, first.name]), (value) => (Number.isFinite(value) ? value * factor : null));
  }

  build() {
    const { curves } = this, values = curves.map((curve) => this.values(curve)), kept = this.u && { min: this.u.scales.x.min, max: this.u.scales.x.max };
    const data = this.page.runs.length > 1 ? uPlot.join(curves.map(({ run }, i) => [Array.from(run.time), values[i]])) : [Array.from(curves[0].run.time), ...values];
    if (this.u) this.u.destroy();
    this.u = new uPlot(this.options(curves), data, this.place);
    if (kept) this.u.setScale("x", kept);
    this.head = element("div", { class: "head" });
    this.other = element("div", { class: "head other", hidden: true });
    this.u.over.append(this.head, this.other);
    this.place.setAttribute("aria-label", this.said(curves, values));
    this.readouts(curves);
    this.clicks();
    this.plots.show(this.plots.t);
  }

  // In words what the curves show, for who cannot see them.
  said(curves, values) {
    const range = curves.map(({ run, name }, i) => {
      const known = values[i].filter((value) => value !== null), [unit] = display(this.signal(name).unit);
      const ends = known.length ? `${digits(known.reduce((a, b) => Math.min(a, b)))} to ${digits(known.reduce((a, b) => Math.max(a, b)))} ${unit}` : "no value";
      return `${this.label({ run, name })} ${ends}`;
    });
    return `Curves over time: ${range.join("; ")}`;
  }

  label({ run, name }) {
    const short = name.split(".").slice(1).join(" ").replaceAll("_", " ");
    return this.page.runs.length > 1 ? `${short} ${run.label}` : short;
  }

  options(curves) {
    const axis = { stroke: () => color("ink-soft"), grid: { stroke: () => color("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif", gap: 4 };
    const right = this.units.length > 1, own = (scale) => curves.find(({ name }) => this.scale(name) === scale);
    const side = (scale) => ({ ...axis, scale, space: 26, ...this.marks(own(scale)), label: this.units[scale === "y" ? 0 : 1] || undefined, labelSize: 16, labelGap: 0, labelFont: "11px system-ui, sans-serif" });
    return {
      width: Math.max(200, this.place.clientWidth || 300), height: this.plots.height(),
      legend: { show: false }, padding: [8, right ? 0 : 10, 0, 0],
      cursor: { sync: { key: "apa", setSeries: false }, drag: { x: true, y: false }, points: { size: 6 }, y: false },
      scales: { x: { time: false }, y: { range: (u, low, high) => widened(low, high, this.spec.least || 0) }, ...(right ? { z: { range: (u, low, high) => widened(low, high, 0) } } : {}) },
      axes: [{ ...axis, size: 24, space: 60 }, side("y"), ...(right ? [{ ...side("z"), side: 1, grid: { show: false } }] : [])],
      series: [{}, ...curves.map((curve) => ({
        label: curve.name, scale: this.scale(curve.name), width: 1.75, points: { show: false }, spanGaps: this.page.runs.length > 1,
        stroke: () => this.stroke(curve), dash: this.dash(curve), paths: this.signal(curve.name).held ? uPlot.paths.stepped({ align: 1 }) : undefined,
      }))],
      hooks: {
        setCursor: [(u) => this.plots.hovered(u)],
        setScale: [(u, key) => { if (key === "x") { this.plots.zoomed(u); requestAnimationFrame(() => this.plots.show(this.plots.t)); } }],
        drawClear: [(u) => { this.tube(u); this.limits(u); }],
      },
    };
  }

  // What stands at an axis: numbers, or the names of a mode.
  marks({ run, name }) {
    const { states } = this.signal(name);
    if (!states) return { size: 48, values: (u, marks) => marks.map((mark) => digits(mark)) };
    return { size: 96, incrs: [1, 2, 5, 10], values: (u, marks) => marks.map((mark) => (mark in states ? words(run.stateName(name, mark)) : "")) };
  }

  // Several runs: the colour is the run, the dashes are the signal. One run: blue is measured, violet dashes are requests.
  stroke({ number, name }) {
    if (this.page.runs.length > 1) return runColor(number);
    return this.isAsked(name) ? color("asked") : color(INKS[this.rank(name) % INKS.length]);
  }

  dash({ number, name }) {
    const place = this.spec.signals.indexOf(name);
    if (this.page.runs.length > 1) return this.spec.signals.length > 1 ? DASHES[place % DASHES.length] : number === 1 ? [6, 4] : undefined;
    return this.isAsked(name) ? DASHES[1 + this.rank(name) % 3] : DASHES[Math.floor(this.rank(name) / INKS.length) % DASHES.length];
  }

  isAsked(name) { return Boolean(this.signal(name).asked); }

  // Which of those that are asked, or of those that are.
  rank(name) { return this.spec.signals.filter((other) => this.isAsked(other) === this.isAsked(name)).indexOf(name); }

  limits(u) {
    const [, factor] = display(this.spec.unit);
    for (const value of this.spec.limits || []) {
      const y = u.valToPos(value * factor, "y", true);
      if (y < u.bbox.top || y > u.bbox.top + u.bbox.height) continue;
      u.ctx.save();
      u.ctx.strokeStyle = color("bad");
      u.ctx.setLineDash([4, 4]);
      u.ctx.lineWidth = 1.5 * devicePixelRatio;
      u.ctx.beginPath();
      u.ctx.moveTo(u.bbox.left, y); u.ctx.lineTo(u.bbox.left + u.bbox.width, y);
      u.ctx.stroke();
      u.ctx.restore();
    }
  }

  // Around the first run, if its signals were compared.
  tube(u) {
    for (const name of this.spec.signals) {
      const rule = (this.page.differences || []).find((item) => item.signal === name), run = this.page.runs[0];
      if (!rule || !run.signals[name] || this.signal(name).states) continue;
      const [, factor] = display(this.signal(name).unit), values = straightened(run, name, [run, name]), low = [], high = [];
      for (let x = u.bbox.left; x <= u.bbox.left + u.bbox.width; x += 2 * devicePixelRatio) {
        const t = u.posToVal(x, "x", true);
        if (t > run.duration) break;
        const [least, most] = tube(run, values, rule, t);
        if (Number.isFinite(least)) { low.push([x, u.valToPos(least * factor, this.scale(name), true)]); high.push([x, u.valToPos(most * factor, this.scale(name), true)]); }
      }
      u.ctx.save();
      u.ctx.beginPath();
      u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
      u.ctx.clip();
      u.ctx.beginPath();
      for (const [x, y] of [...low, ...high.reverse()]) u.ctx.lineTo(x, y);
      u.ctx.fillStyle = color("tube");
      u.ctx.fill();
      u.ctx.restore();
    }
  }

  readouts(curves) {
    this.cells = curves.map((curve) => {
      const value = element("span", { class: "value" });
      const chip = element("button", { type: "button", class: "curve", title: `${curve.name}: ${this.signal(curve.name).text}`, "aria-pressed": "true" }, element("i"), this.label(curve), value);
      const place = curves.indexOf(curve) + 1;
      chip.addEventListener("click", () => {
        const shown = !this.u.series[place].show;
        this.u.setSeries(place, { show: shown });
        chip.setAttribute("aria-pressed", String(shown));
        chip.classList.toggle("off", !shown);
      });
      const drop = this.spec.signals.length > 1 && curve.number === 0 ? element("button", { type: "button", class: "quiet drop", "aria-label": `${this.label(curve)}: take out`, title: "Take out of this plot", on: { click: () => this.drop(curve.name) } }, "\u00d7") : null;
      return { ...curve, value, chip, node: element("span", { class: "reading" }, chip, drop) };
    });
    this.readout.replaceChildren(...this.cells.map((cell) => cell.node));
    this.paint();
  }

  // A click goes there; the first one of a double click, which shows all of the time again, is taken back.
  clicks() {
    let start = null, before = 0;
    this.u.over.addEventListener("pointerdown", (event) => { start = event.clientX; });
    this.u.over.addEventListener("click", (event) => {
      if (start === null || Math.abs(event.clientX - start) >= 5) return;
      if (event.detail < 2) before = this.plots.t;
      this.plots.seek(event.detail < 2 ? this.u.posToVal(event.clientX - this.u.over.getBoundingClientRect().left, "x") : before);
    });
  }

  // Values at t, and how much they differ from those at the other cursor.
  write(t, mark) {
    for (const { value, run, name } of this.cells) {
      const { states, unit } = this.signal(name), [, factor] = display(unit), at = (time) => run.at(name, Math.min(time, run.duration));
      const change = mark === null || states ? "" : ` \u0394\u2009${digits((at(t) - at(mark)) * factor)}`;
      const said = states && mark !== null ? `${words(run.stateName(name, at(mark)))} \u2192 ` : "";
      value.textContent = said + (states ? words(run.stateName(name, at(t))) : digits(at(t) * factor)) + change;
    }
  }

  show(t, mark) {
    for (const [node, time] of [[this.head, t], [this.other, mark]]) {
      const left = time === null ? -1 : this.u.valToPos(time, "x");
      node.style.transform = `translateX(${left}px)`;
      node.hidden = !(left >= 0 && left <= this.u.over.clientWidth);
    }
  }

  paint() {
    for (const cell of this.cells) {
      const mark = cell.chip.querySelector("i"), dash = this.dash(cell);
      mark.style.borderTop = `3px ${dash && dash.length ? dash[0] > 3 ? "dashed" : "dotted" : "solid"} ${this.stroke(cell)}`;
    }
    this.u.redraw(false, true);
  }
}
