// What stands around the top view: the words over it, its layers and tools, light or dark.

// What driver and controller do at this moment, over the top view.
function headsUp(page, t) {
  const run = page.runs[0];
  const at = Math.min(t, run.duration), box = $("hud");
  const speed = run.at("vehicle.speed", at), wheel = run.at("vehicle.steering_wheel_angle", at);
  const lines = [];
  const key = `${page.ribbons} ${[...page.ribbons, "controller.phase", "controller.prompt", "vehicle.gear"].map((name) => run.at(name, at))} ${Math.round(speed * 36)} ${Math.round(wheel * 57.3)} ${color("ink")}`;
  if (box.dataset.key === key) return;
  box.dataset.key = key;
  const main = run.stateName("controller.phase", run.at("controller.phase", at));
  const outer = page.ribbons.filter((name) => /\.(mode|stage)$/.test(name));
  for (const name of [...outer, "controller.phase", "controller.prompt", "vehicle.gear"])
    if (run.signals[name]) lines.push([outer.includes(name) ? "phase" : name.split(".")[1], run.stateName(name, run.at(name, at)), run.at(name, at)]);
  const cells = lines.filter(([kind, state]) => !(kind === "prompt" && state === "NONE")).map(([kind, state, value]) => {
    const chip = element("span", { class: `tag ${kind}` }, kind === "prompt" ? `driver: ${words(state)}` : words(state));
    if (kind === "phase" && page.runs.length < 2) chip.style.background = main === state ? stateColor(state, value) : modeColor(state, value);
    return chip;
  });
  cells.push(element("span", { class: "tag plain" }, `${digits(Math.round(speed * 36) / 10)} km/h`), element("span", { class: "tag plain" }, `wheel ${digits(Math.round(wheel * 180 / Math.PI))}\u00b0`));
  if (page.runs.length > 1) cells.unshift(element("span", { class: "tag plain" }, `${run.label}:`));
  box.replaceChildren(...cells);
}

function themes(player) {
  const root = document.documentElement, dark = matchMedia("(prefers-color-scheme: dark)");
  const isDark = () => (root.dataset.theme === "auto" ? dark.matches : root.dataset.theme === "dark");
  const paint = () => { COLORS.clear(); player.paint(); };
  $("theme").addEventListener("click", () => { root.dataset.theme = isDark() ? "light" : "dark"; paint(); });
  dark.addEventListener("change", paint);
}

function layers(player) {
  for (const name of Object.keys(player.scene.layers)) {
    if (name === "sensors" && !player.page.runs.some((run) => run.scene.sensors.length)) continue;
    if (name === "optimum" && !player.page.runs.some((run) => run.scene.optimum)) continue;
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => { player.scene.layers[name] = box.checked; player.show(); });
    $("layers").append(element("label", {}, box, name === "optimum" ? "optimum (dotted)" : name));
  }
  player.scene.onFree = () => $("follow").setAttribute("aria-pressed", "false");
  const follow = () => {
    player.scene.following = !player.scene.following;
    $("follow").setAttribute("aria-pressed", String(player.scene.following));
    if (!player.scene.following) player.scene.fit();
    player.show();
  };
  const fit = () => { if (player.scene.following) follow(); player.scene.fit(); player.show(); };
  $("zoom-in").addEventListener("click", () => player.scene.zoom(1.4));
  $("zoom-out").addEventListener("click", () => player.scene.zoom(1 / 1.4));
  $("fit").addEventListener("click", fit);
  $("follow").addEventListener("click", follow);
  return { f: fit, c: follow };
}
