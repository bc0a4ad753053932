// A state machine beside a run: the state it is in, the way it came, what each state does and where it is written.

const SMALLEST = 0.85; // no smaller than so much of its own size, which can be read; then it is scrolled

class StateChart {
  constructor() { this.own = []; }

  // Show the charts of one system.
  fill(charts) {
    this.own = charts.map((chart) => ({ ...chart, key: "" }));
    $("chart").replaceChildren(...this.own.map((chart) => this.drawn(chart)));
    $("chart-none").hidden = this.own.length > 0;
  }

  drawn(chart) {
    chart.past = element("ol", { class: "past", "aria-label": "Last transitions" });
    chart.box = element("figure", { class: "chart-box" }, element("figcaption", {}, chart.signal, element("span", { class: "quiet" }, ` ${chart.file}`)), chart.past);
    const svg = /** @type {any} */ (document.importNode(new DOMParser().parseFromString(chart.svg, "image/svg+xml").documentElement, true));
    svg.style.minWidth = `${SMALLEST * svg.viewBox.baseVal.width}px`;
    chart.sheet = element("div", { class: "chart-sheet" });
    chart.sheet.append(svg);
    chart.box.append(chart.sheet);
    for (const node of chart.box.querySelectorAll("[data-state]")) {
      const { state } = node.dataset, leaves = chart.rows.filter(([source]) => source === state).map(([, guard, target]) => `to ${words(target)} when ${chart.guards[guard][1] || words(chart.guards[guard][0])}`);
      const tell = () => { $("chart-said").textContent = `${words(state)}: ${chart.states[state]}${leaves.length ? ` Leaves: ${leaves.join("; ")}.` : ""}`; };
      const tellNow = () => { if (chart.on && !chart.box.contains(document.activeElement)) chart.on.tellState(); };
      /** @type {any} */ (node).tellState = tell;
      node.addEventListener("pointerleave", tellNow);
      node.setAttribute("tabindex", "0");
      node.setAttribute("role", "img");
      node.setAttribute("aria-label", words(node.dataset.state));
      for (const event of ["pointerenter", "focus"]) node.addEventListener(event, tell);
    }
    return chart.box;
  }

  // The column of states stands in the middle when the chart is first seen.
  centre(chart) {
    const box = chart.on.getBoundingClientRect(), sheet = chart.sheet.getBoundingClientRect();
    chart.sheet.scrollLeft += box.left + 0.5 * box.width - sheet.left - 0.5 * sheet.width;
    chart.isCentred = true;
  }

  // The guards for which a state was left at `at`: one of those of the arcs to the next.
  why(_chart, _at, arcs) { return arcs.map((arc) => words(arc.dataset.guards)).join(", "); }

  // As it is in `run` at `t`.
  show(run, t) {
    for (const chart of this.own) {
      const name = `controller.${chart.signal}`, spans = run.spans(name).filter((span) => span.from <= t);
      const states = spans.map((span) => run.stateName(name, span.value)), key = `${spans.length} ${states[states.length - 1]} ${spans.length && spans[spans.length - 1].from}`;
      if (!chart.isCentred && chart.on && chart.sheet.clientWidth) this.centre(chart);
      if (chart.key === key) continue;
      chart.key = key;
      for (const node of chart.box.querySelectorAll(".on")) node.classList.remove("on");
      const last = states.length - 1, arcs = (i) => [...chart.box.querySelectorAll("[data-from]")].filter(({ dataset }) => (dataset.from === states[i - 1] || dataset.from === "any state") && dataset.to === states[i]);
      for (const node of chart.box.querySelectorAll(`[data-state="${states[last]}"]`)) { node.classList.add("on"); chart.on = node; if (chart === this.own[0] && !chart.box.matches(":hover, :focus-within")) node.tellState(); }
      if (last > 0) for (const arc of arcs(last)) arc.classList.add("on");
      const lines = states.map((state, i) => (i === 0 ? "" : `${spans[i].from.toFixed(2)} s  ${words(states[i - 1])} \u2192 ${words(state)}${this.why(chart, spans[i].from, arcs(i)).replace(/(.+)/, "  ($1)")}`));
      chart.past.replaceChildren(...lines.slice(1).slice(-8).reverse().map((line) => element("li", {}, line)));
    }
  }
}
