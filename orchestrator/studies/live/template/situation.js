// A scenario and what was changed of it: parameters for the models, what is true, the scene, and the way back to YAML.

const AXES = ["x", "y", "heading"];
const SLOT = [...AXES, "length", "width"];
const BOX = [...SLOT, "appear_at", "disappear_at", "speed_x", "speed_y", "moves_at", "halts_at"];
const FARTHEST_END = 1e6; // of a range that bounds nothing
const FRAME = 0.1, LONGEST = 60; // s: between two pictures of a thing that moves, and how long it is followed

class Situation {
  constructor(data, models, changes = {}) {
    this.data = data;
    this.models = models;
    this.known = new Map(); // name -> what is said of a parameter
    let place = 0;
    for (const model of models)
      for (const [name, unit, text, kind, start, low, high, mode, source] of model.parameters) {
        const full = `${model.name}.${name}`;
        const given = data[model.name][name];
        const states = mode ? model.states[mode] : null;
        this.known.set(full, { name: full, unit, text, kind, low, high, states, source, place: place++, start: given === undefined ? start : Number(given) });
      }
    this.roots = new Map(); // parameter -> value in the controller
    for (const name of AXES) if (data.target) this.tell(truth("target", name, data.target[name]), [`controller.target.${name}`]);
    for (const name of SLOT) if (data.slot) this.tell(truth("slot", name, data.slot[name]), []);
    this.layout = data.layout;
    if (this.layout) this.layout.names.forEach((name, i) => this.tell(ofLayout(name, this.layout.start[i]), []));
    for (const item of [...this.known.values()].filter(({ name }) => name.startsWith("vehicle.car.")))
      this.tell({ ...item, name: item.name.replace("vehicle.", ""), place: -1 }, [item.name, item.name.replace("vehicle.", "controller.")]);
    this.base = new Float64Array(place);
    for (const item of this.known.values()) if (item.place >= 0) this.base[item.place] = item.start;
    this.changes = {};
    for (const [name, value] of Object.entries(changes)) this.set(name, value);
  }

  // Ground truth that models receive: those with another value keep it.
  tell(item, receivers) {
    this.known.set(item.name, item);
    for (const name of receivers) if (this.known.has(name) && this.known.get(name).start === item.start) this.roots.set(name, item.name);
  }

  get(name, changes = this.changes) {
    if (name in changes) return changes[name];
    const root = this.roots.get(name), laid = this.laidOut(changes);
    return root in changes ? changes[root] : laid.get(root) ?? laid.get(name) ?? this.known.get(name).start;
  }

  // Name -> value of what a changed slot_layout generates: orchestrator/studies/live/layout.py.
  laidOut(changes = this.changes) {
    const { layout } = this, found = new Map();
    if (!layout || !layout.names.some((name) => name in changes)) return found;
    const key = layout.names.map((name) => changes[name]).join();
    if (this.laid && key === this.laidKey) return this.laid;
    this.laidKey = key;
    this.laid = found;
    const [length, depth, ...origin] = layout.names.map((name, i) => changes[name] ?? layout.start[i]), by = [length - layout.start[0], depth - layout.start[1]];
    const at = ([value, ...slopes]) => value + slopes[0] * by[0] + slopes[1] * by[1], round = (value) => Number(value.toFixed(12));
    for (const [x, y, heading, u, v] of layout.points) {
      moved(origin, at(u), at(v)).forEach((value, i) => found.set([x, y][i], round(value)));
      if (heading) found.set(heading, this.known.get(heading).start + (origin[2] - layout.start[4]));
    }
    for (const [name, ...value] of layout.sizes) found.set(name, round(at(value)));
    return found;
  }

  // Whether the slot's own values follow slot_layout and are not to be changed apart.
  follows(name) { return Boolean(this.layout) && name.startsWith("slot."); }

  // Move the slot; with a slot_layout all that it generates follows.
  moveSlot(pose) {
    if (!this.layout) { AXES.forEach((axis, i) => this.set(`slot.${axis}`, pose[i])); return; }
    const origin = this.pose("slot_layout.origin"), slot = this.pose("slot"), [u, v] = inFrame(origin, slot), [x, y] = moved(pose, u, v);
    [[x, 3], [y, 3], [origin[2] + pose[2] - slot[2], 4]].forEach(([value, digits], i) => this.set(`slot_layout.origin.${AXES[i]}`, Number(value.toFixed(digits))));
  }

  // What is wrong with a value, "" if nothing.
  wrong(name, value) {
    const item = this.known.get(name);
    if (!item) return `there is no parameter ${name}`;
    if (this.follows(name)) return `${name} follows slot_layout: change ${this.layout.names.join(", ")}`;
    const range = rangeText(item);
    if (!Number.isFinite(value)) return `not a number; ${name} takes ${range}`;
    if (item.kind !== "float" && !Number.isInteger(value)) return `${name} takes a whole number`;
    if (item.states && !(value in item.states)) return `${name} takes ${Object.values(item.states).map((state) => state.toLowerCase()).join(", ")}`;
    if ((item.low !== null && value < item.low) || (item.high !== null && value > item.high)) return `out of range: ${name} takes ${range}`;
    return "";
  }

  // Change a parameter; returns what is wrong with the value. A moved target is given to the controller.
  set(name, value) {
    const wrong = this.wrong(name, value);
    if (wrong) return wrong;
    if (value === this.known.get(name).start) delete this.changes[name]; else this.changes[name] = value;
    return "";
  }

  params(changes = this.changes) {
    const found = Float64Array.from(this.base);
    if (this.data.maps && Object.keys(changes).some((name) => name.startsWith("vehicle.scene.") || name.startsWith("slot_layout."))) this.tellMap(found);
    const laid = this.laidOut(changes);
    for (const [name, value] of laid) if (this.known.get(name).place >= 0) found[this.known.get(name).place] = value;
    for (const [name, root] of this.roots) if (laid.has(root)) found[this.known.get(name).place] = laid.get(root);
    for (const [name, root] of this.roots) if (root in changes) found[this.known.get(name).place] = changes[root];
    for (const [name, value] of Object.entries(changes)) if (this.known.get(name).place >= 0) found[this.known.get(name).place] = value;
    return found;
  }

  // What stands there all the time as the map of a controller that has one: orchestrator/inputs/scenario/polygons.py.
  tellMap(found) {
    const stays = (box) => box.length > 0 && box.appear_at === 0 && box.disappear_at >= 1e9 && box.speed_x === 0 && box.speed_y === 0;
    const corners = (box) => [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a, b]) => moved([box.x, box.y, box.heading], 0.5 * a * box.length, 0.5 * b * box.width));
    const things = [...this.data.obstacles, ...this.rows("scene.boxes", BOX).filter(stays).map(corners), ...this.kerbs.map((kerb) => [[kerb.x1, kerb.y1], [kerb.x2, kerb.y2]])];
    const rows = things.flatMap((points, i) => points.map(([x, y]) => ({ x, y, polygon: i + 1 })));
    for (let i = 0; this.known.has(`controller.map[${i + 1}].x`); i++)
      for (const field of ["x", "y", "polygon"]) found[this.known.get(`controller.map[${i + 1}].${field}`).place] = rows[i] ? rows[i][field] : 0;
  }

  // Values of the vehicle's parameters by name, for the scene and for what is true.
  vehicle(name) { return this.get(`vehicle.${name}`); }

  pose(prefix) { return AXES.map((axis) => this.get(`${prefix}.${axis}`)); }

  get target() { return this.data.target ? this.pose("target") : null; }

  get slot() { return this.data.slot ? SLOT.map((name) => this.get(`slot.${name}`)) : null; }

  get car() {
    const wheelbase = this.vehicle("car.wheelbase");
    return { front: wheelbase + this.vehicle("car.front_overhang"), rear: this.vehicle("car.rear_overhang"), half: 0.5 * this.vehicle("car.width"), wheelbase };
  }

  rows(array, fields) {
    const rows = [];
    while (this.known.has(`vehicle.${array}[${rows.length + 1}].${fields[0]}`))
      rows.push(Object.fromEntries(fields.map((field) => [field, this.vehicle(`${array}[${rows.length + 1}].${field}`)])));
    return rows;
  }

  get boxes() {
    return this.rows("scene.boxes", BOX)
      .filter((box) => box.length > 0 && box.width > 0).flatMap(stills);
  }

  get kerbs() { return this.rows("scene.kerbs", ["x1", "y1", "x2", "y2", "height"]).filter((kerb) => kerb.height > 0); }

  // Surroundings as scene.js draws them.
  still(origin) {
    const less = (points) => points.map(([x, y]) => [x - origin[0], y - origin[1]]);
    const outline = (box) => less(rectangle(-0.5 * box.length, 0.5 * box.length, 0.5 * box.width).map(([u, v]) => moved([box.x, box.y, box.heading], u, v)));
    const slot = this.slot, target = this.target;
    const half = this.vehicle("car.ultrasonic.half_angle"), range = this.vehicle("car.ultrasonic.max_range");
    return {
      origin, turn: this.vehicle("start.heading"), car: this.car,
      slot: slot && outline({ x: slot[0], y: slot[1], heading: slot[2], length: slot[3], width: slot[4] }),
      target: target && [target[0] - origin[0], target[1] - origin[1], target[2]],
      boxes: [...this.boxes.map((box) => ({ corners: outline(box), from: box.appear_at, to: box.disappear_at })), ...this.data.obstacles.map((corners) => ({ corners: less(corners), from: 0, to: 1e9 }))],
      kerbs: this.kerbs.map((kerb) => less([[kerb.x1, kerb.y1], [kerb.x2, kerb.y2]])),
      sensors: this.boxes.length + this.kerbs.length === 0 ? [] : this.rows("car.ultrasonic.mounts", ["x", "y", "yaw"])
        .map((mount, i) => ({ signal: `vehicle.ultrasonic[${i + 1}]`, x: mount.x, y: mount.y, heading: mount.yaw, half, range })),
    };
  }

  // The scenario with its changes, as `apa run` reads it.
  yaml() {
    const lines = [`name: ${this.data.name}-live`, `extends: ${this.data.source || this.data.name}`];
    if (this.data.title) lines.push(`title: ${JSON.stringify(this.data.title)}`);
    const own = { ...this.data.overrides };
    if (this.movesTarget()) for (const name of Object.keys(own).filter((key) => key.startsWith("slot_layout."))) delete own[name];
    for (const [name, value] of this.toWrite()) Object.assign(own, this.withArray(name), { [name]: this.written(name, value) });
    const owners = ["car", "slot_layout", "target", "slot", "vehicle", "controller"];
    if (this.movesTarget()) own["target.reference_point"] = "rear_axle";
    if ("car" in own && Object.keys(own).some((key) => key.startsWith("car."))) { own["car.extends"] = own.car; delete own.car; }
    for (const [key, text] of Object.entries(own)) if (!owners.includes(key.split(".")[0]) || key === "car") lines.push(`${key}: ${text}`);
    for (const owner of owners) {
      const names = Object.keys(own).filter((name) => name.startsWith(`${owner}.`));
      if (names.length) lines.push(`${owner}:`, ...names.map((name) => `  ${JSON.stringify(name.slice(owner.length + 1))}: ${own[name]}`));
    }
    return `${lines.join("\n")}\n`;
  }

  // What is changed, as it is written: a target as a whole, because its base may give it by another point of the car,
  // and with a target of its own what slot_layout generates, because a file gives only one of them.
  toWrite() {
    const changes = Object.entries(this.changes);
    if (!this.movesTarget()) return changes;
    const { points, sizes } = this.layout || { points: [], sizes: [] }, targets = AXES.map((axis) => `target.${axis}`);
    const moves = [...Object.keys(this.changes), ...Object.keys(this.data.overrides)].some((name) => name.startsWith("slot_layout."));
    const laid = moves ? [...points.flatMap((names) => names.slice(0, 3)), ...sizes.map(([name]) => name)].filter(Boolean) : [];
    return [...laid.map((name) => [name, this.get(name)]), ...changes.filter(([name]) => !name.startsWith("slot_layout.")), ...targets.map((name) => [name, this.get(name)])];
  }

  // Whether the target is another one than the file's with these changes: a layout gives it by the outline of the car.
  movesTarget() { return Object.keys(this.changes).some((name) => name.startsWith("target.") || (Boolean(this.layout) && name.startsWith("car."))); }

  // A scenario that gives the first element of an array gives the whole array: what else stands in that of `name`.
  withArray(name) {
    const array = name.includes("[1]") ? name.slice(0, name.indexOf("[") + 1) : null, owner = name.split(".")[0];
    const given = array && this.data[owner] ? Object.keys(this.data[owner]).map((item) => `${owner}.${item}`).filter((item) => item.startsWith(array)) : [];
    return Object.fromEntries(given.map((item) => [item, this.written(item, this.get(item))]));
  }

  written(name, value) {
    const item = this.known.get(name);
    if (item.states) return item.states[value].toLowerCase();
    return item.kind === "bool" ? String(value !== 0) : String(value);
  }

  // For the address: scenario and changes.
  fragment() {
    const parts = [`s=${encodeURIComponent(this.data.name)}`];
    for (const [name, value] of Object.entries(this.changes)) parts.push(`${encodeURIComponent(name)}=${value}`);
    return `#${parts.join("&")}`;
  }
}

// The range of a parameter in the units of the page, its ends rounded to three digits.
function rangeText(item) {
  const isFree = (value) => value === null || Math.abs(value) >= FARTHEST_END;
  if (isFree(item.low) && isFree(item.high)) return "any value";
  const [name, factor] = display(item.unit), end = (value) => (isFree(value) ? "\u221e" : String(Number((value * factor).toPrecision(3))));
  return `${isFree(item.low) ? "\u2212\u221e" : end(item.low)} to ${end(item.high)}${name ? ` ${name}` : ""}`;
}

// Boxes that stand, one after the other, in the place of one that moves.
function stills(box) {
  const begin = Math.max(box.moves_at, box.appear_at), end = Math.min(box.halts_at, box.disappear_at, box.moves_at + LONGEST);
  if ((box.speed_x === 0 && box.speed_y === 0) || end <= begin) return [box];
  const times = box.appear_at < begin ? [box.appear_at] : [];
  for (let i = 0; i < Math.ceil((end - begin) / FRAME); i++) times.push(begin + FRAME * i);
  times.push(end, box.disappear_at);
  return times.slice(1).map((until, i) => [times[i], until]).filter(([from, until]) => from < until).map(([from, until]) => {
    const moved = Math.max(0, Math.min(from, box.halts_at) - box.moves_at);
    return { ...box, x: box.x + box.speed_x * moved, y: box.y + box.speed_y * moved, appear_at: from, disappear_at: until };
  });
}

function truth(owner, name, start) {
  const unit = name === "heading" ? "rad" : "m", low = owner === "slot" && (name === "length" || name === "width") ? 0.01 : null;
  const text = { x: "x", y: "y", heading: "heading", length: "length along its heading", width: "width across it" }[name];
  return { name: `${owner}.${name}`, unit, text: `${owner === "slot" ? "slot" : "where the car shall stand"}: ${text}`, kind: "float", low, high: null, states: null, source: "", place: -1, start };
}

function ofLayout(name, start) {
  const text = { length: "slot with neighbours and kerb: length of the gap along the road", depth: "slot with neighbours and kerb: depth from the road", "origin.x": "slot with neighbours and kerb: x", "origin.y": "slot with neighbours and kerb: y", "origin.heading": "slot with neighbours and kerb: driving direction" }[name.slice("slot_layout.".length)];
  return { name, unit: name.endsWith("heading") ? "rad" : "m", text, kind: "float", low: name.includes("origin") ? null : 0.01, high: null, states: null, source: "", place: -1, start };
}
