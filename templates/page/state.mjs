// The state: coordinates, rates and constants in radians and SI units, bound where they have to be.

import { kernels, page } from "./generated.mjs";

export const state = { q: [], q_dot: [], omega_body: [], parameters: [...page.parameters], t: 0 };
for (const { kind, place, start, factor } of page.controls) state[kind][place] = start * factor;

/** The vectors that functions take: those of the state, and y, which is q and the rates or Ω′. */
const given = (input) => (input === "y" ? [...state.q, ...state[page.second]] : state[input]);
export const evaluated = (name) => kernels[name](...page.inputs[name].map(given));

/** In Euler's form the rates follow from Ω′. */
export function follow() {
  if (page.second === "omega_body") state.q_dot = evaluated("state_derivative").slice(0, state.q.length);
}

/** x with A x = b, by elimination with pivots; A is small and regular. */
function solved(a, b) {
  const rows = a.map((row, k) => [...row, b[k]]);
  rows.forEach((_, k) => {
    const sizes = rows.map((row, n) => (n < k ? -1 : Math.abs(row[k])));
    const best = sizes.indexOf(Math.max(...sizes));
    [rows[k], rows[best]] = [rows[best], rows[k]];
    for (const row of rows.slice(k + 1)) {
      const factor = row[k] / rows[k][k];
      rows[k].forEach((value, n) => (row[n] -= factor * value));
    }
  });
  const x = [];
  for (let k = rows.length - 1; k >= 0; k -= 1) {
    const rest = x.reduce((sum, value, n) => sum + (value ?? 0) * rows[k][n], 0);
    x[k] = (rows[k].at(-1) - rest) / rows[k][k];
  }
  return x;
}

/** The smallest change of the inputs that cancels `excess`, weighted by the ease of each. */
function correction(slopes, excess, ease) {
  const a = slopes.map((p) =>
    slopes.map((r) => p.reduce((sum, value, k) => sum + ease[k] * value * r[k], 0)),
  );
  a.forEach((row, k) => (row[k] += 1e-14));
  const x = solved(a, excess);
  return ease.map((e, k) => -e * slopes.reduce((sum, row, n) => sum + row[k] * x[n], 0));
}

/** Project coordinates, constants and rates onto their constraints; `held` is changed last. */
export function bind(held) {
  if (kernels.conditions) project(held);
  follow();
}

function project(held) {
  const keys = ["q", "parameters"].flatMap((kind) => state[kind].map((_, k) => `${kind}-${k}`));
  const count = state.q.length;
  for (let round = 0; round < 60; round += 1) {
    const excess = evaluated("conditions").flat();
    if (Math.max(...excess.map(Math.abs)) < 4e-16) break;
    const ease = keys.map((key) => (key === held && round < 20 ? 1e-6 : 1));
    const change = correction(evaluated("condition_slopes"), excess, ease);
    state.q = state.q.map((value, k) => value + change[k]);
    state.parameters = state.parameters.map((value, k) => value + change[count + k]);
  }
  if (page.second === "omega_body") return;
  const slopes = evaluated("condition_slopes").map((row) => row.slice(0, count));
  const bound = slopes.filter((row) => row.some((slope) => slope !== 0));
  if (!bound.length) return;
  const excess = bound.map((row) =>
    row.reduce((sum, slope, k) => sum + slope * state.q_dot[k], 0),
  );
  const ease = state.q_dot.map((_, k) => (held === `q_dot-${k}` ? 1e-6 : 1));
  const change = correction(bound, excess, ease);
  state.q_dot = state.q_dot.map((value, k) => value + change[k]);
}

/** Project everything onto the constraints; a constrained velocity keeps its length. */
export function settle() {
  const speed = Math.hypot(...state.q_dot);
  bind("");
  const now = Math.hypot(...state.q_dot);
  if (kernels.conditions && page.second === "q_dot" && now > 0) state.q_dot = state.q_dot.map((rate) => (rate * speed) / now);
}
