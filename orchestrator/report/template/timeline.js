// The ribbons of states over time, which are also the scrubber.

const MOST_SPANS = 400;

class Timeline {
  constructor(page, seek) {
    this.page = page;
    this.box = $("timeline");
    this.duration = Math.max(...page.runs.map((run) => run.duration)) || 1;
    this.box.setAttribute("aria-valuemax", this.duration.toFixed(2));
    this.lines = element("div", { class: "lanes" });
    for (const name of page.ribbons)
      page.runs.forEach((run, number) => { if (run.signals[name]) this.lines.append(this.lane(run, name, number)); });
    this.head = element("div", { class: "head" });
    this.field = element("div", { class: "field" }, this.head);
    this.lines.append(this.axis(), this.field);
    this.box.append(this.lines);
    this.legend();
    let held = false;
    const at = (event) => {
      const area = this.field.getBoundingClientRect();
      seek(Math.min(1, Math.max(0, (event.clientX - area.left) / area.width)) * this.duration);
    };
    this.box.addEventListener("pointerdown", (event) => { held = true; this.box.setPointerCapture(event.pointerId); at(event); });
    this.box.addEventListener("pointermove", (event) => { if (held) at(event); });
    for (const name of ["pointerup", "pointercancel"]) this.box.addEventListener(name, () => { held = false; });
  }

  lane(run, name, number) {
    const short = name.split(".").pop().replaceAll("_", " ");
    const label = this.page.runs.length > 1 ? `${short} ${run.label}` : short;
    const track = element("div", { class: "track" });
    let spans = run.spans(name);
    if (spans.length > MOST_SPANS) spans = spans.filter((span) => span.to - span.from > this.duration / 2000);
    for (const span of spans) {
      const state = run.stateName(name, span.value), width = (span.to - span.from) / this.duration;
      track.append(element("span", {
        class: "span", title: `${words(state)}, ${span.from.toFixed(2)} to ${span.to.toFixed(2)} s`,
        "data-state": state, "data-value": span.value,
        style: { left: `${100 * span.from / this.duration}%`, width: `${100 * width}%` },
      }, width > 0.012 * words(state).length + 0.012 ? words(state) : ""));
    }
    return element("div", { class: number ? "lane second" : "lane", "data-signal": name }, element("span", { class: "label", title: name }, label), track);
  }

  axis() {
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find((item) => this.duration / item <= 8) || this.duration / 5;
    const ticks = element("div", { class: "track ticks" });
    for (let t = 0; t <= this.duration * 1.0001; t += step)
      if (t / this.duration < 0.97) ticks.append(element("span", { class: "tick", style: { left: `${100 * t / this.duration}%` } }, `${+t.toFixed(2)} s`));
    return element("div", { class: "lane" }, element("span", { class: "label" }, "time"), ticks);
  }

  legend() {
    this.chips = new Map();
    const name = this.page.ribbons[0], box = $("legend");
    if (!name) return;
    for (const run of this.page.runs) {
      if (!run.signals[name]) continue;
      for (const span of run.spans(name)) {
        const state = run.stateName(name, span.value);
        if (this.chips.has(state)) continue;
        const chip = element("span", { class: "chip", "data-state": state, "data-value": span.value }, element("i"), words(state));
        this.chips.set(state, chip);
        box.append(chip);
      }
    }
  }

  paint() {
    for (const node of document.querySelectorAll(".span, .chip i")) {
      const owner = node.matches("i") ? node.parentNode : node;
      node.style.background = stateColor(owner.dataset.state, Number(owner.dataset.value));
    }
  }

  show(t) {
    this.head.style.left = `${100 * Math.min(1, t / this.duration)}%`;
    this.box.setAttribute("aria-valuenow", t.toFixed(2));
    const run = this.page.runs[0], name = this.page.ribbons[0];
    if (!name || !run.signals[name]) return;
    const state = run.stateName(name, run.at(name, t));
    this.box.setAttribute("aria-valuetext", `${t.toFixed(2)} s, ${words(state)}`);
    for (const [key, chip] of this.chips) chip.classList.toggle("now", key === state);
  }
}
