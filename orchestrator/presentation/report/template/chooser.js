// The list of all signals: found by name or meaning, those that change first.

const MOST_LISTED = 60;

class Chooser {
  constructor(plots, box) {
    this.plots = plots;
    this.into = null; // the plot that takes the next one; null: a new plot
    const { runs } = plots.page, names = [...new Set(runs.flatMap((run) => Object.keys(run.signals)))].sort();
    const signal = (name) => runs.map((run) => run.signals[name]).find(Boolean), moves = (name) => runs.some((run) => run.signals[name] && run.signals[name].a !== undefined);
    this.all = [...names.filter(moves), ...names.filter((name) => !moves(name))].map((name) => ({ name, moves: moves(name), ...signal(name) }));
    this.field = element("input", { type: "search", placeholder: `Add a curve: one of ${names.length} signals`, "aria-label": "Find a signal to plot", "aria-controls": "signals" });
    this.said = element("p", { class: "quiet said", role: "status" });
    this.list = element("ul", { id: "signals", class: "signals", "aria-label": "Signals" });
    this.box = element("section", { class: "card chooser", "aria-label": "Add a curve" }, this.field, this.said, this.list);
    box.append(this.box);
    for (const event of ["input", "focus"]) this.field.addEventListener(event, () => this.fill());
    this.field.addEventListener("keydown", (event) => {
      const first = this.list.querySelector("button");
      if (event.key === "Escape") this.shut();
      else if (event.key === "Enter" && first) first.click();
      else if (event.key === "ArrowDown" && first) { first.focus(); event.preventDefault(); }
    });
    this.list.addEventListener("keydown", (event) => {
      const way = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling" }[event.key], next = way && event.target.closest("li")[way];
      if (event.key === "Escape") { this.shut(); this.field.focus(); }
      if (!way) return;
      (next ? next.querySelector("button") : this.field).focus();
      event.preventDefault();
      event.stopPropagation();
    });
    this.shut();
  }

  // What is picked next goes into `plot`.
  open(plot) {
    this.into = plot;
    this.fill();
    this.field.focus();
    this.box.scrollIntoView({ block: "nearest" });
  }

  shut() {
    this.into = null;
    this.field.value = "";
    this.list.replaceChildren();
    this.said.textContent = "";
  }

  fill() {
    const parts = this.field.value.trim().toLowerCase().split(/\s+/), whole = (item) => `${item.name} ${item.text}`.toLowerCase();
    const found = this.all.filter((item) => parts.every((part) => whole(item).includes(part))), rest = found.length - MOST_LISTED;
    this.list.replaceChildren(...found.slice(0, MOST_LISTED).map((item) => this.row(item)));
    this.said.textContent = `${this.into ? `Into "${this.into.spec.title}"` : "Into a plot of its own"}: ${found.length} found${rest > 0 ? `, ${MOST_LISTED} shown` : ""}; those that change come first. Escape closes the list.`;
  }

  row(item) {
    const fits = !this.into || this.into.takes(item.name), [unit] = display(item.unit);
    const what = `${item.moves ? "" : "constant: "}${item.text}${unit ? ` [${unit}]` : ""}${fits ? "" : ` - the plot has two units already: ${this.into.units.join(", ")}`}`;
    const button = element("button", { type: "button", disabled: !fits, class: item.moves ? "" : "still", on: { click: () => this.pick(item.name) } }, element("code", {}, item.name), element("span", { class: "quiet" }, ` ${what}`));
    return element("li", {}, button);
  }

  pick(name) {
    const item = this.all.find((other) => other.name === name), into = this.into;
    if (!item || (into && !into.takes(name))) return;
    this.shut();
    if (into) into.add(name); else this.plots.add({ title: name, unit: item.unit, signals: [name], least: 0, limits: [] });
    this.field.focus();
    this.list.replaceChildren();
    this.said.textContent = `${name} is shown`;
  }
}
