// Shapes in the plane: a rectangle about a point, and a point of a body that stands at a pose.

const rectangle = (back, front, half) => [[back, -half], [front, -half], [front, half], [back, half]];

/** @param {number[]} pose */
function moved([x, y, heading], u, v) {
  const c = Math.cos(heading), s = Math.sin(heading);
  return [x + c * u - s * v, y + s * u + c * v];
}
