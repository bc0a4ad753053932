// How a run came out: verdict, figures and checks of this drive beside those of the driver modelled.

const FIGURES = ["duration", "manoeuvres", "max_speed", "final.lateral_error", "final.longitudinal_error", "final.heading_error", "final.outline_margin", "min_clearance", "penetration", "steering_travel"];

const said = (found) => `${found.outcome.replace("_", " ")}${found.reason === "all checks passed" ? "" : `: ${found.reason.replaceAll("_", " ")}`}`;

const badge = (found) => element("span", { class: `pill ${OUTCOME_COLOR[found.outcome]}` }, found.outcome.replace("_", " "));

function shortly(found) {
  const n = found.numbers, parts = [`${n.duration.toFixed(2)} s`];
  if (Number.isFinite(n.manoeuvres)) parts.push(`${n.manoeuvres} manoeuvre${n.manoeuvres === 1 ? "" : "s"}`);
  if (Number.isFinite(n["final.lateral_error"])) parts.push(`${(100 * n["final.lateral_error"]).toFixed(1)} cm lateral`, `${(n["final.heading_error"] * 180 / Math.PI).toFixed(2)}\u00b0`);
  return parts.join(" \u00b7 ");
}

function showResult(lab, mine, byHand, ghost) {
  const runs = [...(mine ? [[byHand ? "manual" : "this run", mine]] : []), ["driver model", ghost]];
  const rows = FIGURES.filter((name) => runs.some(([, found]) => Number.isFinite(found.numbers[name]) && Math.abs(found.numbers[name]) < 1e8))
    .map((name) => row([element("th", { scope: "row" }, words(name.replace("final.", ""))), ...runs.map(([, found]) => numberCell(Math.abs(found.numbers[name]) < 1e8 ? quantity(found.numbers[name], lab.table[name].unit) : "\u2013"))]));
  const checks = ghost.checks.map((check, i) => row([element("th", { scope: "row" }, `${check.id} ${check.text}`, element("span", { class: "quiet" }, ` ${check.source}`)), ...runs.map(([, found]) => {
    const own = found.checks[i];
    return element("td", {}, own.evaluated ? pill(own.passed, own.required) : element("span", { class: "pill warn" }, "not evaluated here"), " ", own.never ? "never" : Number.isFinite(own.value) ? quantity(own.value, own.number ? lab.table[own.signal].unit : unitOf(lab, own.signal)) : "\u2013");
  })]));
  const head = ["", ...runs.map(([name]) => name)];
  $("result").replaceChildren(
    element("div", { class: "ends" }, runs.map(([name, found]) => element("p", {}, element("strong", {}, `${name} `), badge(found), ` ${said(found) === found.outcome.replace("_", " ") ? "" : said(found).split(": ").slice(1).join(": ")}`))),
    table(head, rows), element("h2", {}, "Checks"), table(head, checks));
}

const unitOf = (lab, name) => signalOf(lab.engine, name).unit;
