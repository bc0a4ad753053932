// The top view of the page: the scene of the replay page, the ghost of the whole run, and what the mouse may drag.

const GRIP = 12, FINGER = 26; // how near a pointer, or a finger, must come to a handle [px]

class Stage extends Scene {
  constructor(page, canvas, moves) {
    super(page, canvas);
    this.moves = moves; // (prefix, pose) => void
    this.held = null;
    const stop = (event) => { event.stopImmediatePropagation(); event.preventDefault(); };
    canvas.addEventListener("pointerdown", (event) => {
      this.held = this.handleAt(event.offsetX, event.offsetY, event.pointerType === "touch" ? FINGER : GRIP);
      if (!this.held) return;
      canvas.setPointerCapture(event.pointerId);
      stop(event);
    }, { capture: true });
    canvas.addEventListener("touchstart", (event) => { if (this.held) event.preventDefault(); }, { passive: false }); // or the page would scroll
    canvas.addEventListener("pointermove", (event) => {
      if (this.held) { stop(event); this.drag(event.offsetX, event.offsetY); return; }
      const over = this.handleAt(event.offsetX, event.offsetY);
      canvas.style.cursor = over ? "move" : "";
      canvas.title = over ? over.text : "";
    }, { capture: true });
    for (const name of ["pointerup", "pointercancel"])
      canvas.addEventListener(name, (event) => { if (this.held) stop(event); this.held = null; }, { capture: true });
  }

  extent() {
    const own = this.page.runs;
    if (this.page.ghost) this.page.runs = [this.page.ghost];
    const box = super.extent();
    this.page.runs = own;
    return box;
  }

  // Pixel -> world, less the page's origin.
  world(px, py) {
    const u = (px - this.width / 2) / this.scale + this.middle[0], v = this.middle[1] - (py - this.height / 2) / this.scale;
    const c = Math.cos(-this.turn), s = Math.sin(-this.turn);
    return [c * u - s * v, s * u + c * v];
  }

  // Where what can be dragged is moved and turned: a car by its middle and nose, a slot by its ends, beside its target.
  handles() {
    const { origin, car } = this.page.runs[0].scene;
    return this.page.poses().map(([prefix, pose, reach, text]) => {
      const place = [pose[0] - origin[0], pose[1] - origin[1], pose[2]], long = reach || car.front + 0.5;
      return { prefix, pose, place, text, points: [["move", moved(place, reach ? -0.8 * reach : 0.5 * (car.front - car.rear), 0)], ["turn", moved(place, long, 0)]] };
    });
  }

  // The nearest handle within reach, null if there is none.
  handleAt(px, py, reach = GRIP) {
    let found = null, nearest = reach;
    const at = this.world(px, py);
    for (const item of this.handles())
      for (const [what, point] of item.points) {
        const [x, y] = this.pixel(...point), far = Math.hypot(px - x, py - y);
        if (far <= nearest) { nearest = far; found = { ...item, what, grip: [at[0] - item.place[0], at[1] - item.place[1]] }; }
      }
    return found;
  }

  drag(px, py) {
    const { prefix, pose, place, what, grip } = this.held, [x, y] = this.world(px, py), round = (value, digits) => Number(value.toFixed(digits));
    const origin = this.page.runs[0].scene.origin;
    if (what === "move") this.moves(prefix, [round(x - grip[0] + origin[0], 3), round(y - grip[1] + origin[1], 3), pose[2]]);
    else this.moves(prefix, [pose[0], pose[1], round(pose[2] + wrap(Math.atan2(y - place[1], x - place[0]) - place[2]), 4)]);
  }

  draw(t) {
    super.draw(t);
    if (this.page.ghost) this.drawGhost(this.page.ghost);
    if (this.page.poses().length) for (const item of this.handles()) this.drawHandle(item);
  }

  drawGhost(ghost) {
    const g = this.context, [ox, oy] = ghost.scene.origin, x = ghost.values("vehicle.pose.x"), y = ghost.values("vehicle.pose.y");
    if (!x.length) return;
    g.setLineDash([2, 5]);
    g.lineWidth = 2;
    g.strokeStyle = color("run-b");
    this.trace(Array.from(x, (value, i) => [value - ox, y[i] - oy]));
    g.stroke();
    g.setLineDash([4, 4]);
    g.lineWidth = 1.5;
    const car = ghost.scene.car, pose = this.poseAt(ghost, ghost.duration);
    this.trace(rectangle(-car.rear, car.front, car.half).map(([u, v]) => moved(pose, u, v)), true);
    g.stroke();
    g.setLineDash([]);
  }

  drawHandle({ points }) {
    const g = this.context;
    g.lineWidth = 2;
    g.strokeStyle = color("accent");
    this.trace(points.map(([, point]) => point));
    g.stroke();
    for (const [what, point] of points) {
      g.beginPath();
      const [px, py] = this.pixel(point[0], point[1]);
      g.arc(px, py, what === "move" ? 6 : 5, 0, 2 * Math.PI);
      g.fillStyle = color(what === "move" ? "accent" : "card");
      g.fill();
      g.stroke();
    }
  }
}
