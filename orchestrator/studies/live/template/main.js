// Puts the page together: scenario, drive, ghost, panels, keys, link.

const PROMPTS = { NONE: "no prompt", STOP: "stop", FORWARD: "drive forward", REVERSE: "drive in reverse", SLOW_DOWN: "slow down", TAKE_OVER: "take over", CONFIRM: "confirm?" };
const LONG = 30; // a ghost that takes longer [ms] leaves the page half of the time
const WORDS_EVERY = 50; // numbers and words follow the picture at intervals that can be read [ms]

class Page {
  /** @type {any} the top view; there is none before the first scenario */
  stage = null;
  /** @type {any} the same, as view.js calls it */
  scene = null;
  /** @type {any} what is drawn */
  page = null;
  paint = () => {};
  show = () => {};
  took = 0; // until the page was ready [ms]
  computed = 0; // when the ghost was last computed [ms]
  shownAt = 0; // when numbers and words were last written [ms]

  constructor(lab, data, codes) {
    this.lab = lab;
    this.driver = new Driver();
    this.sounds = new Sounds();
    this.drive = new Drive(lab, this.driver);
    this.drive.onEnd = () => this.ended();
    this.drive.onStep = () => { this.prompted(); this.chart.note(this.drive); };
    this.whatIf = new WhatIf(lab, () => this.changed());
    this.map = new Grid(lab, codes, data, (values) => { for (const [name, value] of values) lab.situation.set(name, value); this.whatIf.fill(); this.changed(); });
    this.chart = new LiveChart();
    this.charts = data.charts;
    /** @type {any} */
    this.drawn = { runs: [], ribbons: [], ghost: null, poses: () => this.poses() };
    for (const item of data.scenarios) $("scenario").append(element("option", { value: item.name }, item.name));
    this.buttons();
  }

  // What can be dragged: nothing while the car is on its way.
  poses() {
    const { situation } = this.lab;
    if (!this.drive.isFresh) return [];
    const found = [["vehicle.start", situation.pose("vehicle.start"), 0, "Start"]];
    if (situation.target) found.push(["target", situation.target, 0, "Target"]);
    const text = situation.layout ? "Slot, with its neighbours, kerb and target" : "Slot alone: neighbours, kerb and target stay, because the scenario has no slot_layout";
    if (situation.slot) found.push(["slot", situation.slot.slice(0, 3), 0.5 * situation.slot[3], text]);
    return found;
  }

  load(name, changes = {}, wrong = []) {
    this.drive.pause();
    this.lab.load(name, changes);
    const refused = Object.entries(changes).map(([key, value]) => this.lab.situation.wrong(key, value)).filter(Boolean);
    $("notice").hidden = refused.length + wrong.length === 0;
    $("notice").textContent = `Not taken from the address: ${[...wrong, ...refused].join("; ")}.`;
    const { data } = this.lab.situation;
    $("scenario").value = name;
    $("title").textContent = document.title = data.title || name;
    $("subtitle").textContent = data.description;
    $("faults").hidden = data.faults.said.length === 0;
    $("faults").replaceChildren("This scenario disturbs what is received: ", ...data.faults.said.map((said, i) => element("span", {}, i ? "; " : "", said, element("em", { hidden: "" }, ", now"))), ".");
    this.whatIf.more = [];
    this.whatIf.fill();
    this.map.fill();
    this.chart.fill(this.charts.filter((chart) => chart.values.includes(this.lab.system)));
    this.restart();
    this.ghost();
    if (this.stage) { this.stage.turn = -this.drive.history.scene.turn; this.stage.fit(); }
    this.shown();
  }

  restart() {
    this.drive.restart();
    this.chart.begin();
    this.mine = null;
    this.prompt = "NONE";
    this.drawn.runs = [this.drive.history];
    const outer = MODES.slice(1).filter((name) => this.lab.isUsed(name) && this.drive.history.signals[name]);
    this.drawn.ribbons = ["controller.phase", ...outer];
    $("stale").hidden = true;
  }

  ghost(now = 0) {
    this.computed = now;
    this.whole = this.lab.ghost();
    this.drawn.ghost = this.whole.history;
    $("ghost-badge").replaceChildren(badge(this.whole));
    $("ghost-said").textContent = [...said(this.whole).split(": ").slice(1), shortly(this.whole)].join(" \u00b7 ");
    $("ghost-took").textContent = `whole run in ${this.whole.took.toFixed(1)} ms`;
    showResult(this.lab, this.mine, this.drive.byHand, this.whole);
    this.isDue = false;
  }

  // A parameter was changed: a run that has not begun takes it at once, one on its way goes on as it began.
  changed() {
    if (this.drive.isFresh) this.restart(); else $("stale").hidden = false;
    this.isDue = true;
    this.whatIf.refresh();
    this.map.draw();
    this.shown();
  }

  shown() {
    const { situation } = this.lab;
    $("yaml").value = situation.yaml();
    history.replaceState(null, "", situation.fragment() + (this.lab.only.length ? `&only=${this.lab.only.join()}` : ""));
  }

  prompted() {
    const prompt = this.drive.state("controller.prompt");
    if (prompt === this.prompt) return;
    this.prompt = prompt;
    this.sounds.play(prompt);
  }

  ended() {
    this.mine = this.drive.judged();
    showResult(this.lab, this.mine, this.drive.byHand, this.whole);
    tab("result-tab");
  }

  draw(now) {
    const { drive, driver } = this;
    drive.frame(now);
    if (this.isDue && now - this.computed > (this.whole.took > LONG ? 2 * this.whole.took : 0)) this.ghost(now);
    const key = [drive.t, this.whole.took, this.stage.scale, ...this.stage.middle, driver.pedal.accelerator, driver.pedal.brake, driver.lever, driver.drives, drive.isPlaying].join();
    if (key === this.key) return;
    this.key = key;
    if (!drive.history.time.length) return;
    this.stage.draw(drive.t);
    if (drive.isPlaying && now - this.shownAt < WORDS_EVERY) return;
    this.shownAt = now;
    headsUp(this.drawn, drive.t);
    this.chart.show(drive.history, drive.t);
    this.chart.decide(drive);
    this.cockpit();
  }

  cockpit() {
    const { drive, driver } = this, h = drive.history, prompt = drive.state("controller.prompt"), advised = h.last("controller.advised_speed"), speed = h.last("vehicle.speed");
    text("prompt", PROMPTS[prompt] || words(prompt));
    $("prompt").dataset.prompt = prompt;
    text("advised", advised > 0 ? `at most ${(3.6 * advised).toFixed(1)} km/h` : "");
    text("speedometer", `${(3.6 * Math.abs(speed)).toFixed(1)} km/h`);
    $("speedometer").classList.toggle("fast", advised > 0 && Math.abs(speed) > advised + 0.02);
    $("needle").style.width = `${Math.min(100, 100 * Math.abs(speed) / 2)}%`;
    $("mark").hidden = !(advised > 0);
    $("mark").style.left = `${Math.min(100, 50 * advised)}%`;
    for (const gear of Object.keys(GEARS)) {
      $(`gear-${gear}`).setAttribute("aria-pressed", String(driver.drives && driver.lever === GEARS[gear]));
      $(`gear-${gear}`).classList.toggle("in", h.last("vehicle.gear") === GEARS[gear]);
    }
    for (const pedal of ["accelerator", "brake"]) $(pedal).style.setProperty("--down", `${100 * driver.pedal[pedal]}%`);
    this.lab.situation.data.faults.when.forEach(([from, to], i) => { $("faults").querySelectorAll("em")[i].hidden = !(drive.t >= from && drive.t < (to ?? Infinity)); });
    text("clock", `${drive.t.toFixed(2)} s`);
    text("play", drive.isPlaying ? "Pause" : drive.isOver ? "Again" : "Start");
    text("drive-said", drive.isOver && this.mine ? `${drive.byHand ? "You" : "This drive"}: ${said(this.mine)}` : driver.drives ? "You have the pedals; the controller has the wheel" : "The driver modelled has the pedals");
    $("person").checked = driver.drives;
    $("modelled").checked = !driver.drives;
  }

  buttons() {
    const { drive, driver } = this;
    $("play").addEventListener("click", () => this.toggle());
    $("restart").addEventListener("click", () => { drive.pause(); this.restart(); });
    $("step").addEventListener("click", () => { drive.pause(); drive.go(); });
    for (const node of /** @type {NodeListOf<any>} */ (document.getElementsByName("pace"))) node.addEventListener("change", () => { drive.pace = Number(node.value); });
    $("modelled").addEventListener("change", () => { driver.drives = false; });
    $("person").addEventListener("change", () => { driver.drives = true; });
    $("scenario").addEventListener("change", () => this.load($("scenario").value));
    for (const gear of Object.keys(GEARS)) $(`gear-${gear}`).addEventListener("click", () => driver.shift(gear));
    for (const [pedal, share] of [["accelerator", SOFT], ["brake", 0.4]]) holdButton($(pedal), (isDown) => { driver.press(pedal, "screen", isDown ? share : 0); this.begin(isDown); });
    holdButton($("confirm"), (isDown) => { driver.confirm = isDown; if (isDown) driver.take(); });
    $("sound").addEventListener("change", () => { this.sounds.isOn = $("sound").checked; });
    $("copy").addEventListener("click", () => { $("yaml").select(); navigator.clipboard.writeText($("yaml").value).catch(() => document.execCommand("copy")); });
    $("save").addEventListener("click", () => {
      const link = element("a", { href: URL.createObjectURL(new Blob([$("yaml").value], { type: "text/yaml" })), download: `${this.lab.situation.data.name}-live.yaml` });
      link.click();
      URL.revokeObjectURL(link.href);
    });
    driverKeys(driver);
    keyboard({ " ": () => this.toggle(), ".": () => { drive.pause(); drive.go(); }, Home: () => { drive.pause(); this.restart(); } });
    driver.onChange = () => this.begin(driver.pedal.accelerator > 0 || driver.pressed.accelerator.size > 0);
  }

  // Who steps on the accelerator before the start has started.
  begin(isPressed) { if (isPressed && this.driver.drives && this.drive.isFresh && !this.drive.isPlaying) this.drive.play(); }

  toggle() {
    if (this.drive.isPlaying) this.drive.pause();
    else { if (this.drive.isOver) this.restart(); this.drive.play(); }
  }
}

function text(id, words) { if ($(id).textContent !== words) $(id).textContent = words; }

function keyboard(keys) {
  addEventListener("keydown", (event) => {
    if (isTaken(event) || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
}

function tab(id) {
  for (const node of /** @type {NodeListOf<any>} */ (document.querySelectorAll("[role=tab]"))) {
    const isOn = node.id === id;
    node.setAttribute("aria-selected", String(isOn));
    node.tabIndex = isOn ? 0 : -1;
    $(node.getAttribute("aria-controls")).hidden = !isOn;
  }
  if (id === "map-tab" && window.live) window.live.map.open();
  if (window.live) window.live.paint(); // what was hidden has no size until it is seen
}

function tabs() {
  const all = [.../** @type {NodeListOf<any>} */ (document.querySelectorAll("[role=tab]"))];
  all.forEach((node, i) => {
    node.addEventListener("click", () => tab(node.id));
    node.addEventListener("keydown", (event) => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!way) return;
      const next = all[(i + way + all.length) % all.length];
      tab(next.id);
      next.focus();
      event.preventDefault();
    });
  });
}

// Scenario and changes from the address, and what of it means nothing here.
function fromAddress(lab, first) {
  /** @type {{ name: string, changes: Record<string, number>, only: string[], wrong: string[], plays: boolean }} */
  const found = { name: first, changes: {}, only: [], wrong: [], plays: false };
  for (const part of location.hash.slice(1).split("&").filter(Boolean)) {
    const [key, value] = part.split("=").map(decoded);
    if (key === "s" && lab.scenarios.has(value)) found.name = value;
    else if (key === "play") found.plays = true;
    else if (key === "only") found.only = (value || "").split(",");
    else if (key.includes(".") && value) found.changes[key] = Number(value);
    else found.wrong.push(key === "s" ? `no scenario ${value}` : part);
  }
  return found;
}

function decoded(text) { try { return decodeURIComponent(text); } catch { return text; } }

async function start() {
  const begun = performance.now();
  const data = await unpack($("data").textContent.trim());
  const codes = await Promise.all(["module", "mapped"].map((id) => inflate($(id).textContent.trim())));
  const lab = new Lab(await Engine.start(codes[0], data.models), data), page = new Page(lab, data, codes);
  const { name, changes, only, wrong, plays } = fromAddress(lab, data.scenarios[0].name);
  lab.only = only;
  document.documentElement.classList.toggle("embedded", only.length > 0);
  tabs();
  page.load(name, changes, wrong);
  page.stage = new Stage(page.drawn, $("view"), (prefix, pose) => { if (prefix === "slot") lab.situation.moveSlot(pose); else AXES.forEach((axis, i) => lab.situation.set(`${prefix}.${axis}`, pose[i])); page.changed(); });
  page.scene = page.stage;
  page.paint = () => { page.key = ""; page.map.draw(); };
  page.show = page.paint;
  page.page = page.drawn;
  themes(page);
  layers(page);
  addEventListener("hashchange", () => { const found = fromAddress(lab, data.scenarios[0].name); page.load(found.name, found.changes, found.wrong); });
  const frame = (now) => { page.draw(now); requestAnimationFrame(frame); };
  requestAnimationFrame(frame);
  page.took = performance.now() - begun;
  window.live = page;
  document.documentElement.dataset.ready = "yes";
  if (plays) $("play").click();
}

start().catch((error) => {
  $("notice").hidden = false;
  $("notice").textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
