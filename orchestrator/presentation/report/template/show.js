// Small things everything else uses: elements, colours, numbers as people read them.

/** @returns {any} */
const $ = (id) => document.getElementById(id);

// An element with text; text never becomes markup.
/** @returns {any} */
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "on") for (const [event, handler] of Object.entries(value)) node.addEventListener(event, handler);
    else if (key === "style") for (const [name, item] of Object.entries(value)) node.style.setProperty(name, item);
    else if (value !== undefined && value !== null && value !== false) node.setAttribute(key, value === true ? "" : value);
  }
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(child);
  return node;
}

// Colours of the style sheet by name, looked up once until the theme changes.
const COLORS = new Map();

function color(name) {
  if (!COLORS.has(name)) COLORS.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return COLORS.get(name);
}

function digits(value) {
  if (value === null || !Number.isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(2).replace("-", "\u2212");
  const text = value.toFixed(size >= 1000 ? 1 : size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 4);
  return text.replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "").replace("-", "\u2212");
}

function quantity(value, unit) {
  const [name, factor] = display(unit);
  return value === null || value === undefined ? "\u2013" : `${digits(value * factor)}${name ? "\u2009" + name : ""}`;
}

const words = (name) => name.toLowerCase().replaceAll("_", " ").replace(/\bq(\d)/g, "Q$1");

// Colour of a state of the chart: NAMED (palette.py), else the hue of its value. Other modes have no hue, but what is good or urgent.
function stateColor(name, value) {
  return color(NAMED[name] || `s${((Math.round(value) % 8) + 8) % 8}`);
}

const SAID = ["good", "bad", "warn", "stop", "idle"];

function modeColor(name, value) {
  return color(SAID.includes(NAMED[name]) ? NAMED[name] : `m${Math.abs(Math.round(value)) % 2 || 0}`);
}

const runColor = (number) => color(`run-${"abcdef"[number % 6]}`);
