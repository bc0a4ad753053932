// A map: a grid of whole runs over two parameters, computed in a worker, coloured by how they came out.

const CELLS = 20, FARTHEST = 300; // along a side; distance of the last colour [cm]
const OUTCOME_COLOR = { parked: "good", finished: "good", not_parked: "warn", not_finished: "warn", failed: "bad", aborted: "bad" };

class Grid {
  constructor(lab, codes, data, onPick) {
    this.lab = lab;
    this.onPick = onPick;
    this.rows = [];
    this.at = [0, 0];
    this.id = 0;
    const { models, numbers, scenarios, pins, mapped } = data;
    this.parts = { codes, models, numbers, scenarios, pins, mapped };
    $("map-go").addEventListener("click", () => this.start());
    for (const id of ["map-x", "map-y"]) $(id).addEventListener("change", () => this.ranges());
    $("map-color").addEventListener("change", () => { this.key(); this.draw(); });
    const canvas = $("map");
    canvas.addEventListener("click", (event) => { this.move(Math.floor(event.offsetX / canvas.clientWidth * CELLS), CELLS - 1 - Math.floor(event.offsetY / canvas.clientHeight * CELLS)); this.pick(); });
    canvas.addEventListener("pointermove", (event) => this.say(Math.floor(event.offsetX / canvas.clientWidth * CELLS), CELLS - 1 - Math.floor(event.offsetY / canvas.clientHeight * CELLS)));
    canvas.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (way) this.move(this.at[0] + way[0], this.at[1] + way[1]);
      else if (event.key === "Enter") this.pick();
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
  }

  worker() {
    if (this.hand) return this.hand;
    const source = `"use strict";\n${$("core").textContent}\n${work.name}();`;
    this.hand = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    this.hand.onmessage = ({ data }) => this.take(data);
    this.hand.postMessage(this.parts);
    return this.hand;
  }

  // What the two axes can be: numbers that are pinned, or changed.
  fill() {
    const { situation } = this.lab, names = [...new Set([...this.lab.pinned(), ...$("pins").querySelectorAll("code")].map((item) => item.textContent || item))].filter((name) => { const item = situation.known.get(name); return item.kind === "float"; });
    for (const [place, id] of ["map-x", "map-y"].entries()) {
      const kept = $(id).value;
      $(id).replaceChildren(...names.map((name) => element("option", { value: name }, situation.known.get(name).text || name)));
      $(id).value = names.includes(kept) ? kept : names[Math.min(place, names.length - 1)];
    }
    this.ranges();
    this.rows = [];
    this.axes = null;
    this.key();
    this.draw();
    if (!$("mapping").hidden) this.open();
  }

  // Compute the map when its panel is first opened, and anew when it is opened for another scenario or other values.
  open() {
    const { situation } = this.lab, wanted = situation.fragment();
    if (this.wanted === wanted && this.axes) return;
    this.wanted = wanted;
    this.start();
  }

  ranges() {
    for (const axis of ["x", "y"]) {
      const item = this.lab.situation.known.get($(`map-${axis}`).value), [unit, factor] = display(item.unit), ends = sliderRange(item);
      ["low", "high"].forEach((end, i) => { $(`map-${axis}-${end}`).value = threeDigits(ends[i] * factor); });
      $(`map-${axis}-unit`).textContent = unit;
    }
  }

  axis(name) {
    const item = this.lab.situation.known.get($(`map-${name}`).value);
    const [low, high] = ["low", "high"].map((end) => fromShown($(`map-${name}-${end}`).value, item));
    const values = Array.from({ length: CELLS }, (_, i) => low + (high - low) * i / (CELLS - 1));
    return { name: item.name, values, wrong: this.lab.situation.wrong(item.name, low) || this.lab.situation.wrong(item.name, high) };
  }

  start() {
    this.axes = [this.axis("x"), this.axis("y")];
    const wrong = this.axes.map((axis) => axis.wrong).find(Boolean);
    $("map-said").textContent = wrong || (this.axes[0].name === this.axes[1].name ? "choose two different parameters" : "computing\u2026");
    if (wrong || this.axes[0].name === this.axes[1].name) return;
    this.rows = [];
    this.at = [0, 0];
    this.id += 1;
    const axes = this.axes.map(({ name, values }) => ({ name, values }));
    this.worker().postMessage({ id: this.id, scenario: this.lab.situation.data.name, changes: this.lab.situation.changes, axes });
  }

  take({ id, number, cells, took }) {
    if (id !== this.id) return;
    if (cells) { this.rows[number] = cells; $("map-said").textContent = `${this.rows.flat().length} of ${CELLS * CELLS} runs\u2026`; }
    else {
      const all = this.rows.flat(), good = all.filter((cell) => cell.outcome === this.lab.situation.data.success).length;
      $("map-said").textContent = `${all.length} runs in ${(took / 1000).toFixed(2)} s; ${good} ${this.lab.situation.data.success}`;
      $("map").dataset.done = String(id);
    }
    this.key();
    this.draw();
  }

  // What the colours mean, and how often each is there.
  key() {
    const count = (outcome) => this.rows.flat().filter((cell) => cell.outcome === outcome).length, isOutcome = $("map-color").value === "outcome";
    const pills = Object.keys(OUTCOME_COLOR).filter((outcome) => count(outcome)).map((outcome) => element("span", {}, badge({ outcome }), ` ${count(outcome)} `));
    $("map-key").replaceChildren(...(isOutcome || !pills.length ? pills : [element("span", { class: "ramp", "aria-hidden": "true" }), `on the target to ${FARTHEST / 100} m off and more`]));
  }

  paint(cell) {
    if ($("map-color").value === "outcome") return color(OUTCOME_COLOR[cell.outcome] || "idle");
    const share = Math.min(1, Math.log10(1 + cell.error * 100) / Math.log10(1 + FARTHEST));
    return Number.isFinite(share) ? `color-mix(in oklab, ${color("good")} ${Math.round(100 * (1 - share))}%, ${color("bad")})` : color("idle");
  }

  draw() {
    const canvas = $("map"), g = canvas.getContext("2d"), size = canvas.width / CELLS;
    g.clearRect(0, 0, canvas.width, canvas.height);
    g.fillStyle = color("grid");
    g.fillRect(0, 0, canvas.width, canvas.height);
    this.rows.forEach((cells, y) => cells.forEach((cell, x) => { g.fillStyle = this.paint(cell); g.fillRect(x * size, (CELLS - 1 - y) * size, size - 1, size - 1); }));
    if (!this.axes) return;
    g.strokeStyle = color("ink");
    g.lineWidth = 2;
    g.strokeRect(this.at[0] * size + 1, (CELLS - 1 - this.at[1]) * size + 1, size - 3, size - 3);
    const now = this.axes.map(({ name, values }) => (this.lab.situation.get(name) - values[0]) / (values[CELLS - 1] - values[0]) * (CELLS - 1) + 0.5);
    g.beginPath();
    g.arc(now[0] * size, (CELLS - now[1]) * size, 5, 0, 2 * Math.PI);
    g.fillStyle = color("ink");
    g.fill();
  }

  move(x, y) {
    this.at = [x, y].map((value) => Math.min(CELLS - 1, Math.max(0, value)));
    this.say(...this.at);
    this.draw();
  }

  say(x, y) {
    const cell = this.rows[y] && this.rows[y][x];
    if (!cell || !this.axes) return;
    const where = this.axes.map(({ name, values }, i) => { const item = this.lab.situation.known.get(name); return `${item.text.split(",")[0] || name} ${quantity(values[[x, y][i]], item.unit)}`; });
    $("map-cell").textContent = `${where.join(", ")}: ${cell.outcome.replace("_", " ")}, ${cell.reason.replaceAll("_", " ")}${Number.isFinite(cell.error) ? `, ${digits(100 * cell.error)} cm off` : ""}`;
  }

  pick() {
    if (!this.axes || !this.rows[this.at[1]]) return;
    this.onPick(this.axes.map(({ name, values }, i) => [name, values[this.at[i]]]));
  }
}
