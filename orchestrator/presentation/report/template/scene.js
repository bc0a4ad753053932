// The top view: slot, obstacles, planned and driven path, sensor rays, the car with its steered wheels.

class Scene {
  constructor(page, canvas) {
    this.page = page;
    this.canvas = canvas;
    this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.layers = { planned: true, driven: true, trail: true, sensors: true, optimum: true };
    this.turn = -(page.runs[0].scene.turn || 0);
    /** @type {number[]} what stands in the middle of the canvas */
    this.middle = [0, 0];
    this.scale = this.fitted = 40; // pixels a metre
    this.width = this.height = this.t = 0;
    this.following = false;
    /** @type {number | null} */
    this.mark = null; // time of the other cursor
    this.onFree = () => {};
    this.fit();
    this.listen();
    new ResizeObserver(() => { this.size(); this.fit(); this.draw(this.t || 0); }).observe(canvas);
    this.size();
  }

  size() {
    const box = this.canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    this.width = box.width; this.height = box.height;
    this.canvas.width = Math.round(box.width * ratio);
    this.canvas.height = Math.round(box.height * ratio);
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  // World (already relative to the page's origin) -> view, turned so that the car at first points right.
  turned(x, y) {
    const c = Math.cos(this.turn), s = Math.sin(this.turn);
    return [c * x - s * y, s * x + c * y];
  }

  pixel(x, y) {
    const [u, v] = this.turned(x, y);
    return [this.width / 2 + (u - this.middle[0]) * this.scale, this.height / 2 - (v - this.middle[1]) * this.scale];
  }

  extent() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const take = (x, y, margin = 0) => {
      const [u, v] = this.turned(x, y);
      if (!Number.isFinite(u + v)) return;
      box[0] = Math.min(box[0], u - margin); box[1] = Math.min(box[1], v - margin);
      box[2] = Math.max(box[2], u + margin); box[3] = Math.max(box[3], v + margin);
    };
    for (const run of this.page.runs) {
      const car = run.scene.car;
      run.time.forEach((t, i) => {
        if (i % 8 && i !== run.time.length - 1) return;
        const pose = this.poseAt(run, t);
        for (const [x, y] of rectangle(-car.rear, car.front, car.half)) take(...moved(pose, x, y));
      });
      for (const shape of [run.scene.slot || [], ...run.scene.boxes.map((item) => item.corners)]) shape.forEach(([x, y]) => { if (near(box, ...this.turned(x, y))) take(x, y); });
    }
    return box[0] < box[2] ? box : [-5, -5, 5, 5];
  }

  fit() {
    if (!this.width) this.size();
    const [left, low, right, high] = this.extent();
    this.middle = [(left + right) / 2, (low + high) / 2];
    const room = this.width > 560 ? [40, 56] : [18, 44];
    this.scale = Math.min((this.width - 2 * room[0]) / (right - left), (this.height - 2 * room[1]) / (high - low));
    if (!(this.scale > 0) || !Number.isFinite(this.scale)) this.scale = 40;
    this.fitted = this.scale;
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const scale = Math.min(2000, Math.max(this.fitted / 20, this.scale * factor));
    this.middle[0] += (px - this.width / 2) * (1 / this.scale - 1 / scale);
    this.middle[1] -= (py - this.height / 2) * (1 / this.scale - 1 / scale);
    this.scale = scale;
    this.draw(this.t);
  }

  listen() {
    const pointers = new Map();
    let spread = 0;
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
      if (event.pointerType === "mouse") canvas.setPointerCapture(event.pointerId);
      spread = 0;
    });
    for (const name of ["pointerup", "pointercancel", "pointerleave"])
      canvas.addEventListener(name, (event) => { pointers.delete(event.pointerId); spread = 0; });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = [event.offsetX, event.offsetY];
      pointers.set(event.pointerId, now);
      const share = pointers.size;
      if (event.pointerType === "mouse" || share > 1) {
        this.free();
        this.middle[0] -= (now[0] - before[0]) / this.scale / share;
        this.middle[1] += (now[1] - before[1]) / this.scale / share;
      }
      if (share === 2) {
        const [a, b] = [...pointers.values()];
        const wide = Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (spread > 0) this.zoom(wide / spread, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
        spread = wide;
      }
      this.draw(this.t);
    });
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // the wheel alone scrolls the page
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, { passive: false });
    canvas.addEventListener("dblclick", () => { this.free(); this.fit(); this.draw(this.t); });
  }

  // The car is no longer kept in the middle.
  free() {
    this.following = false;
    this.onFree();
  }

  poseAt(run, t) {
    const [ox, oy] = run.scene.origin, row = run.row(t);
    if (run.apart[row + 1]) t = run.time[row];
    return [run.at("vehicle.pose.x", t) - ox, run.at("vehicle.pose.y", t) - oy, run.at("vehicle.pose.heading", t)];
  }

  draw(t) {
    this.t = t;
    const g = this.context, run = this.page.runs[0];
    if (this.following) {
      const [x, y, heading] = this.poseAt(run, Math.min(t, run.duration));
      if (Number.isFinite(x + y)) this.middle = this.turned(x + 1.2 * Math.cos(heading), y + 1.2 * Math.sin(heading));
    }
    g.clearRect(0, 0, this.width, this.height);
    drawGround(this);
    drawStill(this, run, t);
    this.page.runs.forEach((item, number) => drawPaths(this, item, number, Math.min(t, item.duration)));
    if (this.layers.sensors) drawRays(this, run, Math.min(t, run.duration));
    for (let number = this.page.runs.length - 1; number >= 0; number--) {
      const item = this.page.runs[number];
      drawCar(this, item, number, Math.min(t, item.duration));
    }
    const { mark } = this;
    if (mark !== null) this.page.runs.forEach((item, number) => drawMark(this, item, number, Math.min(mark, item.duration)));
    drawScale(this);
  }

  // Stroke or fill a line through points [[x, y], ...].
  trace(points, closed = false) {
    const g = this.context;
    g.beginPath();
    let pen = false;
    for (const [x, y] of points) {
      const [px, py] = this.pixel(x, y);
      if (!Number.isFinite(px + py)) { pen = false; continue; }
      if (pen) g.lineTo(px, py); else g.moveTo(px, py);
      pen = true;
    }
    if (closed) g.closePath();
  }
}

// Whether a point is not so far from a box that showing it would make everything small.
function near(box, x, y) {
  const reach = Math.max(10, box[2] - box[0], box[3] - box[1]);
  return x > box[0] - reach && x < box[2] + reach && y > box[1] - reach && y < box[3] + reach;
}
