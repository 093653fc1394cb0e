// Vectors as arrays of three numbers, and turns of them.

export const STANDARD = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const scaled = (factor, a) => a.map((part) => factor * part);
export const plus = (a, b) => a.map((part, k) => part + b[k]);
export const minus = (a, b) => a.map((part, k) => part - b[k]);
export const length = (a) => Math.hypot(...a);
export const same = (a, b) => a.every((part, k) => Math.abs(part - b[k]) < 1e-6);
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** The vector with these components along the axes of a frame. */
export const within = ([x, y, z], [a, b, c]) => [0, 1, 2].map((k) => x * a[k] + y * b[k] + z * c[k]);

/** A vector turned right-handedly about a unit axis, by an angle in radians (Rodrigues). */
export function turned(a, axis, angle) {
  const along = (1 - Math.cos(angle)) * dot(axis, a);
  return within([Math.cos(angle), Math.sin(angle), along], [a, cross(axis, a), axis]);
}

/** The standard axis that makes the largest angle with a direction; the first of several. */
export function farthest(direction) {
  const lean = (axis) => Math.abs(dot(axis, direction));
  return STANDARD.reduce((a, b) => (lean(b) < lean(a) - 1e-9 ? b : a));
}
