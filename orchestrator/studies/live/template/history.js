// A run of the models as scene.js draws one: rows are added while it goes on, or all at once from a whole run.

const MODES = ["controller.phase", "controller.apa.state", "controller.hsic.stage"]; // a change of these is kept
const SEEN = [
  ...AXES.map((axis) => `vehicle.pose.${axis}`), "vehicle.speed", "vehicle.front_wheel_angle", "vehicle.steering_wheel_angle",
  "vehicle.gear", "vehicle.brake_pedal", "vehicle.contact", "vehicle.driver_takeover",
  ...Array.from({ length: 12 }, (_, i) => `vehicle.ultrasonic[${i + 1}]`),
  "controller.phase", "controller.reason", "controller.prompt", "controller.advised_speed", "controller.manoeuvres", ...MODES.slice(1),
];
const FINE = 0.05; // time between the rows that are kept [s]

const seenOf = (engine) => SEEN.filter((name) => engine.places.has(name));

class History extends Run {
  constructor(engine, seen, scene) {
    const signals = {};
    for (const name of seen) signals[name] = signalOf(engine, name);
    super({ time: 0, plans: [], signals, scene, label: "" }, [[]]);
    this.time = [];
    this.trail = [];
    this.places = new Map(seen.map((name, place) => [name, place]));
    this.columns = seen.map(() => []);
    this.isLoose = false;
  }

  values(name) { return this.places.has(name) ? this.columns[this.places.get(name)] : null; }

  // A row; one that is not kept gives way to the next.
  push(t, seen, isKept) {
    if (this.isLoose) { this.time.pop(); for (const column of this.columns) column.pop(); }
    this.time.push(t);
    this.columns.forEach((column, i) => column.push(seen[i]));
    this.isLoose = !isKept;
    this.duration = t;
    if (isKept) this.leave(t);
  }

  leave(t) {
    const last = this.trail[this.trail.length - 1], [x, y, heading] = this.columns, n = x.length - 1, origin = this.scene.origin;
    const pose = [x[n] - origin[0], y[n] - origin[1], heading[n]];
    if (!Number.isFinite(pose[0] + pose[1] + pose[2])) return;
    if (!last || Math.hypot(pose[0] - last[1][0], pose[1] - last[1][1]) + 1.5 * Math.abs(pose[2] - last[1][2]) > 0.55) this.trail.push([t, pose]);
  }

  plan() { return this.plans[0]; }

  last(name) { const values = this.values(name); return values && values.length ? values[values.length - 1] : NaN; }
}

function signalOf(engine, name) {
  const [number, place, isInput] = engine.places.get(name), model = engine.models[number];
  const [, unit, text, kind, , , , mode] = (isInput ? model.inputs : model.outputs)[place];
  return { unit, text, held: kind !== "float", turn: name.endsWith("heading"), states: mode ? model.states[mode] : undefined };
}

function wholeHistory(engine, seen, scene, whole) {
  const found = new History(engine, seen, scene);
  for (let i = 0; i < whole.lines; i++) {
    const line = whole.trace.subarray(i * whole.width, (i + 1) * whole.width);
    found.push(line[0], line.subarray(1), true);
  }
  return found;
}

// What the controller has in mind now: path, slot found, pose wanted; null if it has nothing.
function planOf(engine, course, origin) {
  const at = (name) => course.look(`controller.${name}`);
  const points = pathOf(engine, at), pose = (name) => { const [x, y, heading] = AXES.map((axis) => at(`${name}.${axis}`)); return [x - origin[0], y - origin[1], heading]; };
  /** @type {any} */
  const plan = { x: [], y: [] };
  for (const [x, y] of points) { plan.x.push(x - origin[0]); plan.y.push(y - origin[1]); }
  if (at("apa.slot.type") > 0) plan.slot = opened(at, origin);
  if (points.length && at("apa.plans") > 0) plan.target = pose("apa.goal");
  return points.length || plan.slot ? plan : null;
}

// Corners of the slot that the parking system has found: A and B of its opening, then its depth beyond both.
function opened(at, origin) {
  const [ax, ay, bx, by, side] = ["ax", "ay", "bx", "by", "side"].map((name) => at(`apa.slot.${name}`));
  const depth = Math.min(at("apa.slot.depth"), 5.5), heading = Math.atan2(by - ay, bx - ax) + 0.5 * side * Math.PI;
  const [a, b] = [[ax, ay], [bx, by]].map(([x, y]) => [x - origin[0], y - origin[1], heading]);
  return [moved(a, 0, 0), moved(b, 0, 0), moved(b, depth, 0), moved(a, depth, 0)];
}

function pathOf(engine, at) {
  const rows = (array, fields) => {
    const found = [];
    while (engine.places.has(`controller.${array}[${found.length + 1}].${fields[0]}`)) found.push(fields.map((field) => at(`${array}[${found.length + 1}].${field}`)));
    return found;
  };
  const arcs = rows("path.segments", ["length", "curvature"]);
  if (arcs.some(([length]) => length > 0)) return pointsAlong(AXES.map((axis) => at(`path.start.${axis}`)), -1, arcs.map(([length, k]) => [length, -k, -k]));
  const direction = at("apa.move.direction");
  if (!(direction * direction > 0)) return [];
  const pieces = rows("apa.move.pieces", ["length", "start_curvature", "end_curvature"]).map(([length, a, b]) => [length, direction * a, direction * b]);
  return pointsAlong(AXES.map((axis) => at(`apa.move.start.${axis}`)), direction, pieces);
}

// Points along pieces (length, turning per metre at the start, at the end).
/** @param {number[]} start @param {number} direction @param {any[]} pieces */
function pointsAlong([x, y, heading], direction, pieces) {
  const points = [[x, y]];
  for (const [length, k0, k1] of pieces) {
    const count = length > 0 && Number.isFinite(length) ? Math.min(2000, Math.ceil(length / 0.1)) : 0;
    for (let n = 0; n < count; n++) {
      const ds = length / count, turn = (k0 + (k1 - k0) * (n + 0.5) / count) * ds;
      const chord = ds * (turn === 0 ? 1 : Math.sin(0.5 * turn) / (0.5 * turn));
      x += direction * chord * Math.cos(heading + 0.5 * turn);
      y += direction * chord * Math.sin(heading + 0.5 * turn);
      heading += turn;
      points.push([x, y]);
    }
  }
  return points.length > 1 ? points : [];
}
