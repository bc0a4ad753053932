// The packed numbers of the page (see payload.py), and a run's signals as functions of time.

// SI unit -> what people read: [unit, factor].
const DISPLAY = { rad: ["deg", 180 / Math.PI], "rad/s": ["deg/s", 180 / Math.PI], "rad/s2": ["deg/s\u00b2", 180 / Math.PI], "1": ["", 1], "m/s2": ["m/s\u00b2", 1], "1/m2": ["1/m\u00b2", 1] };
const display = (unit) => DISPLAY[unit] || [unit, 1];

async function unpack(text) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(stream).arrayBuffer();
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  const arrays = [];
  let at = 4 + size;
  for (const length of header.lengths) {
    const planes = new Uint8Array(buffer, at, 4 * length);
    const bytes = new Uint8Array(4 * length);
    for (let plane = 0; plane < 4; plane++)
      for (let i = 0; i < length; i++) bytes[4 * i + plane] = planes[plane * length + i];
    arrays.push(new Float32Array(bytes.buffer));
    at += 4 * length;
  }
  header.runs = header.runs.map((run) => new Run(run, arrays));
  return header;
}

/** @typedef {{ unit: string, text: string, held?: boolean, turn?: boolean, states?: Record<number, string>, a?: number, o?: number, c?: number | null }} Signal */
/** @typedef {{ origin: number[], turn: number, car: any, slot: any, target: any, boxes: any[], kerbs: any[], sensors: any[] }} Still */

class Run {
  /** @type {Record<string, Signal>} */
  signals = {};
  /** @type {any} what stands around, see Still; a run that is made from a log has it from there */
  scene = null;
  /** @type {any[]} */
  plans = [];
  /** @type {any} rows kept [s]: a typed array, or a plain one that grows */
  time = [];
  /** @type {any} outlines where the car was */
  trail = undefined;
  /** @type {any} */
  gaps = undefined;
  label = "";
  about = "";

  constructor(data, arrays) {
    Object.assign(this, data);
    this.time = Float64Array.from(arrays[data.time]);
    this.duration = this.time.length ? this.time[this.time.length - 1] : 0;
    this.arrays = arrays;
    this.cache = new Map();
    this.plans = data.plans.map((plan) => ({ ...plan, x: arrays[plan.x], y: arrays[plan.y] }));
  }

  // Values of a signal at this.time in SI units; null if there is no such signal.
  values(name) {
    const signal = this.signals[name];
    if (!signal) return null;
    if (!this.cache.has(name)) {
      const result = new Float64Array(this.time.length);
      if (signal.a === undefined) result.fill(signal.c ?? NaN);
      else this.arrays[signal.a].forEach((value, i) => { result[i] = value + signal.o; });
      this.cache.set(name, result);
    }
    return this.cache.get(name);
  }

  // Rows that a straight line from the row before does not reach: the car drove further, there and back or in circles.
  // So few instants are kept of a long run only.
  get apart() {
    if (!this.gaps) {
      const [x, y, speed] = ["x", "y"].map((axis) => this.values(`vehicle.pose.${axis}`)).concat([this.values("vehicle.speed")]);
      this.gaps = Array.from(this.time, (time, i) => i > 0 && x && y && speed
        && Math.hypot(x[i] - x[i - 1], y[i] - y[i - 1]) < 0.475 * Math.abs(speed[i] + speed[i - 1]) * (time - this.time[i - 1]) - 0.2);
    }
    return this.gaps;
  }

  // Last row at or before t.
  row(t) {
    let low = 0, high = this.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.time[middle] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  // Value of a signal at t: held for modes and flags, on a straight line otherwise.
  at(name, t) {
    const values = this.values(name);
    if (!values || !values.length) return NaN;
    const row = this.row(t);
    const step = this.time[row + 1] - this.time[row];
    if (this.signals[name].held || row + 1 >= values.length || step <= 0) return values[row];
    const share = Math.min(1, Math.max(0, (t - this.time[row]) / step));
    let change = values[row + 1] - values[row];
    if (this.signals[name].turn) change = Math.atan2(Math.sin(change), Math.cos(change));
    return values[row] + share * change;
  }

  // What the controller had in mind at t: the plan that held then, or the first one.
  plan(t) { return this.plans.filter((plan) => plan.t <= t).pop() || this.plans[0]; }

  stateName(name, value) {
    const states = this.signals[name] && this.signals[name].states;
    if (!Number.isFinite(value)) return "nan";
    return states && states[value] !== undefined ? states[value] : String(value);
  }

  // Spans of equal value: [{from, to, value}].
  spans(name) {
    const values = this.values(name), result = [];
    for (let i = 0; values && i < values.length; i++) {
      const last = result[result.length - 1];
      if (last && (last.value === values[i] || (Number.isNaN(last.value) && Number.isNaN(values[i])))) continue;
      if (last) last.to = this.time[i];
      result.push({ from: this.time[i], to: this.duration, value: values[i] });
    }
    return result;
  }
}
