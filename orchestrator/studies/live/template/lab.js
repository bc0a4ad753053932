// The scenario in hand, its whole run with the values of now (the ghost), and the models to run it.

const GHOST_EVERY = 5; // exchanges between two rows of the ghost, at 100 Hz

class Lab {
  /** @type {any} the scenario in hand; there is none before the first `load` */
  situation = null;

  // `mapped`: code for the runs of a map, whose `engine` works out no more than how they come out; of one system.
  constructor(engine, data, mapped = null) {
    this.engine = engine;
    this.mapped = mapped;
    this.table = data.numbers;
    this.scenarios = new Map(data.scenarios.map((item) => [item.name, item]));
    this.pins = data.pins;
    this.seen = seenOf(engine);
    this.modes = MODES.map((name) => this.seen.indexOf(name)).filter((place) => place >= 0);
    this.only = []; // sliders of a page that stands in another one
  }

  load(name, changes = {}) {
    for (const course of [this.driven, this.whole]) if (course) course.close();
    this.situation = new Situation(this.scenarios.get(name), this.engine.models, changes);
    this.driven = this.engine.open(this.situation.data, this.seen);
    this.whole = this.engine.open(this.situation.data, this.seen);
  }

  get system() { return this.situation.get("controller.system"); }

  pinned() {
    const states = this.situation.known.get("controller.system").states;
    const own = this.pins[states[this.system].toLowerCase()] || [], isKnown = (name) => this.situation.known.has(name);
    const only = this.only.filter(isKnown);
    return only.length ? only : [...this.pins.always, ...own].filter(isKnown);
  }

  // Whether a parameter means something to the system chosen.
  isUsed(name) {
    const model = this.engine.models.find((item) => name.startsWith(`${item.name}.`));
    if (!model || !model.systems) return true;
    const own = name.slice(model.name.length + 1), fits = (word) => own === word || own.startsWith(`${word}.`) || own.startsWith(`${word}[`);
    const chosen = model.systems.find((item) => item.values.includes(this.system));
    return !model.systems.some((item) => item !== chosen && item.own.some(fits)) || Boolean(chosen && chosen.own.some(fits));
  }

  // Runs of the situation in hand of which nothing but how they come out is wanted.
  openForMap() {
    const { data } = this.situation, { mapped } = this;
    if (!mapped || mapped.system !== this.system) return this.engine.open(data, []);
    const measures = data.measures.map(([how, name, ...when]) => [mapped.lastIsSmallest.includes(name) ? "last" : how, name, ...when]);
    return mapped.engine.open({ ...data, measures }, []);
  }

  // The whole run with the driver modelled, and how it came out.
  ghost() {
    const { situation, whole } = this, begun = performance.now();
    const times = situation.data.times, every = Math.max(1, Math.round(GHOST_EVERY * 1e7 / times[0]));
    const run = whole.run(situation.params(), times, every);
    const took = performance.now() - begun;
    const start = situation.pose("vehicle.start"), origin = [Math.round(start[0]), Math.round(start[1])];
    return { history: wholeHistory(this.engine, this.seen, situation.still(origin), run), took, ...judged(run.row, situation, this.table) };
  }
}

// Outcomes of many runs that differ in two parameters, one row of the grid after the other.
function* gridOf(lab, [a, b], rows) {
  const course = lab.openForMap(), times = lab.situation.data.times;
  for (const [number, y] of b.values.entries()) {
    const cells = a.values.map((x) => {
      const situation = new Situation(lab.situation.data, lab.engine.models, { ...lab.situation.changes, [a.name]: x, [b.name]: y });
      const { outcome, reason, numbers } = judged(course.run(situation.params(), times, 1 << 30).row, situation, lab.table);
      return { outcome, reason, error: Math.hypot(numbers["final.lateral_error"], numbers["final.longitudinal_error"]), manoeuvres: numbers.manoeuvres };
    });
    yield { number, cells, of: rows };
  }
  course.close();
}

// A lab for maps, from the bytes of both modules and the data of the page.
async function startMapLab({ codes, mapped, ...data }) {
  const [engine, own] = await Promise.all(codes.map((code) => code.byteLength ? Engine.start(code, data.models) : null));
  return new Lab(engine, data, own && { ...mapped, engine: own });
}

// What a worker does: the same models, the same judge.
function work() {
  let started = null;
  self.onmessage = async ({ data }) => {
    if (data.codes) { started = startMapLab(data); return; }
    const lab = await started;
    lab.load(data.scenario, data.changes);
    const begun = performance.now();
    for (const row of gridOf(lab, data.axes, data.axes[1].values.length)) postMessage({ ...row, id: data.id });
    postMessage({ id: data.id, took: performance.now() - begun });
  };
}
