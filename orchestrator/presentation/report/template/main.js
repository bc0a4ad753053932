// Puts the page together: one clock for the view, the ribbons and the plots.

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16];

class Player {
  constructor(page) {
    this.page = page;
    this.duration = Math.max(...page.runs.map((run) => run.duration));
    this.t = 0;
    this.shown = 0; // time that is looked at: t, or where the pointer is
    this.mark = null; // time of the other cursor
    this.speed = 1;
    this.playing = false;
    if ($("chart")) { this.chart = new StateChart(); this.chart.fill(page.charts); }
    const seek = (t) => { this.seek(t); };
    this.scene = new Scene(page, $("view"));
    this.timeline = new Timeline(page, seek);
    this.plots = new Plots(page, $("plots"), seek, (t) => this.look(t));
    this.keeper = new Keeper(this);
    this.tools();
    for (const item of SPEEDS) $("speed").append(element("option", { value: item }, `${item}\u00d7`));
    this.setSpeed(1);
    $("play").addEventListener("click", () => this.toggle());
    $("home").addEventListener("click", () => this.seek(0));
    $("end").addEventListener("click", () => this.seek(this.duration));
    $("speed").addEventListener("change", (event) => this.setSpeed(Number(event.target.value)));
  }

  tools() {
    $("mark").addEventListener("click", () => this.setMark(this.mark === null ? this.t : null));
    $("time-in").addEventListener("click", () => this.plots.zoom(1.6));
    $("time-out").addEventListener("click", () => this.plots.zoom(1 / 1.6));
    $("time-all").addEventListener("click", () => this.plots.whole());
  }

  // The other cursor: all differences are from there. null: there is none.
  setMark(t) {
    this.mark = this.plots.mark = this.scene.mark = t;
    $("mark").setAttribute("aria-pressed", String(t !== null));
    this.show();
  }

  setSpeed(speed) { this.speed = speed; $("speed").value = String(speed); }

  faster(way) { this.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, SPEEDS.indexOf(this.speed) + way))]); }

  seek(t) {
    this.t = Math.min(this.duration, Math.max(0, t));
    this.show();
  }

  toggle() { if (this.playing) this.pause(); else this.play(); }

  play() {
    if (this.t >= this.duration) this.t = 0;
    this.playing = true;
    $("play").textContent = "Pause";
    let last = null;
    const frame = (now) => {
      if (!this.playing) return;
      if (last !== null) this.t += (now - last) / 1000 * this.speed;
      last = now;
      if (this.t >= this.duration) { this.t = this.duration; this.pause(); }
      this.show();
      if (this.playing) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  pause() { this.playing = false; $("play").textContent = "Play"; }

  show() {
    this.at(this.t);
    this.plots.show(this.t);
  }

  // While the pointer is on a curve all is as it was at that time; null: as it is now.
  look(t) {
    if (this.playing) return;
    $("clock").classList.toggle("looking", t !== null);
    this.at(t === null ? this.t : Math.min(this.duration, Math.max(0, t)));
  }

  at(t) {
    this.shown = t;
    this.scene.draw(t);
    this.timeline.show(t, this.mark);
    $("clock").textContent = `${t.toFixed(2)} / ${this.duration.toFixed(2)} s${this.mark === null ? "" : ` \u0394 ${signed(t - this.mark)} s, ${digits(this.way(t))} m`}`;
    headsUp(this.page, t);
    if (this.chart) this.chart.show(this.page.runs[0], t);
  }

  // How far the first car is from where it was at the other cursor [m].
  way(t) {
    const run = this.page.runs[0], [a, b] = [t, this.mark].map((time) => this.scene.poseAt(run, Math.min(time, run.duration)));
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  }

  paint() {
    this.timeline.paint();
    this.plots.paint();
    this.show();
  }
}

const signed = (value) => `${value < 0 ? "\u2212" : "+"}${Math.abs(value).toFixed(2)}`;

function headline(page) {
  document.title = page.title;
  $("title").textContent = page.title;
  $("subtitle").textContent = page.subtitle;
  $("verdict").textContent = page.verdict.text;
  $("verdict").classList.add(page.verdict.kind);
  for (const [key, value] of page.facts) {
    $("facts").append(element("div", { class: value.length > 24 ? "wide" : null }, element("dt", {}, key), element("dd", {}, value)));
  }
  $("foot").textContent = page.foot;
  $("plots-said").textContent = page.runs.length > 1 ? "one colour per run" : "solid: measured; dashed: commanded";
  if (page.live) { $("drive").href = page.live; $("drive").hidden = false; }
}

function keyboard(player, extra) {
  const keys = {
    " ": () => player.toggle(), ArrowLeft: (event) => player.seek(player.t - (event.shiftKey ? 1 : 0.1)), ArrowRight: (event) => player.seek(player.t + (event.shiftKey ? 1 : 0.1)),
    Home: () => player.seek(0), End: () => player.seek(player.duration), "+": () => player.scene.zoom(1.4), "=": () => player.scene.zoom(1.4), "-": () => player.scene.zoom(1 / 1.4),
    ">": () => player.faster(1), "<": () => player.faster(-1), ".": () => player.faster(1), ",": () => player.faster(-1),
    m: () => player.setMark(player.shown), Escape: () => player.setMark(null), z: (event) => player.plots.zoom(event.shiftKey ? 1 / 1.6 : 1.6), ...extra,
  };
  document.addEventListener("keydown", (event) => {
    const at = /** @type {HTMLElement} */ (event.target);
    if (event.ctrlKey || event.metaKey || event.altKey || at.closest("input, select, textarea")) return;
    if (event.key === " " && at.closest("button, summary, a")) return;
    const act = keys[event.key] || keys[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}

function links(player) {
  const go = (hash) => {
    const match = /^#t=([\d.]+)$/.exec(hash);
    if (!match) return false;
    player.pause();
    player.seek(Number(match[1]));
    return true;
  };
  document.addEventListener("click", (event) => {
    const link = /** @type {HTMLElement} */ (event.target).closest("a.moment");
    if (!link || !go(link.getAttribute("href"))) return;
    event.preventDefault();
    history.replaceState(null, "", link.getAttribute("href"));
    $("scene").scrollIntoView({ block: "nearest" });
  });
  addEventListener("hashchange", () => go(location.hash));
  return go(location.hash);
}

async function start() {
  const page = await unpack($("data").textContent.trim());
  headline(page);
  fillTables(page);
  const player = new Player(page);
  themes(player);
  const keys = layers(player), fit = keys.f;
  keyboard(player, { ...keys, f: () => { player.plots.whole(); fit(); } });
  if (!links(player)) player.seek(0);
  player.paint();
  window.replay = player;
  document.documentElement.dataset.ready = "yes";
}

start().catch((error) => {
  $("notice").hidden = false;
  $("notice").textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
