// A body as flat faces, drawn from back to front by a binary space partition made once.

import { cross, dot, length, minus, plus, scaled, within } from "./vectors.mjs";

const FLAT = 1e-4; // lengths off a plane that do not count
const LIGHT = [-0.36, 0.48, 0.8]; // right, up and toward the viewer
const trees = new WeakMap(); // a body -> its tree
const THINNEST = 0.1; // of the longest edge: a plate is drawn with some thickness
const SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
const COLORS = [[201, 88, 68], [69, 114, 167], [224, 176, 64]]; // of opposite sides
const cuboids = new Map(); // principal moments -> a body

function facesOf({ points, colors, faces }) {
  return faces.map(([color, ...corners]) => {
    const at = corners.map((k) => points[k]);
    const edges = at.map((p) => minus(p, at[0]));
    const normal = edges.slice(1, -1).reduce((sum, edge, k) => plus(sum, cross(edge, edges[k + 2])), [0, 0, 0]);
    return { points: at, color: colors[color], normal: scaled(1 / (length(normal) || 1), normal) };
  });
}

/** The parts of a face before a plane and behind it. */
function split(face, { normal, points }) {
  const heights = face.points.map((p) => dot(normal, minus(p, points[0])));
  const [front, back] = [[], []];
  face.points.forEach((p, k) => {
    const next = (k + 1) % face.points.length;
    if (heights[k] >= -FLAT) front.push(p);
    if (heights[k] <= FLAT) back.push(p);
    if (heights[k] * heights[next] < 0 && Math.min(Math.abs(heights[k]), Math.abs(heights[next])) > FLAT) {
      const share = heights[k] / (heights[k] - heights[next]);
      const cut = plus(p, scaled(share, minus(face.points[next], p)));
      front.push(cut);
      back.push(cut);
    }
  });
  const isIn = (side) => heights.some((height) => side * height > FLAT);
  return [isIn(1) ? front : [], isIn(-1) ? back : []].map((part) => ({ ...face, points: part }));
}

function treeOf(faces) {
  if (!faces.length) return null;
  const plane = faces[faces.length >> 1];
  const tree = { normal: plane.normal, here: [], front: [], back: [] };
  for (const face of faces) {
    // the plane's own face is on it, though rounding may have bent it a little
    const [front, back] = face === plane ? [null, null] : split(face, plane);
    if (front?.points.length > 2) tree.front.push(front);
    if (back?.points.length > 2) tree.back.push(back);
    if (!front?.points.length && !back?.points.length) tree.here.push(face);
  }
  return { ...tree, front: treeOf(tree.front), back: treeOf(tree.back) };
}

function* fromTheBack(tree, toward) {
  if (!tree) return;
  const isFacing = dot(tree.normal, toward) > 0;
  yield* fromTheBack(isFacing ? tree.back : tree.front, toward);
  yield* tree.here;
  yield* fromTheBack(isFacing ? tree.front : tree.back, toward);
}

/** The homogeneous cuboid with these principal moments, which are Σ m (y² + z²) and so on. */
export function cuboidOf(moments) {
  const key = String(moments);
  if (!cuboids.has(key)) {
    const half = moments.reduce((sum, moment) => sum + moment, 0) / 2;
    const edges = moments.map((moment) => Math.sqrt(Math.max(half - moment, 0)));
    const seen = edges.map((edge) => Math.max(edge, THINNEST * Math.max(...edges)));
    const [x, y, z] = scaled(0.95 / length(seen), seen);
    const points = [-x, x].flatMap((a) => [-y, y].flatMap((b) => [-z, z].map((c) => [a, b, c])));
    cuboids.clear();
    cuboids.set(key, { points, colors: COLORS, faces: SIDES.map((side, k) => [k >> 1, ...side]) });
  }
  return cuboids.get(key);
}

/** The faces that are seen, the farthest first, projected and shaded. */
export function seenFaces(body, frame, camera) {
  if (!trees.has(body)) trees.set(body, treeOf(facesOf(body)));
  const inBody = (v) => frame.map((axis) => dot(axis, v));
  const [right, up, toward] = [camera.right, camera.up, camera.toward].map(inBody);
  const light = within(LIGHT, [right, up, toward]);
  return [...fromTheBack(trees.get(body), toward)]
    .filter(({ normal }) => dot(normal, toward) > 0)
    .map(({ points, color, normal }) => {
      const bright = 0.62 + 0.38 * Math.max(0, dot(normal, light));
      const rgb = color.map((part) => Math.round(part * bright));
      return { points: points.map((p) => [dot(right, p), dot(up, p)]), fill: `rgb(${rgb.join(" ")})` };
    });
}
