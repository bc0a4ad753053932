// A run in real time: exchanges and steps as the clock asks for them, by the driver modelled or by a person.

const LATEST = 0.25; // more than this the run does not catch up [s]

class Drive {
  /** @type {any} what was driven so far, a History */
  history = null;
  count = 0;
  due = 0; // time that the clock asks for and no step has driven yet [s]
  every = 1; // steps between two rows that are kept
  held = 1; // steps between two samples of the controller, at most

  constructor(lab, driver) {
    this.lab = lab;
    this.driver = driver;
    this.pace = 1;
    this.isPlaying = false;
    this.onEnd = () => {};
    this.onStep = () => {};
  }

  get step() { return this.lab.situation.data.times[0] / 1e9; }

  get isFresh() { return this.count === 0; }

  // From the start, with the parameters as they are now.
  restart() {
    const { engine, situation, seen } = this.lab;
    const start = situation.pose("vehicle.start");
    this.origin = [Math.round(start[0]), Math.round(start[1])];
    this.course = this.lab.driven;
    this.course.begin(situation.params(), situation.data.times);
    this.changes = { ...situation.changes };
    this.history = new History(engine, seen, situation.still(this.origin));
    this.every = Math.max(1, Math.round(FINE / this.step));
    this.held = Math.max(situation.data.times[3], Math.ceil(situation.get("controller.sample_time") / this.step - 1e-9));
    this.count = 0;
    this.due = 0;
    this.isOver = false;
    this.byHand = false;
    this.planKey = "";
    this.modes = "";
    this.driver.lever = GEARS.P;
    this.driver.release();
    this.look();
  }

  get t() { return this.count * this.step; }

  // One exchange at this instant: what the models say goes into the history.
  look() {
    const { over, seen } = this.course.exchange(), modes = this.lab.modes.map((place) => seen[place]).join();
    this.history.push(this.t, seen, this.count % this.every === 0 || over || modes !== this.modes);
    this.modes = modes;
    this.isOver = over;
  }

  // State and guards that the chart in `place` decided on in the latest sample; null if it did not.
  decided(place) {
    const [at, state, guards] = this.course.decided(place);
    return at >= 0 && this.count - at <= this.held ? { state, guards } : null;
  }

  plan() {
    const key = ["path.start.x", "path.segments[1].length", "apa.move.start.x", "apa.move.start.y", "apa.move.pieces[1].length", "apa.slot.ax", "apa.slot.ay", "apa.slot.depth", "apa.goal.x", "apa.goal.y"]
      .map((name) => this.course.look(`controller.${name}`)).join();
    if (key === this.planKey) return;
    this.planKey = key;
    const plan = planOf(this.lab.engine, this.course, this.origin);
    this.history.plans = plan ? [plan] : [];
  }

  // One step of the models, then the exchange after it.
  go() {
    if (this.isOver) return;
    this.driver.move(this.step);
    this.driver.give(this.course);
    this.byHand = this.byHand || this.driver.drives;
    this.course.advance();
    this.count += 1;
    this.look();
    this.onStep();
    if (this.isOver) { this.pause(); this.onEnd(); }
  }

  // As many steps as `seconds` on the clock ask for.
  run(seconds) {
    this.due += Math.min(seconds, LATEST) * this.pace;
    while (this.due >= this.step && !this.isOver) { this.go(); this.due -= this.step; }
  }

  play() { if (this.isOver) this.restart(); this.isPlaying = true; this.due = 0; this.last = null; }

  pause() { this.isPlaying = false; this.driver.release(); }

  // Called once a frame.
  frame(now) {
    this.driver.gamepad();
    if (this.isPlaying && this.last !== null) this.run((now - this.last) / 1000);
    this.last = now;
    this.plan();
  }

  state(name) { return this.history.stateName(name, this.history.last(name)); }

  judged() { return judged(this.course.row(), this.lab.situation, this.lab.table); }
}
