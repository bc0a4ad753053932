// What a chart decides on while it runs: the guards of its state, which of them hold, and where each leads.

const guardHolds = (guards, guard) => Math.floor(guards / 2 ** guard) % 2 === 1;

class LiveChart extends StateChart {
  drawn(chart) {
    const box = super.drawn(chart), most = Math.max(...Object.keys(chart.states).map((name) => this.leaving(chart, name).length));
    chart.deciding = element("div", { class: "deciding", style: { "--rows": most } });
    chart.past.before(chart.deciding);
    return box;
  }

  // The rows that leave a state, in order of priority; those for any state do not leave an end.
  leaving(chart, state) {
    return chart.rows.some(([source]) => source === state) ? chart.rows.filter(([source]) => source === state || source === "any state") : [];
  }

  // The state a chart decided in at the latest sample, its rows, the guards and the row taken; null if it did not.
  decision(chart, drive) {
    const found = drive.decided(chart.place);
    if (!found) return null;
    const state = drive.history.stateName(`controller.${chart.signal}`, found.state), rows = this.leaving(chart, state);
    return { state, rows, guards: found.guards, taken: rows.find(([, guard]) => guardHolds(found.guards, guard)) };
  }

  // Before a run.
  begin() { for (const chart of this.own) chart.reasons = new Map(); }

  // After a step: why a state was left.
  note(drive) {
    for (const chart of this.own) {
      const found = this.decision(chart, drive);
      if (found && found.taken) chart.reasons.set(drive.t, words(chart.guards[found.taken[1]][0]));
    }
  }

  why(chart, at, arcs) { return chart.reasons.get(at) || super.why(chart, at, arcs); }

  // As it is in `drive` now; nothing of a chart that did not decide.
  decide(drive) {
    for (const chart of this.own) {
      const found = this.decision(chart, drive), key = found ? `${found.state} ${found.guards}` : "";
      if (chart.decided === key) continue;
      chart.decided = key;
      chart.deciding.replaceChildren(...(found && found.rows.length ? this.lines(chart, found) : []));
    }
  }

  lines(chart, { state, rows, guards, taken }) {
    const line = (row) => {
      const [, guard, target] = row, [name, text] = chart.guards[guard], holds = guardHolds(guards, guard);
      return element("li", { class: holds && "holds" }, element("b", {}, holds ? "\u2713 holds" : "\u2013 not"), element("span", {}, `${words(name)} \u2192 ${words(target)}${row === taken ? ", taken" : ""}`, text && element("span", { class: "quiet" }, `: ${text}`)));
    };
    const besides = Object.keys(chart.guards).filter((guard) => guardHolds(guards, Number(guard)) && !rows.some((row) => row[1] === Number(guard)));
    return [
      element("p", { class: "quiet" }, `Guards of the state ${words(state)}`),
      element("ul", { "aria-label": "Guards" }, ...rows.map(line)),
      besides.length ? element("p", { class: "quiet" }, `Hold too, of no effect here: ${besides.map((guard) => words(chart.guards[guard][0])).join(", ")}`) : "",
    ];
  }
}
