// Curves over time with one cursor and one zoom for all, drawn by uPlot.

class Plots {
  // `seek(t)`: go there; `look(t)`: the pointer is there, null: on no curve.
  constructor(page, box, seek, look) {
    this.page = page;
    this.box = box;
    this.seek = seek;
    this.look = look;
    this.all = [];
    this.t = 0;
    this.hover = null;
    this.duration = Math.max(...page.runs.map((run) => run.duration)) || 1;
    for (const plot of page.plots) this.add(plot);
    this.chooser();
    new ResizeObserver(() => this.resize()).observe(box);
  }

  // Rows of [run, name] that one plot shows.
  curves(plot) {
    return plot.signals.flatMap((name) => this.page.runs.filter((run) => run.signals[name]).map((run) => [run, name]));
  }

  add(plot) {
    const curves = this.curves(plot);
    if (!curves.length) return;
    const [unit, factor] = display(plot.unit);
    const values = curves.map(([run, name]) => Array.from(straightened(run, name, curves[0]), (value) => (Number.isFinite(value) ? value * factor : null)));
    const data = this.page.runs.length > 1
      ? uPlot.join(curves.map(([run], i) => [Array.from(run.time), values[i]]))
      : [Array.from(curves[0][0].time), ...values];
    const readout = element("div", { class: "readout" });
    const place = element("div", { class: "canvas" });
    const card = element("div", { class: "card plot" }, element("div", { class: "plot-title" },
      element("b", {}, plot.title), element("span", { class: "unit" }, unit ? `[${unit}]` : ""), readout,
      plot.extra ? element("button", { type: "button", class: "quiet close", title: "Remove", on: { click: () => this.remove(item) } }, "\u00d7") : null), place);
    this.box.insertBefore(card, this.choice || null);
    const item = { plot, curves, factor, card, readout, place };
    item.u = new uPlot(this.options(item), data, place);
    item.head = element("div", { class: "head" });
    item.u.over.append(item.head);
    this.readouts(item);
    this.clicks(item);
    this.all.push(item);
    this.show(this.t);
  }

  remove(item) {
    item.u.destroy();
    item.card.remove();
    this.all = this.all.filter((other) => other !== item);
  }

  options(item) {
    const axis = { stroke: () => color("ink-soft"), grid: { stroke: () => color("grid"), width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif", gap: 4 };
    return {
      width: Math.max(200, item.place.clientWidth || 300), height: this.height(),
      legend: { show: false }, padding: [8, 10, 0, 0],
      cursor: { sync: { key: "apa", setSeries: false }, drag: { x: true, y: false }, points: { size: 6 }, y: false },
      scales: { x: { time: false }, y: { range: (u, low, high) => widened(low, high, item.plot.least || 0) } },
      axes: [{ ...axis, size: 24, space: 60 }, { ...axis, space: 26, ...this.marks(item) }],
      series: [{}, ...item.curves.map(([run, name], number) => ({
        label: name, width: 1.75, points: { show: false }, spanGaps: this.page.runs.length > 1,
        stroke: () => this.stroke(item, number), dash: run === this.page.runs[1] ? [6, 4] : undefined,
        paths: run.signals[name].held ? uPlot.paths.stepped({ align: 1 }) : undefined,
      }))],
      hooks: {
        setCursor: [(u) => this.hovered(u)],
        setScale: [(u, key) => { if (key === "x") { this.zoomed(u); requestAnimationFrame(() => this.show(this.t)); } }],
        drawClear: [(u) => this.limits(u, item)],
      },
    };
  }

  // What stands at the y axis: numbers, or the names of a mode.
  marks(item) {
    const [run, name] = item.curves[0];
    if (!run.signals[name].states) return { size: 48, values: (u, marks) => marks.map((mark) => digits(mark)) };
    return { size: 96, incrs: [1, 2, 5, 10], values: (u, marks) => marks.map((mark) => (mark in run.signals[name].states ? words(run.stateName(name, mark)) : "")) };
  }

  height() { return window.innerWidth < 700 ? 130 : 118; }

  stroke(item, number) {
    const [run, name] = item.curves[number];
    if (this.page.runs.length > 1 && item.plot.signals.length === 1) return color(run === this.page.runs[1] ? "run-b" : "run-a");
    return color(`s${item.plot.signals.indexOf(name) % 8}`);
  }

  limits(u, item) {
    for (const value of item.plot.limits || []) {
      const y = u.valToPos(value * item.factor, "y", true);
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

  readouts(item) {
    item.values = item.curves.map(([run, name], number) => {
      const short = name.split(".").slice(1).join(" ").replaceAll("_", " ");
      const value = element("span", { class: "value" });
      const chip = element("button", { type: "button", class: "curve", title: `${name}: ${run.signals[name].text}` },
        element("i"), this.page.runs.length > 1 ? `${short} ${run.label}` : short, value);
      chip.addEventListener("click", () => {
        const shown = !item.u.series[number + 1].show;
        item.u.setSeries(number + 1, { show: shown });
        chip.classList.toggle("off", !shown);
      });
      item.readout.append(chip);
      return { value, chip, run, name, number };
    });
  }

  clicks(item) {
    let start = null;
    item.u.over.addEventListener("pointerdown", (event) => { start = event.clientX; });
    item.u.over.addEventListener("click", (event) => {
      if (start !== null && Math.abs(event.clientX - start) < 5)
        this.seek(item.u.posToVal(event.clientX - item.u.over.getBoundingClientRect().left, "x"));
    });
  }

  hovered(u) {
    const before = this.hover;
    this.hover = u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") : null;
    this.write();
    if (before !== this.hover) this.look(this.hover);
  }

  zoomed(u) {
    if (this.busy) return;
    this.busy = true;
    const { min, max } = u.scales.x;
    for (const item of this.all) if (item.u !== u && min !== undefined && min !== null) item.u.setScale("x", { min, max });
    this.busy = false;
  }

  write() {
    const t = this.hover === null ? this.t : this.hover;
    for (const item of this.all)
      for (const { value, run, name } of item.values) {
        const number = run.at(name, Math.min(t, run.duration));
        value.textContent = run.signals[name].states ? words(run.stateName(name, number)) : digits(number * item.factor);
      }
  }

  show(t) {
    this.t = t;
    for (const item of this.all) {
      const left = item.u.valToPos(t, "x");
      item.head.style.transform = `translateX(${left}px)`;
      item.head.hidden = !(left >= 0 && left <= item.u.over.clientWidth);
    }
    this.write();
  }

  paint() {
    for (const item of this.all) {
      item.values.forEach(({ chip, number, run }) => {
        const mark = chip.querySelector("i"), second = this.page.runs.length > 1 && run === this.page.runs[1];
        mark.style.background = second ? "none" : this.stroke(item, number);
        mark.style.border = `2px ${second ? "dashed" : "solid"} ${this.stroke(item, number)}`;
      });
      item.u.redraw(false);
    }
  }

  resize() {
    for (const item of this.all) if (item.place.clientWidth > 50) item.u.setSize({ width: item.place.clientWidth, height: this.height() });
    this.show(this.t);
  }

  // All signals to add, those that change first.
  chooser() {
    const { runs } = this.page, signal = (name) => runs.map((run) => run.signals[name]).find(Boolean);
    const names = [...new Set(runs.flatMap((run) => Object.keys(run.signals)))].sort();
    const moves = (name) => runs.some((run) => run.signals[name] && run.signals[name].a !== undefined);
    const ordered = [...names.filter(moves), ...names.filter((name) => !moves(name))];
    const list = element("datalist", { id: "signals" }, ordered.map((name) => element("option", { value: name }, moves(name) ? signal(name).text : `constant: ${signal(name).text}`)));
    const choice = element("input", { type: "search", list: "signals", placeholder: `Add a plot: one of ${names.length} signals`, "aria-label": "Add a plot of any signal" });
    choice.addEventListener("change", () => {
      const name = choice.value.trim();
      if (!signal(name)) return;
      choice.value = "";
      this.add({ title: name, unit: signal(name).unit, signals: [name], extra: true });
      this.paint();
    });
    this.choice = element("div", { class: "chooser" }, choice, list);
    this.box.append(this.choice);
  }
}

// Values of a signal; headings without jumps of whole turns, and beside the first heading of the plot.
function straightened(run, name, [firstRun, firstName]) {
  const values = run.values(name);
  if (!run.signals[name].turn) return values;
  const turns = (difference) => 2 * Math.PI * Math.round(difference / (2 * Math.PI));
  const result = Float64Array.from(values);
  if (run === firstRun && name === firstName) {
    for (let i = 1; i < result.length; i++) if (Number.isFinite(result[i] + result[i - 1])) result[i] += turns(result[i - 1] - result[i]);
    return result;
  }
  const base = straightened(firstRun, firstName, [firstRun, firstName]);
  for (let i = 0; i < result.length; i++) {
    const beside = base[firstRun.row(run.time[i])];
    if (Number.isFinite(beside + result[i])) result[i] += turns(beside - result[i]);
  }
  return result;
}

// A y range with some air, never narrower than `least`, and never empty.
function widened(low, high, least) {
  if (low === null || high === null) return [-1, 1];
  const span = Math.max(high - low, least, 1e-9 * Math.max(Math.abs(low), Math.abs(high)), 1e-6), middle = (low + high) / 2;
  return [middle - 0.56 * span, middle + 0.56 * span];
}
