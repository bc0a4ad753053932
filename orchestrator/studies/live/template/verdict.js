// The judge in the page: the numbers of a run, its checks and its outcome, as orchestrator/evaluation/verdict has them.

const MARGIN = {
  max: (value, limit) => limit - value,
  min: (value, limit) => value - limit,
  max_abs: (value, limit) => limit - Math.abs(value),
  equals: (value, limit) => 0 - Math.abs(value - limit),
};

const wrap = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** @param {number[]} pose @param {number[]} frame */
function inFrame([x, y, heading], frame) {
  const dx = x - frame[0], dy = y - frame[1], c = Math.cos(frame[2]), s = Math.sin(frame[2]);
  return [c * dx + s * dy, c * dy - s * dx, wrap(heading - frame[2])];
}

// Least distance of the outline to the slot's edges, negative where it stands out.
function slotMargin(pose, slot, car) {
  const [x, y, turn] = inFrame(pose, slot), c = Math.cos(turn), s = Math.sin(turn);
  let least = Infinity;
  for (const along of [car.front, -car.rear])
    for (const across of [car.half, -car.half])
      least = Math.min(least, 0.5 * slot[3] - Math.abs(x + c * along - s * across), 0.5 * slot[4] - Math.abs(y + s * along + c * across));
  return least;
}

function toSegment(x, y, kerb) {
  const dx = kerb.x2 - kerb.x1, dy = kerb.y2 - kerb.y1;
  const share = Math.min(1, Math.max(0, ((x - kerb.x1) * dx + (y - kerb.y1) * dy) / Math.max(dx * dx + dy * dy, 1e-12)));
  return Math.hypot(x - kerb.x1 - share * dx, y - kerb.y1 - share * dy);
}

// Kerbs that run along the slot, at most 45 deg off, and pass its side within half a metre.
function kerbsAtSlot(situation) {
  const place = situation.slot || situation.target;
  if (!place) return [];
  const half = situation.slot ? 0.5 * place[4] : situation.car.half;
  return situation.kerbs.filter((kerb) => {
    const dx = kerb.x2 - kerb.x1, dy = kerb.y2 - kerb.y1, length = Math.hypot(dx, dy);
    const along = length > 0 && Math.abs(dx * Math.cos(place[2]) + dy * Math.sin(place[2])) >= Math.SQRT1_2 * length;
    return along && toSegment(place[0], place[1], kerb) <= half + 0.5;
  });
}

// [nearest, farthest] distance of the tyres beside the nearest kerb.
/** @param {number[]} pose @param {any[]} kerbs @param {any} car */
function kerbDistances([x, y, heading], kerbs, car) {
  const c = Math.cos(heading), s = Math.sin(heading);
  let found = [NaN, NaN];
  for (const kerb of kerbs) {
    const axles = [0, car.wheelbase].map((along) =>
      Math.min(...[car.half, -car.half].map((side) => toSegment(x + c * along - s * side, y + s * along + c * side, kerb))));
    if (!(Math.min(...axles) >= found[0])) found = [Math.min(...axles), Math.max(...axles)];
  }
  return found;
}

// The numbers of a summary by name; `row`: how the run ended, when, and its measures.
function numbersOf(row, situation, table) {
  const measures = situation.data.measures, found = {};
  for (const [name, item] of Object.entries(table)) {
    if (!item.measure) continue;
    const place = measures.findIndex(([how, signal, mode]) => how === item.measure[0] && signal === item.measure[1] && !mode);
    const value = place < 0 ? NaN : row[HEAD + place];
    found[name] = item.unsigned ? Math.abs(value) : value;
  }
  found.duration = row[1] / 1e9;
  // Polygons are not looked at here: with them it is not known whether the car touches anything.
  found.penetration = situation.data.obstacles.length ? NaN : Math.max(0, -found.min_clearance);
  const pose = AXES.map((axis) => found[`final.${axis}`]), { target, slot, car } = situation, none = [NaN, NaN, NaN];
  const errors = target ? inFrame(pose, target) : none;
  ["longitudinal", "lateral", "heading"].forEach((name, i) => { found[`final.${name}_error`] = errors[i]; });
  found["final.outline_margin"] = slot ? slotMargin(pose, slot, car) : NaN;
  [found["final.kerb_nearest"], found["final.kerb_farthest"]] = kerbDistances(pose, kerbsAtSlot(situation), car);
  return found;
}

// Whether there is anything to touch: orchestrator/evaluation/verdict/contact.py.
const hasScene = (situation) => situation.data.obstacles.length + situation.kerbs.length > 0 || situation.rows("scene.boxes", BOX).some((box) => box.length > 0);

// Each requirement that is asked of the run, and how it stands against it.
function checksOf(row, numbers, situation) {
  const has = { target: Boolean(situation.target), slot: Boolean(situation.slot), kerb: kerbsAtSlot(situation).length > 0, polygons: situation.data.obstacles.length > 0, scene: hasScene(situation) };
  return situation.data.limits.filter((limit) => !limit.where || has[limit.where]).map((limit) => {
    const value = limit.number ? numbers[limit.signal] : limit.measure < 0 ? NaN : row[HEAD + limit.measure];
    const never = limit.first >= 0 && Number.isNaN(row[HEAD + limit.first]);
    const margin = MARGIN[limit.condition](value, limit.limit);
    return { ...limit, value, margin, evaluated: limit.number || limit.measure >= 0, never, passed: never ? limit.ifNever === "pass" : margin >= 0 };
  });
}

function stateNames(models, signal) {
  const [owner, ...rest] = signal.split("."), name = rest.join(".");
  const model = models.find((item) => item.name === owner);
  const found = model && model.outputs.find((item) => item[0] === name);
  return found && found[7] ? model.states[found[7]] : {};
}

const CONTACT_ID = "free of contact"; // orchestrator/library/requirements/contact-free.yaml

const stateName = (names, value) => (Number.isFinite(value) ? names[value] ?? String(value) : "nan");

function whyNot(speed, missed, still) {
  const named = (items) => [...new Set(items.map((item) => item.id))].join(", ");
  const isContact = (item) => item.id === CONTACT_ID && !Number.isNaN(item.value), touched = missed.some(isContact);
  const beyond = named(missed.filter((item) => !Number.isNaN(item.value) && !isContact(item)));
  let unknown = named(missed.filter((item) => Number.isNaN(item.value)));
  const parts = touched ? ["contact"] : [];
  if (Math.abs(speed) > still) parts.push(`the car still moves: ${speed.toPrecision(3)} m/s`);
  if (Number.isNaN(speed)) unknown = ["the car's speed", unknown].filter(Boolean).join(", ");
  if (beyond) parts.push(`beyond its limit: ${beyond}`);
  if (unknown) parts.push(`not measured: ${unknown}`);
  return parts.join("; ");
}

// How a run came out, and why: the words of orchestrator/evaluation/verdict/outcome.py.
function outcomeOf(row, checks, situation) {
  const { ending, success, missed, measures } = situation.data;
  const last = (signal) => row[HEAD + measures.findIndex(([how, name, when]) => how === "last" && name === signal && !when)];
  const mode = last(ending.mode), speed = last(ending.speed);
  if (!Number.isFinite(mode)) return [missed, `the controller has no output ${ending.mode.split(".").slice(1).join(".")}, of which ${ending.word} says that it is done`];
  if (ending.failed.includes(mode)) return ["failed", stateName(stateNames(situation.models, ending.reason), last(ending.reason)).toLowerCase()];
  const name = stateName(stateNames(situation.models, ending.mode), mode).toLowerCase();
  if (ending.ended.includes(mode)) return [missed, name];
  if (!ending.succeeded.includes(mode)) return [missed, `stop time reached in ${name}`];
  const why = whyNot(speed, checks.filter((check) => check.evaluated && check.required && !check.passed), ending.still);
  const left = checks.filter((check) => !check.evaluated).map((check) => check.id).join(", ");
  return why ? [missed, why] : [success, left ? `all checks passed except those not evaluated here: ${left}` : "all checks passed"];
}

function judged(row, situation, table) {
  const numbers = numbersOf(row, situation, table), checks = checksOf(row, numbers, situation);
  const [outcome, reason] = outcomeOf(row, checks, situation);
  return { outcome, reason, numbers, checks };
}
