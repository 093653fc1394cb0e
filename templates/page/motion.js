// The motion: a state in radians and SI units, bound where it has to be, and its flow in time.

const state = { q: [], q_dot: [], omega_body: [], parameters: [...page.parameters], t: 0 };
for (const { kind, place, start, factor } of page.controls) state[kind][place] = start * factor;

/** The vectors that functions take: those of the state, and y, which is q and the rates or Ω′. */
const inputOf = (input) => (input === "y" ? [...state.q, ...state[page.second]] : state[input]);
const evaluated = (name) => kernels[name](...page.inputs[name].map(inputOf));

/** In Euler's form the rates follow from Ω′. */
function follow() {
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
function bind(held) {
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
function settle() {
  const speed = Math.hypot(...state.q_dot);
  bind("");
  const now = Math.hypot(...state.q_dot);
  if (kernels.conditions && page.second === "q_dot" && now > 0) state.q_dot = state.q_dot.map((rate) => (rate * speed) / now);
}

// --- states at multiples of a step, at constant rates or by the equations of motion

const LAPSE = 0.02; // seconds between the states that are kept
const [FEWEST_STEPS, MOST_STEPS] = [4, 4096]; // steps of the equations of motion in a lapse
const TOLERANCE = 1e-8; // relative change of the state, if the steps of a lapse are halved
const LAST = page.last; // seconds
let path = [];

const now = () => [...state.q, ...state[page.second]];

/** Start from the state as it is, at t = 0. */
function begin() {
  path = [now()];
}

/** y at `time` + `seconds`, by `count` steps of the classical Runge-Kutta method. */
function integrated(start, time, seconds, count) {
  const h = seconds / count;
  const along = (values, change, by) => values.map((value, k) => value + by * change[k]);
  let y = start;
  for (let step = 0; step < count; step += 1) {
    const slope = (values, passed) =>
      kernels.state_derivative(time + step * h + passed, values, state.parameters);
    const k1 = slope(y, 0);
    const k2 = slope(along(y, k1, h / 2), h / 2);
    const k3 = slope(along(y, k2, h / 2), h / 2);
    const k4 = slope(along(y, k3, h), h);
    y = y.map((value, k) => value + (h / 6) * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]));
  }
  return y;
}

/** y after a lapse, in steps so short that half of them give the same; NaN if none are. */
function after(start, time, seconds) {
  if (!start.every(Number.isFinite)) return start;
  if (!kernels.state_derivative) {
    const count = state.q.length;
    state.q = start.slice(0, count).map((value, k) => value + seconds * start[count + k]);
    state.q_dot = start.slice(count);
    settle();
    return now();
  }
  let coarse = integrated(start, time, seconds, FEWEST_STEPS);
  for (let count = 2 * FEWEST_STEPS; count <= MOST_STEPS; count *= 2) {
    const fine = integrated(start, time, seconds, count);
    const apart = fine.map((value, k) => Math.abs(value - coarse[k]) / (1 + Math.abs(value)));
    if (Math.max(...apart) < TOLERANCE) return fine;
    coarse = fine;
  }
  return start.map(() => NaN);
}

/** Put the state at a time, in seconds; false where the motion cannot be continued. */
function goTo(time) {
  const whole = Math.floor(time / LAPSE + 1e-9);
  while (path.length <= whole) path.push(after(path.at(-1), (path.length - 1) * LAPSE, LAPSE));
  const y = after(path[whole], whole * LAPSE, Math.max(0, time - whole * LAPSE));
  if (!y.every(Number.isFinite)) return false;
  state.t = time;
  state.q = y.slice(0, state.q.length);
  state[page.second] = y.slice(state.q.length);
  follow();
  return true;
}
