// The flow of time: states at multiples of a step, at constant rates or by the equations of motion.

import { kernels, page } from "./generated.mjs";
import { evaluated, follow, settle, state } from "./state.mjs";

const LAPSE = 0.02; // seconds between the states that are kept
const [FEWEST_STEPS, MOST_STEPS] = [4, 4096]; // steps of the equations of motion in a lapse
const TOLERANCE = 1e-8; // relative change of the state, if the steps of a lapse are halved
export const LAST = page.last; // seconds
let path = [];

const now = () => [...state.q, ...state[page.second]];

/** Start from the state as it is, at t = 0. */
export function begin() {
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
export function goTo(time) {
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

/** The quantities that are constant along the motion, now. */
export const integrals = () => (kernels.first_integrals ? evaluated("first_integrals") : []);
