// The ribbons of states over time, which are also the scrubber.

const MOST_SPANS = 400;

class Timeline {
  constructor(page, seek) {
    /** @type {Map<string, HTMLElement>} */
    this.chips = new Map();
    this.page = page;
    this.box = $("timeline");
    this.duration = Math.max(...page.runs.map((run) => run.duration)) || 1;
    this.box.setAttribute("aria-valuemax", this.duration.toFixed(2));
    this.lines = element("div", { class: "lanes" });
    this.rows = page.ribbons.flatMap((name) => page.runs.flatMap((run, number) => (run.signals[name] ? [{ run, name, number }] : [])));
    for (const { run, name, number } of this.rows) this.lines.append(this.lane(run, name, number));
    this.head = element("div", { class: "head" });
    this.other = element("div", { class: "head other", hidden: true });
    this.field = element("div", { class: "field" }, this.other, this.head);
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

  label(run, name) {
    const parts = name.split("."), isUnique = this.page.ribbons.every((other) => other === name || other.split(".").pop() !== parts.at(-1));
    const short = parts.slice(isUnique ? -1 : -2).join(" ").replaceAll("_", " ");
    return this.page.runs.length > 1 ? `${short} ${run.label}` : short;
  }

  // The chart has hues on a page of one run; where colours are runs, states have names alone.
  color(name, number, state, value) {
    if (this.page.runs.length > 1) return runColor(number);
    return name === this.page.ribbons[0] ? stateColor(state, value) : modeColor(state, value);
  }

  spans(run, name) {
    const all = run.spans(name);
    return all.length > MOST_SPANS ? all.filter((span) => span.to - span.from > this.duration / 2000) : all;
  }

  // The states of a ribbon that none of its pieces has room to name.
  unnamed(run, name, number) {
    const own = [...this.lines.querySelectorAll(`.span[data-signal="${name}"][data-run="${number}"]`)], named = new Set(own.map((node) => node.textContent));
    const left = [...new Set(own.map((node) => words(node.dataset.state)))].filter((state) => !named.has(state));
    return left.length ? `${this.label(run, name)} ${left.join(", ")}` : "";
  }

  // All ribbons as sheet.js draws them.
  lanes() {
    return this.rows.map(({ run, name, number }) => ({
      label: this.label(run, name), duration: this.duration,
      spans: this.spans(run, name).map((span) => { const state = run.stateName(name, span.value); return { ...span, words: words(state), color: this.color(name, number, state, span.value) }; }),
    }));
  }

  lane(run, name, number) {
    const track = element("div", { class: "track" });
    for (const span of this.spans(run, name)) {
      const state = run.stateName(name, span.value), width = (span.to - span.from) / this.duration, fits = width > 0.012 * words(state).length + 0.012;
      track.append(element("span", {
        class: "span", title: `${words(state)}, ${span.from.toFixed(2)} to ${span.to.toFixed(2)} s`,
        "data-signal": name, "data-run": number, "data-state": state, "data-value": span.value,
        style: { left: `${100 * span.from / this.duration}%`, width: `${100 * width}%` },
      }, fits ? words(state) : ""));
    }
    return element("div", { class: number ? "lane second" : "lane", "data-signal": name }, element("span", { class: "label", title: name }, this.label(run, name)), track);
  }

  axis() {
    const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600].find((item) => this.duration / item <= 8) || this.duration / 5;
    const ticks = element("div", { class: "track ticks" });
    for (let t = 0; t <= this.duration * 1.0001; t += step)
      if (t / this.duration < 0.97) ticks.append(element("span", { class: "tick", style: { left: `${100 * t / this.duration}%` } }, `${+t.toFixed(2)} s`));
    return element("div", { class: "lane" }, element("span", { class: "label" }, "time"), ticks);
  }

  legend() {
    const name = this.page.ribbons[0], box = $("legend");
    if (!name) return;
    for (const run of this.page.runs) {
      if (!run.signals[name]) continue;
      for (const span of run.spans(name)) {
        const state = run.stateName(name, span.value);
        if (this.chips.has(state)) continue;
        const chip = element("span", { class: "chip", "data-state": state, "data-value": span.value }, this.page.runs.length > 1 ? null : element("i"), words(state));
        this.chips.set(state, chip);
        box.append(chip);
      }
    }
    if (this.page.runs.length > 1) box.replaceChildren(...this.page.runs.map((run, number) => element("span", { class: "chip" }, element("i", { "data-run": number }), run.about || run.label)));
    const short = this.rows.slice(1).map(({ run, name, number }) => this.unnamed(run, name, number)).filter(Boolean);
    if (short.length) box.append(element("span", { class: "unnamed" }, `Pieces too short for a name: ${short.join("; ")}`));
  }

  paint() {
    for (const node of /** @type {NodeListOf<any>} */ (this.lines.querySelectorAll(".span"))) {
      const { signal, run, state, value } = node.dataset;
      node.style.background = this.color(signal, Number(run), state, Number(value));
    }
    for (const node of /** @type {NodeListOf<any>} */ (document.querySelectorAll(".chip i"))) {
      const { state, value } = node.parentNode.dataset;
      node.style.background = state === undefined ? runColor(Number(node.dataset.run)) : stateColor(state, Number(value));
    }
  }

  show(t, mark = null) {
    this.other.hidden = mark === null;
    if (mark !== null) this.other.style.left = `${100 * Math.min(1, mark / this.duration)}%`;
    this.head.style.left = `${100 * Math.min(1, t / this.duration)}%`;
    this.box.setAttribute("aria-valuenow", t.toFixed(2));
    const run = this.page.runs[0], name = this.page.ribbons[0];
    if (!name || !run.signals[name]) return;
    const state = run.stateName(name, run.at(name, t));
    this.box.setAttribute("aria-valuetext", `${t.toFixed(2)} s, ${words(state)}`);
    for (const [key, chip] of this.chips) chip.classList.toggle("now", key === state);
  }
}
