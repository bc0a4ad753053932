// A person at the pedals: keys, pedals on the screen, a gamepad; and the lever. Values go to the vehicle's inputs person.*.

const GEARS = { P: 0, R: 1, N: 2, D: 3 };
const SOFT = 0.25, RISE = 1.2, FALL = 5; // pedal of a key pressed; how fast a pedal moves [1/s]
const PADDLES = { accelerator: 7, brake: 6 }; // buttons of a gamepad: right and left trigger

class Driver {
  constructor() {
    this.drives = false;
    this.lever = GEARS.P;
    this.confirm = false;
    this.pressed = { accelerator: new Map(), brake: new Map() }; // source -> how far
    this.pedal = { accelerator: 0, brake: 0 };
    this.onChange = () => {};
  }

  take() { this.drives = true; this.onChange(); }

  press(pedal, source, share) {
    if (share > 0) { this.pressed[pedal].set(source, share); this.drives = true; } else this.pressed[pedal].delete(source);
    this.onChange();
  }

  shift(gear) { this.lever = GEARS[gear]; this.take(); }

  release() {
    for (const pedal of Object.values(this.pressed)) pedal.clear();
    this.confirm = false;
  }

  gamepad() {
    const pad = [...(navigator.getGamepads ? navigator.getGamepads() : [])].find(Boolean);
    if (!pad) return;
    for (const [pedal, button] of Object.entries(PADDLES)) {
      const value = pad.buttons[button] ? pad.buttons[button].value : 0;
      if (value > 0.02 || this.pressed[pedal].has("gamepad")) this.press(pedal, "gamepad", value > 0.02 ? value : 0);
    }
    for (const [button, gear] of [[0, "D"], [1, "R"], [2, "N"], [3, "P"]]) if (pad.buttons[button] && pad.buttons[button].pressed && this.lever !== GEARS[gear]) this.shift(gear);
  }

  // Pedals move towards what is pressed, as feet do.
  move(dt) {
    for (const name of Object.keys(this.pedal)) {
      const wanted = Math.max(0, ...this.pressed[name].values()), now = this.pedal[name];
      this.pedal[name] = wanted > now ? Math.min(wanted, now + RISE * dt) : Math.max(wanted, now - FALL * dt);
    }
  }

  give(course) {
    course.set("vehicle.manual.active", this.drives ? 1 : 0);
    course.set("vehicle.manual.accelerator", this.pedal.accelerator);
    course.set("vehicle.manual.brake", this.pedal.brake);
    course.set("vehicle.manual.lever", this.lever);
    course.set("vehicle.manual.confirm", this.confirm ? 1 : 0);
  }
}

// Buttons that are held: pedals on the screen, for mouse, touch and keyboard.
function holdButton(node, press) {
  node.addEventListener("pointerdown", (event) => { node.setPointerCapture(event.pointerId); press(true); event.preventDefault(); });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) node.addEventListener(name, () => press(false));
  node.addEventListener("keydown", (event) => { if (event.key === " " || event.key === "Enter") { press(true); event.preventDefault(); event.stopPropagation(); } });
  node.addEventListener("keyup", (event) => { if (event.key === " " || event.key === "Enter") press(false); });
  node.addEventListener("blur", () => press(false));
  node.addEventListener("contextmenu", (event) => event.preventDefault());
}

// Whether a key is for what has the focus: text for a field, arrows for whatever moves by arrows, space for what it switches.
function isTaken(event) {
  const at = /** @type {HTMLElement} */ (event.target), is = (kinds) => at.closest(kinds) !== null;
  if (event.ctrlKey || event.metaKey || event.altKey || is("textarea, select, input:not([type=checkbox], [type=radio], [type=range])")) return true;
  if (event.key.startsWith("Arrow") || event.key === "Home") return is("[type=radio], [type=range], [role=tab], .grid");
  return event.key === " " && is("input:not([type=radio]:checked, [type=range]), button, summary, a");
}

function driverKeys(driver) {
  const pedals = { w: "accelerator", arrowup: "accelerator", s: "brake", arrowdown: "brake" }, gears = { p: "P", r: "R", n: "N", d: "D" };
  addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (isTaken(event)) return;
    if (pedals[key]) { driver.press(pedals[key], key, event.shiftKey ? 1 : pedals[key] === "brake" ? 0.4 : SOFT); event.preventDefault(); }
    else if (gears[key]) driver.shift(gears[key]);
    else if (key === "c") { driver.confirm = true; driver.take(); }
  });
  addEventListener("keyup", (event) => {
    const key = event.key.toLowerCase();
    if (pedals[key]) driver.press(pedals[key], key, 0);
    else if (key === "c") driver.confirm = false;
  });
  addEventListener("blur", () => driver.release());
}

// Short tones when the prompt changes; off until they are switched on.
class Sounds {
  constructor() { this.isOn = false; }

  play(prompt) {
    if (!this.isOn || prompt === "NONE") return;
    this.context = this.context || new AudioContext();
    const tones = prompt === "STOP" || prompt === "TAKE_OVER" ? [880, 880, 880] : prompt === "SLOW_DOWN" ? [660, 660] : [520, 780];
    tones.forEach((pitch, i) => {
      const tone = this.context.createOscillator(), loud = this.context.createGain(), at = this.context.currentTime + 0.16 * i;
      tone.frequency.value = pitch;
      loud.gain.setValueAtTime(0.12, at);
      loud.gain.exponentialRampToValueAtTime(0.001, at + 0.14);
      tone.connect(loud).connect(this.context.destination);
      tone.start(at);
      tone.stop(at + 0.15);
    });
  }
}
