// What is drawn in the top view, piece by piece, from the ground up.

function drawGround(scene) {
  const g = scene.context;
  const spacing = [0.5, 1, 2, 5, 10, 20, 50, 100].find((step) => step * scene.scale >= 34) || 200;
  g.strokeStyle = color("grid");
  g.lineWidth = 1;
  g.beginPath();
  const left = scene.middle[0] - scene.width / 2 / scene.scale, low = scene.middle[1] - scene.height / 2 / scene.scale;
  for (let u = Math.ceil(left / spacing) * spacing; u < left + scene.width / scene.scale; u += spacing) {
    const px = Math.round((u - left) * scene.scale) + 0.5;
    g.moveTo(px, 0); g.lineTo(px, scene.height);
  }
  for (let v = Math.ceil(low / spacing) * spacing; v < low + scene.height / scene.scale; v += spacing) {
    const py = Math.round(scene.height - (v - low) * scene.scale) + 0.5;
    g.moveTo(0, py); g.lineTo(scene.width, py);
  }
  g.stroke();
}

function drawStill(scene, run, t) {
  const g = scene.context, still = run.scene;
  if (still.slot) {
    scene.trace(still.slot, true);
    g.fillStyle = color("slot");
    g.fill();
    g.strokeStyle = color("slot-line");
    g.lineWidth = Math.max(1.5, 0.07 * scene.scale);
    g.stroke();
  }
  for (const box of still.boxes) if (t >= box.from && t < box.to) drawThing(scene, box);
  g.lineWidth = Math.max(2, 0.12 * scene.scale);
  g.strokeStyle = color("kerb");
  for (const kerb of still.kerbs) { scene.trace(kerb); g.stroke(); }
  if (still.target) {
    const car = still.car;
    scene.trace(rectangle(-car.rear, car.front, car.half).map(([u, v]) => moved(still.target, u, v)), true);
    g.setLineDash([5, 5]);
    g.lineWidth = 1.5;
    g.strokeStyle = color("target");
    g.stroke();
    g.setLineDash([]);
  }
}

const PERSON = 1.0; // no side of a person is longer [m]
const CAR = [3, 6.5, 1.4, 2.3]; // from and to which length and width a box is a car [m]

// What a box of the scene looks like, as looks.py says: a person comes or goes and is small, a car is as long and wide as one.
function looks({ corners: [a, b, c], from, to }) {
  const sides = [Math.hypot(b[0] - a[0], b[1] - a[1]), Math.hypot(c[0] - b[0], c[1] - b[1])], [width, length] = sides.sort((one, two) => one - two);
  if (length <= PERSON && (from > 0 || to < 1e6)) return "person";
  return length >= CAR[0] && length <= CAR[1] && width >= CAR[2] && width <= CAR[3] ? "car" : "box";
}

function drawThing(scene, box) {
  const g = scene.context, what = looks(box), [a, b, c, d] = box.corners;
  const at = (u, v) => [0, 1].map((i) => a[i] + u * (b[i] - a[i]) + v * (d[i] - a[i])); // 0 to 1 along and across
  if (what === "person") { drawPerson(scene, at(0.5, 0.5), Math.atan2(b[1] - a[1], b[0] - a[0]), 0.5 * Math.hypot(c[0] - a[0], c[1] - a[1])); return; }
  g.fillStyle = color("box");
  g.strokeStyle = color("box-line");
  g.lineWidth = 1.5;
  if (what === "box") scene.trace(box.corners, true); else rounded(scene, box.corners, 0.3);
  g.fill();
  if (box.from > 0 || box.to < 1e6) { g.strokeStyle = color("warn"); g.setLineDash([6, 4]); }
  g.stroke();
  g.setLineDash([]);
  if (what !== "car") return;
  const along = Math.hypot(b[0] - a[0], b[1] - a[1]) >= Math.hypot(d[0] - a[0], d[1] - a[1]), place = (u, v) => (along ? at(u, v) : at(v, u));
  g.fillStyle = color("box-line");
  for (const [near, far] of [[0.24, 0.34], [0.82, 0.74]]) { scene.trace([place(near, 0.1), place(near, 0.9), place(far, 0.84), place(far, 0.16)], true); g.fill(); }
}

// Somebody from above: shoulders, head, and a ring of the room that the box takes.
/** @param {any} scene @param {number[]} at @param {number} heading @param {number} radius */
function drawPerson(scene, [x, y], heading, radius) {
  const g = scene.context, [px, py] = scene.pixel(x, y), size = Math.max(5, 0.72 * radius * scene.scale), turn = -(scene.turn + heading);
  const oval = (long, wide, fill) => { g.beginPath(); g.ellipse(px, py, long, wide, turn, 0, 2 * Math.PI); g.fillStyle = fill; g.fill(); };
  g.beginPath();
  g.arc(px, py, Math.max(8, 1.1 * radius * scene.scale), 0, 2 * Math.PI);
  g.setLineDash([4, 3]);
  g.lineWidth = 1.5;
  g.strokeStyle = color("warn");
  g.stroke();
  g.setLineDash([]);
  oval(0.55 * size, size, color("person"));
  oval(0.45 * size, 0.45 * size, color("skin"));
}

// The slot that was found, the pose wanted, the path planned.
function drawPlan(scene, run, plan) {
  if (!plan) return;
  const g = scene.context, car = run.scene.car;
  g.setLineDash([7, 6]);
  g.lineWidth = 2;
  g.strokeStyle = color("asked");
  for (const shape of [plan.slot, plan.target && rectangle(-car.rear, car.front, car.half).map(([u, v]) => moved(plan.target, u, v))])
    if (shape) { scene.trace(shape, true); g.stroke(); }
  scene.trace(Array.from(plan.x, (x, i) => [x, plan.y[i]]));
  g.stroke();
  g.setLineDash([]);
}

// The path of the time-optimal motion that the drive is compared with.
function drawOptimum(scene, points) {
  const g = scene.context;
  g.setLineDash([2, 5]);
  g.lineWidth = 2;
  g.strokeStyle = color("good");
  scene.trace(points);
  g.stroke();
  g.setLineDash([]);
}

// The points the controller has in mind, by name: Q1 to Q4, P1 to P4, LA1 and LA2.
function drawKeyPoints(scene, run, t) {
  const g = scene.context, [ox, oy] = run.scene.origin;
  const poses = Object.keys(run.signals).flatMap((name) => {
    const match = /^(controller\.(?:.*\.)?([pq]\d|la\d))\.x$/.exec(name);
    return match ? [[match[1], match[2]]] : [];
  });
  g.fillStyle = color("asked");
  g.font = "11px sans-serif";
  const seen = poses.map(([pose, name]) => [name, ...["x", "y", "heading"].map((axis) => run.at(`${pose}.${axis}`, t))]);
  const known = new Set(seen.filter(([, ...at]) => at.some(Boolean)).map(([name]) => name[0]));
  for (const [name, x, y] of seen) {
    if (!known.has(name[0]) || !Number.isFinite(x + y)) continue;
    const [px, py] = scene.pixel(x - ox, y - oy);
    g.beginPath();
    g.arc(px, py, 3.5, 0, 2 * Math.PI);
    g.fill();
    g.fillText(name.toUpperCase(), px + 6, py - 5);
  }
}

function drawPaths(scene, run, number, t) {
  const g = scene.context, [ox, oy] = run.scene.origin;
  g.lineJoin = g.lineCap = "round";
  if (scene.layers.optimum && run.scene.optimum) drawOptimum(scene, run.scene.optimum);
  if (scene.layers.planned && number === 0) { drawPlan(scene, run, run.plan(t)); drawKeyPoints(scene, run, t); }
  if (scene.layers.trail) drawTrail(scene, run, number, t);
  if (!scene.layers.driven) return;
  const x = run.values("vehicle.pose.x"), y = run.values("vehicle.pose.y");
  if (!x || !y) return;
  const now = run.row(t), path = (first, last) => driven(run, first, last).map(([u, v]) => [u - ox, v - oy]);
  g.lineWidth = 2;
  g.strokeStyle = color("ahead");
  scene.trace(path(now, x.length - 1));
  g.stroke();
  g.lineWidth = 3;
  const name = scene.page.ribbons[0];
  if (scene.page.runs.length > 1 || !name) {
    g.strokeStyle = runColor(number);
    scene.trace([...path(0, now), scene.poseAt(run, t)]);
    g.stroke();
    return;
  }
  for (const span of run.spans(name)) {
    if (span.from > t) break;
    const last = Math.min(run.row(span.to), now);
    g.strokeStyle = stateColor(run.stateName(name, span.value), span.value);
    scene.trace([...path(run.row(span.from), last), ...(last === now ? [scene.poseAt(run, t)] : [])]);
    g.stroke();
  }
}

// Points of the path driven between two rows; a dot instead of a line where the row before is too far away.
function driven(run, first, last) {
  const x = run.values("vehicle.pose.x"), y = run.values("vehicle.pose.y"), points = [];
  for (let row = first; row <= last; row++) {
    if (run.apart[row]) points.push([NaN, NaN], [x[row], y[row]]);
    points.push([x[row], y[row]]);
  }
  return points;
}

// Outlines where the car was, at equal distances.
function drawTrail(scene, run, number, t) {
  const g = scene.context, car = run.scene.car;
  if (!run.trail) {
    run.trail = [];
    let last = null;
    for (const time of run.time) {
      const pose = scene.poseAt(run, time);
      if (!Number.isFinite(pose[0] + pose[1] + pose[2])) continue;
      const far = last && Math.hypot(pose[0] - last[0], pose[1] - last[1]) + 1.5 * Math.abs(pose[2] - last[2]);
      if (!last || far > 0.55) { run.trail.push([time, pose]); last = pose; }
    }
  }
  g.lineWidth = 1;
  g.strokeStyle = number ? runColor(number) : color("trail");
  g.globalAlpha = number ? 0.18 : 1;
  for (const [time, pose] of run.trail) {
    if (time > t) break;
    scene.trace(rectangle(-car.rear, car.front, car.half).map(([u, v]) => moved(pose, u, v)), true);
    g.stroke();
  }
  g.globalAlpha = 1;
}

function drawRays(scene, run, t) {
  const g = scene.context, pose = scene.poseAt(run, t);
  for (const sensor of run.scene.sensors) {
    const range = run.at(sensor.signal, t);
    if (!Number.isFinite(range) || range <= 0) continue;
    const seen = range < 0.999 * sensor.range, reach = seen ? range : Math.min(0.45, sensor.range);
    const [x, y] = moved(pose, sensor.x, sensor.y);
    const middle = scene.pixel(x, y), facing = -(scene.turn + pose[2] + sensor.heading);
    g.beginPath();
    g.moveTo(...middle);
    g.arc(...middle, reach * scene.scale, facing - sensor.half, facing + sensor.half);
    g.closePath();
    g.fillStyle = color(seen ? "ray" : "ray-free");
    g.fill();
    if (!seen) continue;
    g.beginPath();
    g.arc(...middle, reach * scene.scale, facing - sensor.half, facing + sensor.half);
    g.strokeStyle = color("ray-line");
    g.lineWidth = 2;
    g.stroke();
  }
}

// Angles of the left and right front wheels for one equivalent angle (Ackermann).
function wheelAngles(angle, car) {
  const tangent = Math.tan(angle), track = car.half - 0.18;
  return [Math.atan2(car.wheelbase * tangent, car.wheelbase + track * tangent), Math.atan2(car.wheelbase * tangent, car.wheelbase - track * tangent)];
}

function drawWheel(scene, pose, x, y, angle) {
  const g = scene.context, [cx, cy] = moved(pose, x, y), heading = pose[2] + angle;
  scene.trace(rectangle(-0.31, 0.31, 0.1).map(([u, v]) => moved([cx, cy, heading], u, v)), true);
  g.fillStyle = color("tyre");
  g.fill();
}

function drawCar(scene, run, number, t) {
  const g = scene.context, car = run.scene.car, pose = scene.poseAt(run, t);
  if (!Number.isFinite(pose[0] + pose[1] + pose[2])) return;
  const angle = run.at("vehicle.front_wheel_angle", t), [right, left] = wheelAngles(Number.isFinite(angle) ? angle : 0, car);
  body(scene, pose, car);
  g.fillStyle = run.at("vehicle.contact", t) > 0 ? color("bad") : number ? runColor(number) : color("body");
  g.globalAlpha = number ? 0.25 : 1;
  g.fill();
  g.globalAlpha = 1;
  g.strokeStyle = number ? runColor(number) : color("body-line");
  g.lineWidth = 1.5;
  g.stroke();
  const side = car.half - 0.12;
  for (const [x, y, turn] of [[0, -side, 0], [0, side, 0], [car.wheelbase, -side, right], [car.wheelbase, side, left]])
    drawWheel(scene, pose, x, y, turn);
  const at = (u, v) => moved(pose, u, v), length = car.front + car.rear, half = car.half;
  const glass = (points) => { scene.trace(points.map(([u, v]) => at(u, v)), true); g.fillStyle = color("glass"); g.fill(); };
  const nose = car.front - 0.27 * length, tail = -car.rear + 0.12 * length;
  glass([[nose, -0.78 * half], [nose, 0.78 * half], [nose - 0.13 * length, 0.66 * half], [nose - 0.13 * length, -0.66 * half]]);
  glass([[tail, -0.7 * half], [tail, 0.7 * half], [tail + 0.08 * length, 0.62 * half], [tail + 0.08 * length, -0.62 * half]]);
  const reverse = run.stateName("vehicle.gear", run.at("vehicle.gear", t)) === "REVERSE";
  const braking = run.at("vehicle.brake_pedal", t) > 0.01;
  for (const flank of [-1, 1]) {
    const lamp = (u, from, to, fill) => { scene.trace([[u, flank * from], [u, flank * to], [u + 0.12, flank * to], [u + 0.12, flank * from]].map(([a, b]) => at(a, b)), true); g.fillStyle = fill; g.fill(); };
    lamp(car.front - 0.2, 0.55 * half, 0.85 * half, color("lamp"));
    lamp(-car.rear + 0.06, 0.6 * half, 0.88 * half, braking ? "#ff3b30" : color("tail"));
    if (reverse) lamp(-car.rear + 0.06, 0.38 * half, 0.56 * half, "#ffffff");
  }
  const [px, py] = scene.pixel(pose[0], pose[1]);
  g.beginPath();
  g.arc(px, py, (car.front + car.rear) * scene.scale < 16 ? 6 : 3, 0, 2 * Math.PI);
  g.fillStyle = runColor(number);
  g.fill();
}

// The body with rounded corners as the current path.
function body(scene, pose, car) { rounded(scene, rectangle(-car.rear, car.front, car.half).map(([u, v]) => moved(pose, u, v)), 0.28); }

function rounded(scene, shape, radius) {
  const g = scene.context, r = radius * scene.scale, corners = shape.map(([x, y]) => scene.pixel(x, y));
  g.beginPath();
  g.moveTo((corners[3][0] + corners[0][0]) / 2, (corners[3][1] + corners[0][1]) / 2);
  corners.forEach((corner, i) => g.arcTo(...corner, ...corners[(i + 1) % 4], r));
  g.closePath();
}

// The car where it was at the other cursor: its outline alone.
function drawMark(scene, run, number, t) {
  const g = scene.context;
  body(scene, scene.poseAt(run, t), run.scene.car);
  g.setLineDash([3, 3]);
  g.lineWidth = 2;
  g.strokeStyle = number ? runColor(number) : color("ink");
  g.stroke();
  g.setLineDash([]);
}

function drawScale(scene) {
  const g = scene.context, length = [0.5, 1, 2, 5, 10, 20, 50].find((step) => step * scene.scale >= 50) || 100;
  const x = 16, y = scene.height - 16, end = x + length * scene.scale;
  g.strokeStyle = g.fillStyle = color("ink-soft");
  g.lineWidth = 1.5;
  g.beginPath();
  g.moveTo(x, y - 4); g.lineTo(x, y); g.lineTo(end, y); g.lineTo(end, y - 4);
  g.stroke();
  g.font = "12px system-ui, sans-serif";
  g.textAlign = "left";
  g.fillText(`${length} m`, end + 6, y + 1);
}
