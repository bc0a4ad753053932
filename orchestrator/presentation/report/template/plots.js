// All curves over time, in uPlot: one pair of cursors and one zoom for all.

class Plots {
  // `seek(t)`: go there; `look(t)`: the pointer is there, null: on no curve.
  constructor(page, box, seek, look) {
    this.page = page;
    this.box = box;
    this.seek = seek;
    this.look = look;
    this.all = [];
    this.t = 0;
    this.mark = null; // time of the other cursor
    this.hover = null;
    this.duration = Math.max(...page.runs.map((run) => run.duration)) || 1;
    for (const spec of page.plots) this.add(spec);
    this.chooser = new Chooser(this, box);
    new ResizeObserver(() => this.resize()).observe(box);
  }

  add(spec) {
    const plot = new Plot(this, spec);
    if (!plot.curves.length) return;
    this.box.insertBefore(plot.card, this.chooser ? this.chooser.box : null);
    this.all.push(plot);
    plot.build();
    const { min, max } = this.all[0].u.scales.x;
    if (plot !== this.all[0] && Number.isFinite(min)) plot.u.setScale("x", { min, max });
  }

  remove(plot) {
    plot.u.destroy();
    plot.card.remove();
    this.all = this.all.filter((other) => other !== plot);
    if (this.chooser.into === plot) this.chooser.shut();
  }

  height() { return window.innerWidth < 700 ? 130 : 118; }

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
    for (const plot of this.all) if (plot.u !== u && min !== undefined && min !== null) plot.u.setScale("x", { min, max });
    this.busy = false;
  }

  // From and to of the time that is shown [s].
  get range() {
    const { min, max } = this.all.length ? this.all[0].u.scales.x : {};
    return Number.isFinite(min) ? [Math.max(0, min), Math.min(this.duration, max)] : [0, this.duration];
  }

  // A shorter (factor over 1) or longer piece of the time, about the cursor.
  zoom(factor) {
    const [from, to] = this.range, width = Math.min(this.duration, Math.max(0.05, (to - from) / factor)), middle = this.t >= from && this.t <= to ? this.t : 0.5 * (from + to);
    const min = Math.min(this.duration - width, Math.max(0, middle - (width * (middle - from)) / (to - from)));
    if (this.all.length) this.all[0].u.setScale("x", { min, max: min + width });
  }

  whole() { if (this.all.length) this.all[0].u.setScale("x", { min: 0, max: this.duration }); }

  write() {
    const t = this.hover === null ? this.t : this.hover;
    for (const plot of this.all) plot.write(t, this.mark);
  }

  show(t) {
    this.t = t;
    for (const plot of this.all) plot.show(t, this.mark);
    this.write();
  }

  paint() { for (const plot of this.all) plot.paint(); }

  resize() {
    for (const plot of this.all) {
      const width = plot.place.clientWidth;
      if (width && width !== plot.u.width) plot.u.setSize({ width, height: this.height() });
    }
    this.show(this.t);
  }
}
