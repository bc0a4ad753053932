// Sliders and fields for parameters: those pinned, and a search over all.

const MOST_FOUND = 12;

// Where a slider of a parameter goes from and to: its range, if that is not far wider than its value.
function sliderRange(item) {
  const size = Math.abs(item.start) || 1, far = (end) => end === null || Math.abs(end) > 20 * size;
  let low = far(item.low) ? item.start - 2 * size : item.low, high = far(item.high) ? item.start + 2 * size : item.high;
  if (item.low !== null) low = Math.max(low, item.low);
  if (item.high !== null) high = Math.min(high, item.high);
  return [low, high];
}

const neat = (value) => String(Number(value.toPrecision(7)));
const threeDigits = (value) => String(Number(value.toPrecision(3))); // an end of a range

class WhatIf {
  constructor(lab, onChange) {
    this.lab = lab;
    this.onChange = onChange;
    this.rows = new Map();
    $("search").addEventListener("input", () => this.find());
    $("reset").addEventListener("click", () => { this.lab.situation.changes = {}; this.fill(); this.onChange(); });
  }

  fill() {
    const wanted = [...new Set([...this.lab.pinned(), ...this.more || [], ...Object.keys(this.lab.situation.changes)])];
    this.rows.clear();
    $("pins").replaceChildren(...wanted.map((name) => this.row(name)));
    this.find();
  }

  pin(name) { this.more = [...this.more || [], name]; this.fill(); this.rows.get(name).field.focus(); }

  row(name) {
    const { situation } = this.lab, item = situation.known.get(name), [unit, factor] = display(item.unit), id = `p-${name}`;
    const wrong = element("p", { class: "wrong", role: "alert", id: `${id}-wrong` });
    const set = (value) => {
      if (this.lab.situation !== situation) return; // a field that is left while another scenario is loaded
      wrong.textContent = situation.set(name, value).replace(name, "it");
      field.toggleAttribute("aria-invalid", wrong.textContent !== "");
      if (!wrong.textContent) { this.show(name); this.onChange(name); }
    };
    const [low, high] = sliderRange(item);
    let field, slider = null;
    if (item.states || item.kind === "bool") {
      const states = item.states || { 0: "no", 1: "yes" };
      field = element("select", { id, on: { change: () => set(Number(field.value)) } }, Object.entries(states).map(([value, text]) => element("option", { value }, words(text))));
    } else {
      field = element("input", { id, type: "number", step: "any", "aria-describedby": `${id}-wrong`, on: { change: () => set(fromShown(field.value, item)) } });
      const step = item.kind === "int" ? 1 : (high - low) * factor / 400;
      slider = element("input", { type: "range", min: low * factor, max: high * factor, step: item.kind === "int" ? 1 : step, "aria-label": name, on: { input: () => set(Number(slider.value) / factor) } });
    }
    const back = element("button", { type: "button", class: "back", title: "Back to the scenario's value", "aria-label": `${name}: back to the scenario's value`, on: { click: () => set(item.start) } }, "\u21ba");
    const label = element("label", { for: id, title: `${item.text}${item.source ? ` (${item.source})` : ""}` }, item.text || words(name));
    this.rows.set(name, { item, field, slider, back, factor });
    const node = element("div", { class: "pin" }, label, element("span", { class: "meaning" }, element("code", {}, name), item.states || item.kind === "bool" ? "" : ` \u00b7 ${rangeText(item)}`), slider, element("span", { class: "value" }, field, unit, back), wrong);
    this.show(name);
    return node;
  }

  show(name) {
    const { item, field, slider, back, factor } = this.rows.get(name), value = this.lab.situation.get(name);
    field.value = item.states || item.kind !== "float" ? String(value) : neat(value * factor);
    if (slider) slider.value = String(value * factor);
    back.disabled = value === item.start;
  }

  refresh() { for (const name of this.rows.keys()) this.show(name); }

  find() {
    const word = $("search").value.trim().toLowerCase(), box = $("found");
    const fits = (item) => word && !this.rows.has(item.name) && (item.name.toLowerCase().includes(word) || item.text.toLowerCase().includes(word));
    const found = [...this.lab.situation.known.values()].filter((item) => fits(item) && this.lab.isUsed(item.name) && !this.lab.situation.follows(item.name));
    box.replaceChildren(...found.slice(0, MOST_FOUND).map((item) => element("li", {}, element("button", { type: "button", on: { click: () => { $("search").value = ""; this.pin(item.name); } } },
      item.text, " ", element("code", { class: "quiet" }, item.name), element("span", { class: "quiet" }, ` \u00b7 ${quantity(item.start, item.unit)} \u00b7 ${rangeText(item)}`)))));
    $("found-count").textContent = !word ? "" : found.length > MOST_FOUND ? `${found.length} found, ${MOST_FOUND} shown` : `${found.length} found`;
  }
}

// A number as it was typed, in SI; one that is shown rounded at an end of its range is that end.
function fromShown(text, item) {
  const [, factor] = display(item.unit), value = text.trim() === "" ? NaN : factor === 1 ? Number(text) : Number(text) / factor;
  const end = [item.low, item.high].find((limit) => limit !== null && [neat, threeDigits].some((shown) => Number(shown(limit * factor)) === Number(text)));
  return end === undefined ? value : end;
}
