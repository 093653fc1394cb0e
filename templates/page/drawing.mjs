// A posed scene as SVG: a body, lines with hidden halves dashed, and labels that keep apart.

import { cross, dot, length, plus, same, scaled } from "./vectors.mjs";
import { seenFaces } from "./body.mjs";

const SCALE = 120; // pixels a length
const TYPE = 17 / SCALE; // the size of the letters, in lengths
const AXIS = 1.35; // lengths of the axes
const NODE = 1.2;
const STEP = (7.5 * Math.PI) / 180; // between the points of an arc
const MOST = 1.5; // lengths of the longest arrow of an angular velocity
const OMEGA = 0.75; // lengths of 1 rad/s, if none is longer than MOST

/** Parallel projection for a viewer in this direction, in degrees; z is vertical. */
export function cameraAt(azimuth, elevation) {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  const right = [-Math.sin(a), Math.cos(a), 0];
  const up = cross(toward, right);
  return { right, up, toward, project: (v) => [dot(right, v), dot(up, v)], depth: (v) => dot(toward, v) };
}

// --- lines

function sampled(at, from, to) {
  const steps = Math.max(2, Math.ceil(Math.abs(to - from) / STEP - 1e-9));
  return Array.from({ length: steps + 1 }, (_, k) => at(from + ((to - from) * k) / steps));
}

/** The circle centre + cos t u + sin t v, in front of the plane of the picture and behind it. */
function circle(style, centre, u, v, camera) {
  const at = (t) => camera.project(plus(centre, plus(scaled(Math.cos(t), u), scaled(Math.sin(t), v))));
  const [across, along, middle] = [u, v, centre].map(camera.depth);
  const nearest = Math.atan2(along, across);
  const swing = Math.hypot(across, along);
  const half = Math.abs(middle) >= swing
    ? (middle >= 0 ? Math.PI : 0)
    : Math.PI / 2 + Math.asin(middle / swing);
  return [
    { ...style, points: sampled(at, nearest - half, nearest + half) },
    { ...style, points: sampled(at, nearest + half, nearest - half + 2 * Math.PI), hidden: true },
  ].filter((_, k) => (k ? half < Math.PI : half > 0));
}

function circleLines({ arcs }, camera) {
  if (!arcs.length) return [];
  const [first, last] = [arcs[0], arcs.at(-1)];
  const one = (kind, { centre, start, side }) => circle({ kind, thin: true }, centre, start, side, camera);
  return [...one("space", first), ...(same(first.axis, last.axis) ? [] : one("body", last))];
}

function ringLines({ rings }, camera, isLocked) {
  const kind = isLocked ? "ring locked" : "ring";
  return rings.flatMap(({ pivot, other, radius }) => {
    const [u, v] = [pivot, other].map((a) => scaled(radius, a));
    const stubs = [1, -1].map((sign) => ({
      kind: `${kind} pivot`,
      points: [radius - 0.04, radius + 0.11].map((r) => camera.project(scaled(sign * r, pivot))),
    }));
    return [...circle({ kind }, [0, 0, 0], u, v, camera), ...stubs];
  });
}

/** Lines to the ends of arcs where there is no axis, from the centre of the arc. */
function guideLines({ arcs, rays }, camera) {
  return arcs.flatMap(({ axis, before, after, centre }) =>
    [before, after]
      .filter((end) => !rays.some((ray) => same(ray.direction, end)) || Math.abs(dot(axis, end)) > 1e-6)
      .map((end) => ({ kind: "guide", points: [centre, end].map(camera.project), thin: true })),
  );
}

function turnLines({ arcs }, camera) {
  return arcs.map(({ centre, start, side, radius, angle, name }) => {
    const at = (t) => camera.project(
      plus(centre, plus(scaled(radius * Math.cos(t), start), scaled(radius * Math.sin(t), side))));
    const isSeen = Math.abs(angle) > 0.02;
    return { kind: "turn", name: isSeen && name, centre: camera.project(centre), points: sampled(at, 0, angle), arrow: isSeen };
  });
}

/** Only a single axis of turns is drawn in both directions; several would be a tangle. */
function axisLines({ rays }, camera) {
  const isSingle = rays.filter(({ kind }) => kind === "node").length === 1;
  return rays.map(({ kind, name, direction }) => {
    const end = camera.project(scaled(kind === "space" || kind === "body" ? AXIS : NODE, direction));
    const start = kind === "node" && isSingle ? scaled(-1, end) : [0, 0];
    return { kind, name, points: [start, end], arrow: kind !== "node" };
  });
}

/** The frames that the turns have reached so far, without the last, which is the body's. */
function frameLines({ frames }, done, letters, camera) {
  return frames.slice(1, -1).filter((_, k) => k + 1 <= done).flatMap((frame, k) =>
    frame.map((axis, n) => ({
      kind: "between",
      name: letters[n] + "₁₂₃₄₅"[k],
      points: [[0, 0], camera.project(axis)],
      arrow: true,
      thin: true,
    })),
  );
}

/** Ω, and its terms tip to tail; the longest of all sums fits. */
function omegaLines({ arcs }, omega, name, isSum, camera) {
  const sums = [[0, 0, 0]];
  const terms = isSum ? arcs.filter(({ rate }) => Math.abs(rate) > 1e-6) : [];
  for (const { axis, rate } of terms) sums.push(plus(sums.at(-1), scaled(rate, axis)));
  const longest = Math.max(...[omega, ...sums].map(length));
  if (longest < 1e-6) return [];
  const scale = Math.min(OMEGA, MOST / longest);
  const points = sums.map((sum) => camera.project(scaled(scale, sum)));
  const lines = terms.map(({ rate_name }, k) => ({
    kind: "term", name: rate_name, points: [points[k], points[k + 1]], arrow: true, beside: true,
  }));
  if (length(omega) > 1e-3) {
    lines.push({ kind: "omega", name, points: [[0, 0], camera.project(scaled(scale, omega))], arrow: true });
  }
  return lines;
}

/** The curve that a point has described, dashed behind the plane of the picture. */
function traceLines(trace, camera) {
  const lines = [];
  trace.slice(1).forEach((point, k) => {
    const hidden = camera.depth(trace[k]) + camera.depth(point) < 0;
    if (lines.at(-1)?.hidden !== hidden) lines.push({ kind: "trace", points: [camera.project(trace[k])], hidden });
    lines.at(-1).points.push(camera.project(point));
  });
  return lines;
}

// --- labels: beyond the end of a line or beside its middle, clear of other labels and of lines

const BENDS = [0, 35, -35, 70, -70, 110, -110]; // degrees off the wished direction
const GAPS = [0.07, 0.2, 0.34];
const SIGHT = [1.6, 1.56]; // lengths from the middle of the picture to its edges
const places = new Map(); // the name of a label -> the bend and the gap that it had

function wishOf({ kind, name, points, beside }) {
  const [a, b] = [points[0], points.at(-1)];
  if (kind !== "turn" && !beside) return { at: b, direction: Math.atan2(b[1] - a[1], b[0] - a[0]) };
  const middle = points.length > 2 ? points[points.length >> 1] : scaled(0.5, [a[0] + b[0], a[1] + b[1]]);
  const outward = beside ? [b[1] - a[1], a[0] - b[0]] : middle;
  const side = beside && outward[0] * middle[0] + outward[1] * middle[1] < 0 ? -1 : 1;
  return { at: middle, direction: Math.atan2(side * outward[1], side * outward[0]) };
}

const meets = (one, other) =>
  [0, 1].every((k) => Math.abs(one.centre[k] - other.centre[k]) < one.half[k] + other.half[k]);

/** The length of the part of a segment that is inside a box. */
function inside([[x, y], [dx, dy]], { centre, half }) {
  let [from, to] = [0, 1];
  for (const [start, step, k] of [[x, dx, 0], [y, dy, 1]]) {
    const ends = [-1, 1].map((side) => (centre[k] + side * half[k] - start) / step);
    if (step) [from, to] = [Math.max(from, Math.min(...ends)), Math.min(to, Math.max(...ends))];
    else if (Math.abs(start - centre[k]) > half[k]) return 0;
  }
  return Math.max(0, to - from) * Math.hypot(dx, dy);
}

/** The segments of all lines, each as its start and its extent. */
function segmentsOf(lines) {
  return lines.flatMap(({ points }) =>
    points.slice(1).map((end, k) => [points[k], [end[0] - points[k][0], end[1] - points[k][1]]]));
}

function labelsOf(lines) {
  const taken = [];
  const segments = segmentsOf(lines);
  for (const line of lines.filter(({ name }) => name)) {
    const { at, direction } = wishOf(line);
    const letters = [...line.name.normalize("NFD")].filter((letter) => !/\p{M}/u.test(letter));
    const half = [(TYPE * 0.6 * letters.length) / 2 + 0.02, TYPE / 2 + 0.02]
    const boxes = GAPS.flatMap((gap) => BENDS.map((bend) => {
      const angle = direction + (bend * Math.PI) / 180;
      const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
      const edge = Math.min(half[0] / Math.abs(dx), half[1] / Math.abs(dy), Math.hypot(...half));
      return { ...line, centre: [at[0] + (edge + gap) * dx, at[1] + (edge + gap) * dy], half };
    }));
    const isFree = (box) =>
      !taken.some((other) => meets(box, other)) &&
      box.centre.every((part, k) => Math.abs(part) + half[k] < SIGHT[k]);
    const crossed = (box) => segments.reduce((sum, segment) => sum + inside(segment, box), 0);
    const free = boxes.filter(isFree).map((box) => ({ box, cost: crossed(box) }));
    const least = Math.min(...free.map(({ cost }) => cost)) + TYPE / 4;
    const before = boxes[places.get(line.name)];
    const fitting = free.filter(({ cost }) => cost <= least).map(({ box }) => box);
    const box = fitting.includes(before) ? before : fitting[0] ?? boxes[0];
    places.set(line.name, boxes.indexOf(box));
    const centre = box.centre.map((part, k) => Math.max(half[k] - SIGHT[k], Math.min(SIGHT[k] - half[k], part)));
    taken.push({ ...box, centre });
  }
  return taken;
}

// --- the pen

const written = (points) =>
  points.map(([x, y]) => `${(x * SCALE).toFixed(1)},${(-y * SCALE).toFixed(1)}`).join(" ");

function element(name, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

/** A slim arrow head whose point is the end of the stroke. */
function headOf({ kind, points }) {
  const [[x0, y0], [x1, y1]] = points.slice(-2);
  const size = 9 / SCALE / (Math.hypot(x1 - x0, y1 - y0) || 1);
  const [dx, dy] = [size * (x1 - x0), size * (y1 - y0)];
  const foot = [x1 - dx, y1 - dy];
  const sides = [1, -1].map((side) => [foot[0] - (side * dy) / 3, foot[1] + (side * dx) / 3]);
  return element("polygon", { class: `head ${kind}`, points: written([[x1, y1], ...sides]) });
}

function pen(stroke) {
  const names = [stroke.kind, stroke.thin && "thin", stroke.hidden && "hidden"];
  const line = { class: names.filter(Boolean).join(" "), points: written(stroke.points) };
  return [element("polyline", line), ...(stroke.arrow ? [headOf(stroke)] : [])];
}

/** A label; the dot of a rate is drawn, since fonts differ in where they set it. */
function lettering({ kind, name, centre: [x, y] }) {
  const letters = name.normalize("NFD").replace("\u0307", "");
  const place = { x: (x * SCALE).toFixed(1), y: (-y * SCALE).toFixed(1), dy: ".32em" };
  const text = element("text", { class: kind, ...place }, letters.normalize("NFC"));
  if (letters.length === name.normalize("NFD").length) return [text];
  const dot = { cx: (x * SCALE + 1.5).toFixed(1), cy: (-y * SCALE - 0.52 * TYPE * SCALE).toFixed(1), r: 1.6 };
  return [text, element("circle", { class: `dot ${kind}`, ...dot })];
}

/**
 * Draw a posed scene into a group of an SVG.
 * `shown` has the sets of lines that are wanted: circles, angles, sum, rings, frames, trace.
 */
export function draw(group, pose, camera, { shown, body, omega, omegaName, trace, done, letters, isLocked }) {
  const circles = shown.has("circles") ? circleLines(pose, camera) : [];
  const rings = shown.has("rings") ? ringLines(pose, camera, isLocked) : [];
  const behind = [...circles, ...rings];
  const turns = shown.has("angles") ? turnLines(pose, camera) : [];
  const lines = [
    ...(shown.has("angles") ? guideLines(pose, camera) : []),
    ...traceLines(trace, camera),
    ...(shown.has("frames") ? frameLines(pose, done, letters, camera) : []),
    ...axisLines(pose, camera),
    ...turns,
    ...(omega ? omegaLines(pose, omega, omegaName, shown.has("sum"), camera) : []),
  ];
  const faces = body ? seenFaces(body, pose.frames.at(-1), camera) : [];
  group.replaceChildren(
    ...behind.filter(({ hidden }) => hidden).flatMap(pen),
    ...faces.map(({ points, fill }) => element("polygon", { class: "face", fill, stroke: fill, points: written(points) })),
    ...turns.map(({ centre, points }) => element("polygon", { class: "area turn", points: written([centre, ...points]) })),
    ...behind.filter(({ hidden }) => !hidden).flatMap(pen),
    ...lines.flatMap(pen),
    ...labelsOf(lines).flatMap(lettering),
  );
}
