// What a chart decides on while it runs: the guards of its state, which of them hold, and where each leads.

class LiveChart extends StateChart {
  drawn(chart) {
    const box = super.drawn(chart), count = ([name]) => this.leaving(chart, name).length;
    chart.deciding = element("div", { class: "deciding", style: { "--rows": Math.max(...Object.entries(chart.states).map(count)) } });
    chart.past.before(chart.deciding);
    return box;
  }

  // The rows that leave a state, in order of priority; those for any state do not leave an end.
  leaving(chart, state) {
    return chart.rows.some(([source]) => source === state) ? chart.rows.filter(([source]) => source === state || source === "any state") : [];
  }

  // As it is in `drive` now; nothing of a chart that did not decide.
  decide(drive) {
    for (const chart of this.own) {
      const found = drive.decided(chart.place), key = found ? `${found.state} ${found.guards}` : "";
      if (chart.decided === key) continue;
      chart.decided = key;
      chart.deciding.replaceChildren(...(found ? this.lines(chart, drive.history.stateName(`controller.${chart.signal}`, found.state), found.guards) : []));
    }
  }

  lines(chart, state, guards) {
    const rows = this.leaving(chart, state), holds = (guard) => Math.floor(guards / 2 ** guard) % 2 === 1, taken = rows.find(([, guard]) => holds(guard));
    const line = (row) => {
      const [, guard, target] = row, [name, text] = chart.guards[guard];
      return element("li", { class: holds(guard) && "holds" }, element("b", {}, holds(guard) ? "\u2713 holds" : "\u2013 not"), element("span", {}, `${words(name)} \u2192 ${words(target)}${row === taken ? ", taken" : ""}`, text && element("span", { class: "quiet" }, ` ${text}`)));
    };
    return rows.length ? [element("p", { class: "quiet" }, `Guards in ${words(state)}`), element("ul", { "aria-label": "Guards" }, ...rows.map(line))] : [];
  }
}
