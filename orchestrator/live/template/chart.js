// The state machine while it runs: the state it is in, the way it came, what each state does and where it is written.

class LiveChart {
  constructor(lab, charts) {
    this.lab = lab;
    this.charts = charts;
  }

  fill() {
    const system = this.lab.system;
    this.own = this.charts.filter((chart) => chart.values.includes(system));
    $("chart").replaceChildren(...this.own.map((chart) => {
      const box = element("figure", { class: "chart-box" }, element("figcaption", {}, chart.signal, element("span", { class: "quiet" }, ` ${chart.file}`)));
      box.append(document.importNode(new DOMParser().parseFromString(chart.svg, "image/svg+xml").documentElement, true));
      for (const node of box.querySelectorAll("[data-state]")) {
        const state = chart.states[node.dataset.state];
        const tell = () => { $("chart-said").textContent = `${words(node.dataset.state)}: ${state.text}${state.leaves.length ? ` Leaves: ${state.leaves.join("; ")}.` : ""}`; };
        node.setAttribute("tabindex", "0");
        node.setAttribute("role", "img");
        node.setAttribute("aria-label", words(node.dataset.state));
        for (const event of ["pointerenter", "focus"]) node.addEventListener(event, tell);
      }
      chart.box = box;
      return box;
    }));
    $("chart-none").hidden = this.own.length > 0;
    this.now = null;
    this.past = [];
    this.lines();
  }

  show(history) {
    for (const chart of this.own) {
      const name = `controller.${chart.signal}`, values = history.values(name), state = history.stateName(name, history.last(name));
      if (chart.now === state && chart.of === history) continue;
      const before = chart.of === history ? chart.now : null;
      chart.now = state;
      chart.of = history;
      for (const node of chart.box.querySelectorAll(".on")) node.classList.remove("on");
      for (const node of chart.box.querySelectorAll(`[data-state="${state}"]`)) node.classList.add("on");
      if (before === null) { this.past = []; this.lines(); continue; }
      const fits = (arc) => (arc.dataset.from === before || arc.dataset.from === "any state") && arc.dataset.to === state;
      const arcs = [...chart.box.querySelectorAll("[data-from]")].filter(fits);
      for (const arc of arcs) arc.classList.add("on");
      this.past.unshift(`${history.time[values.length - 1].toFixed(2)} s  ${words(before)} \u2192 ${words(state)}${arcs.length ? `  (${arcs.map((arc) => arc.dataset.guards).join(", ")})` : ""}`);
      this.past.length = Math.min(this.past.length, 8);
      this.lines();
    }
  }

  lines() { $("chart-past").replaceChildren(...this.past.map((text) => element("li", {}, text))); }
}
