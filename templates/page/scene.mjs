// The scene of the note's figure at the angles of the sliders: rays, arcs and rings in space.

import { STANDARD, cross, dot, farthest, length, minus, plus, same, scaled, turned, within } from "./vectors.mjs";

/** The single turn of a rotation: its axis and its angle, from the axes of the body. */
export function wholeTurn([x, y, z], vector, given) {
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
export function posed(scene, turns, done) {
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
