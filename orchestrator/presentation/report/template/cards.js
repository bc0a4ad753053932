// Below the replay: checks, events, words from the models, parameters, where everything came from.

const SHOWN_ROWS = 8; // of a list of differences; the worst come first

const moment = (t) => (t === null || t === undefined ? "\u2013" : element("a", { href: `#t=${+t.toFixed(4)}`, class: "moment" }, `${t.toFixed(2)} s`));

function card(title, content, open = true) {
  return element("details", { class: "card", open }, element("summary", {}, title), content);
}

function checksCard(run, tag) {
  const rows = run.checks.map((check) => row([check.evaluated ? pill(check.passed, check.required) : element("span", { class: "pill warn" }, "not evaluated"), check.id, numberCell(check.value_text), numberCell(check.limit_text),
    numberCell(check.margin_text), moment(check.t), check.source]));
  const missed = run.checks.filter((check) => !check.passed).length;
  const title = `Checks${tag}: ${run.checks.length - missed} of ${run.checks.length} passed`;
  return run.checks.length ? card(title, table(["", "check", "worst value", "limit", "margin", "at", "source"], rows)) : null;
}

function eventsCard(run, tag, isAlone) {
  const name = run.chart;
  if (!name) return null;
  const spans = run.spans(name);
  const rows = spans.map((span) => {
    const state = run.stateName(name, span.value);
    const place = ["x", "y"].map((axis) => numberCell(quantity(run.at(`vehicle.pose.${axis}`, span.from), "m")));
    return row([moment(span.from), element("td", {}, element("span", { class: "chip", "data-state": state, "data-value": span.value }, element("i"), words(state))),
      numberCell(`${(span.to - span.from).toFixed(2)} s`), ...place, numberCell(quantity(run.at("vehicle.pose.heading", span.from), "rad"))]);
  });
  return card(`States${tag}`, table(["from", "state", "for", "x", "y", "heading"], rows), isAlone);
}

function logCard(run, tag) {
  if (!run.log.length) return null;
  const rows = run.log.map((line) => row([moment(line.t), element("span", { class: `level ${line.level}` }, line.level), line.name, element("td", { class: "message" }, line.text)]));
  return card(`Messages${tag}`, table(["at", "level", "from", "text"], rows), run.log.length <= 12);
}

function parametersCard(run, tag) {
  const rows = run.parameters.map((item) => row([element("code", {}, item.name), numberCell(item.state ? words(item.state) : quantity(item.value, item.unit)), item.text], { "data-name": item.name, class: item.changed ? "changed" : "" }));
  const search = element("input", { type: "search", placeholder: "Filter, for example steering", "aria-label": "Filter parameters" });
  search.addEventListener("input", () => { for (const line of rows) line.hidden = !line.dataset.name.includes(search.value.trim().toLowerCase()); });
  return card(`Parameters${tag} (${rows.length}; set by the scenario: ${run.parameters.filter((item) => item.changed).length})`, element("div", {}, search, table(["name", "value", "meaning"], rows)), false);
}

function provenanceCard(run, tag) {
  const rows = run.provenance.map(([key, value]) => row([element("code", {}, key), element("td", { class: "message" }, value)]));
  return card(`Where it came from${tag}`, table(["", ""], rows), false);
}

function differencesCards(page) {
  if (!page.differences) return [];
  const line = (item) => row([pill(item.passed), element("span", {}, item.label ? `${item.label} ` : "", element("code", {}, item.signal)), numberCell(quantity(item.largest, item.unit)), numberCell(item.tolerance_text),
    moment(item.t_largest), item.first === null ? "\u2013" : moment(item.first), item.note || ""]);
  const heads = ["", "signal", "largest difference", "tolerance", "at", "first exceedance", ""];
  const cards = [];
  for (const label of new Set(page.differences.map((item) => item.label))) {
    const own = page.differences.filter((item) => item.label === label), before = label ? `${label}: ` : "";
    const [missed, agreed] = [false, true].map((passed) => own.filter((item) => item.passed === passed));
    if (missed.length) cards.push(card(`${before}${missed.length} of ${own.length} signals differ`, shortTable(heads, missed.map(line))));
    if (agreed.length) cards.push(card(`${before}${agreed.length} signals agree`, table(heads, agreed.map(line)), false));
  }
  return cards;
}

// A table whose first rows are seen; the others are folded.
function shortTable(heads, rows) {
  const rest = rows.slice(SHOWN_ROWS);
  return element("div", {}, table(heads, rows.slice(0, SHOWN_ROWS)), rest.length ? element("details", { class: "more" }, element("summary", {}, `${rest.length} more`), table(heads, rest)) : null);
}

function changesCard(page) {
  if (!page.changes) return null;
  const rows = page.changes.map(([name, ...values]) => row([element("code", {}, name), ...values.map(numberCell)]));
  return card(`Parameters that differ: ${rows.length}`, rows.length ? table(["name", ...page.runs.map((run) => run.label)], rows) : "none", rows.length > 0);
}

// The state machine of the controller, drawn; it follows the time.
function chartCard(page) {
  if (!page.charts || !page.charts.length) return null;
  return card("Chart", element("div", {}, element("p", { id: "chart-said", class: "chart-said", role: "status" }, "Point at a state to see its description."), element("p", { id: "chart-none", hidden: true }), element("div", { id: "chart" })), false);
}

function fillTables(page) {
  const box = $("details"), tags = page.runs.map((run) => (page.runs.length > 1 ? ` ${run.label}` : ""));
  for (const item of [changesCard(page), ...differencesCards(page), ...page.runs.map((run, i) => checksCard(run, tags[i]))]) if (item) $("checks").append(item);
  const cards = [chartCard(page)];
  for (const make of [eventsCard, logCard, parametersCard, provenanceCard]) page.runs.forEach((run, i) => cards.push(make(run, tags[i], page.runs.length === 1)));
  for (const item of cards) if (item) box.append(item);
}
