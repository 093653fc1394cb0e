// The figure: the scene of the note at the angles of the sliders, with the body, as SVG.

// --- vectors as arrays of three numbers

const STANDARD = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (factor, a) => a.map((part) => factor * part);
const plus = (a, b) => a.map((part, k) => part + b[k]);
const minus = (a, b) => a.map((part, k) => part - b[k]);
const length = (a) => Math.hypot(...a);
const same = (a, b) => a.every((part, k) => Math.abs(part - b[k]) < 1e-6);
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** The vector with these components along the axes of a frame. */
const within = ([x, y, z], [a, b, c]) => [0, 1, 2].map((k) => x * a[k] + y * b[k] + z * c[k]);

/** A vector turned right-handedly about a unit axis, by an angle in radians (Rodrigues). */
function turned(a, axis, angle) {
  const along = (1 - Math.cos(angle)) * dot(axis, a);
  return within([Math.cos(angle), Math.sin(angle), along], [a, cross(axis, a), axis]);
}

/** The standard axis that makes the largest angle with a direction; the first of several. */
function farthest(direction) {
  const lean = (axis) => Math.abs(dot(axis, direction));
  return STANDARD.reduce((a, b) => (lean(b) < lean(a) - 1e-9 ? b : a));
}

// --- the scene: rays, arcs and rings in space

/** The single turn of a rotation: its axis and its angle, from the axes of the body. */
function wholeTurn([x, y, z], vector, given) {
  const twice = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
  const trace = x[0] + y[1] + z[2];
  if (vector) {
    if (length(vector) < 1e-6) return null;
    const axis = scaled(1 / length(vector), vector);
    const angle = Math.atan2(dot(twice, axis), trace - 1);
    return { axis, angle: given ?? (angle < 0 ? angle + 2 * Math.PI : angle) };
  }
  const angle = Math.atan2(length(twice), trace - 1);
  if (angle < 1e-6) return null;
  if (length(twice) > 1e-6) return { axis: scaled(1 / length(twice), twice), angle };
  // half a turn: the axis is the longest column of R + 1
  const columns = [x, y, z].map((column, k) => plus(column, STANDARD[k]));
  const longest = columns.reduce((a, b) => (length(a) >= length(b) ? a : b));
  return { axis: scaled(1 / length(longest), longest), angle };
}

/**
 * The scene after `done` turns, where 1.5 is half of the second turn.
 * Each turn has its axis in components before it, its angle and its rate in radians.
 */
function posed(scene, turns, done) {
  const frames = [STANDARD];
  const arcs = turns.map(({ axis, angle, rate }, k) => {
    const frame = frames.at(-1);
    const about = within(axis, frame);
    const shown = angle * Math.min(1, Math.max(0, done - k));
    frames.push(frame.map((a) => turned(a, about, shown)));
    const { start, radius, name, rate_name } = scene.turns[k];
    const before = within(start ?? farthest(axis), frame);
    const after = turned(before, about, shown);
    const centre = scaled(dot(before, about), about);
    const side = cross(about, before);
    return { axis: about, angle: shown, rate, before, after, centre, start: minus(before, centre), side, radius, name, rate_name };
  });
  return { frames, arcs, rays: raysOf(scene, frames, arcs), rings: ringsOf(turns, frames) };
}

/** Each named direction once; an axis that has two names bears both. */
function raysOf(scene, frames, arcs) {
  const rays = [];
  for (const { kind, name, frame, direction } of scene.rays) {
    const found = direction
      ? within(direction, frames[Math.min(frame, frames.length - 1)])
      : arcs[frame]?.axis;
    if (!found) continue; // no turn, no axis
    const known = rays.find((ray) => same(ray.direction, found));
    if (!known) rays.push({ kind, name, direction: found });
    else if (kind === "body") known.name += ` = ${name}`;
  }
  return rays;
}

/** The rings of a gimbal: each turns about a pivot on the ring outside it, and holds the next. */
function ringsOf(turns, frames) {
  if (turns.length < 2) return [];
  return turns.map(({ axis }, k) => {
    const next = turns[k + 1]?.axis ?? turns[k - 1].axis;
    const across = minus(next, scaled(dot(next, axis), axis));
    const side = length(across) > 1e-6 ? scaled(1 / length(across), across) : farthest(axis);
    const [pivot, other] = [axis, side].map((v) => within(v, frames[k + 1]));
    return { pivot, other, radius: 1.4 - 0.15 * k };
  });
}

// --- a body as flat faces, drawn from back to front by a binary space partition made once

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
function cuboidOf(moments) {
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
function seenFaces(body, frame, camera) {
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

// --- lines, with hidden halves dashed

const SCALE = 120; // pixels a length
const TYPE = 17 / SCALE; // the size of the letters, in lengths
const AXIS = 1.35; // lengths of the axes
const NODE = 1.2;
const STEP = (7.5 * Math.PI) / 180; // between the points of an arc
const MOST = 1.5; // lengths of the longest arrow of an angular velocity
const OMEGA = 0.75; // lengths of 1 rad/s, if none is longer than MOST

/** Parallel projection for a viewer in this direction, in degrees; z points up, or down if `sense` is −1. */
function cameraAt(azimuth, elevation, sense) {
  const [a, e] = [(azimuth * Math.PI) / 180, (elevation * Math.PI) / 180];
  const toward = [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), sense * Math.sin(e)];
  const right = [-sense * Math.sin(a), sense * Math.cos(a), 0];
  const up = cross(toward, right);
  return { right, up, toward, project: (v) => [dot(right, v), dot(up, v)], depth: (v) => dot(toward, v) };
}

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

const BENDS = [0, 35, -35, 70, -70, 110, -110, 180]; // degrees off the wished direction
const GAPS = [0.05, 0.12, 0.2];
const FAR = 1; // length of crossed lines that a label may have so that it is nearer by 1
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

function labelsOf(lines, rings) {
  const taken = [];
  const segments = segmentsOf([...lines, ...rings]);
  for (const line of lines.filter(({ name }) => name)) {
    const { at, direction } = wishOf(line);
    const letters = [...line.name.normalize("NFD")].filter((letter) => !/\p{M}/u.test(letter));
    const half = [(TYPE * 0.6 * letters.length) / 2 + 0.02, TYPE / 2 + 0.02]
    const boxes = GAPS.flatMap((gap) => BENDS.map((bend) => {
      const angle = direction + (bend * Math.PI) / 180;
      const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
      const edge = Math.min(half[0] / Math.abs(dx), half[1] / Math.abs(dy), Math.hypot(...half));
      const centre = [at[0] + (edge + gap) * dx, at[1] + (edge + gap) * dy];
      return { ...line, centre, half, far: FAR * gap };
    }));
    const isFree = (box) =>
      !taken.some((other) => meets(box, other)) &&
      box.centre.every((part, k) => Math.abs(part) + half[k] < SIGHT[k]);
    const crossed = (box) => segments.reduce((sum, segment) => sum + inside(segment, box), 0);
    const free = boxes.filter(isFree).map((box) => ({ box, cost: crossed(box) + box.far }));
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

/** A label without the dots of its rates, and the numbers of the letters that have one. */
function lettering({ kind, name, centre: [x, y] }) {
  const parts = name.normalize("NFD").split("\u0307").map((part) => part.normalize("NFC"));
  const place = { x: (x * SCALE).toFixed(1), y: (-y * SCALE).toFixed(1), dy: ".32em" };
  const text = element("text", { class: kind, ...place }, parts.join(""));
  return { text, dotted: parts.slice(0, -1).map((_, k) => parts.slice(0, k + 1).join("").length - 1) };
}

/** The dots of a label that is in the page; they are drawn, since fonts differ in where they set them. */
function dotsOf({ text, dotted }) {
  const cy = (text.getAttribute("y") - 0.52 * TYPE * SCALE).toFixed(1);
  return dotted.map((k) => {
    const middle = (text.getStartPositionOfChar(k).x + text.getEndPositionOfChar(k).x) / 2;
    return element("circle", { class: `dot ${text.getAttribute("class")}`, cx: (middle + 1.5).toFixed(1), cy, r: 1.6 });
  });
}

/**
 * Draw a posed scene into a group of an SVG.
 * `shown` has the sets of lines that are wanted: circles, angles, sum, rings, frames, trace.
 */
function draw(group, pose, camera, { shown, body, omega, omegaName, trace, done, letters, isLocked }) {
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
  const labels = labelsOf(lines, rings).map(lettering);
  const faces = body ? seenFaces(body, pose.frames.at(-1), camera) : [];
  group.replaceChildren(
    ...behind.filter(({ hidden }) => hidden).flatMap(pen),
    ...faces.map(({ points, fill }) => element("polygon", { class: "face", fill, stroke: fill, points: written(points) })),
    ...turns.map(({ centre, points }) => element("polygon", { class: "area turn", points: written([centre, ...points]) })),
    ...behind.filter(({ hidden }) => !hidden).flatMap(pen),
    ...lines.flatMap(pen),
    ...labels.map(({ text }) => text),
  );
  group.append(...labels.flatMap(dotsOf)); // where the letters are is known once they are in the page
}
