// The flow of time: states at multiples of a step, at constant rates or by the equations of motion.

import { kernels } from "./generated.mjs";
import { evaluated, settle, state } from "./state.mjs";

const LAPSE = 0.02; // seconds between the states that are kept
const SLICES = 5; // of a step of the equations of motion
export const LAST = 30; // seconds
let path = [];

/** Start from the state as it is, at t = 0. */
export function begin() {
  path = [{ q: [...state.q], q_dot: [...state.q_dot] }];
}

/** y at `time` + `seconds`, by the classical Runge-Kutta method. */
function integrated(y, time, seconds) {
  const slope = (values, passed) =>
    kernels.state_derivative(time + passed, values, state.parameters);
  const along = (values, change, by) => values.map((value, k) => value + by * change[k]);
  const k1 = slope(y, 0);
  const k2 = slope(along(y, k1, seconds / 2), seconds / 2);
  const k3 = slope(along(y, k2, seconds / 2), seconds / 2);
  const k4 = slope(along(y, k3, seconds), seconds);
  return y.map((value, k) => value + (seconds / 6) * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]));
}

function after(start, time, seconds) {
  if (!kernels.state_derivative) {
    state.q = start.q.map((value, k) => value + seconds * start.q_dot[k]);
    state.q_dot = [...start.q_dot];
    settle();
    return { q: state.q, q_dot: state.q_dot };
  }
  let y = [...start.q, ...start.q_dot];
  const slice = seconds / SLICES;
  for (let part = 0; part < SLICES; part += 1) y = integrated(y, time + part * slice, slice);
  return { q: y.slice(0, start.q.length), q_dot: y.slice(start.q.length) };
}

/** Put the state at a time, in seconds; false where the motion cannot be continued. */
export function goTo(time) {
  const whole = Math.floor(time / LAPSE + 1e-9);
  while (path.length <= whole) path.push(after(path.at(-1), (path.length - 1) * LAPSE, LAPSE));
  const { q, q_dot } = after(path[whole], whole * LAPSE, Math.max(0, time - whole * LAPSE));
  state.t = time;
  state.q = [...q];
  state.q_dot = [...q_dot];
  return [...q, ...q_dot].every(Number.isFinite);
}

/** The quantities that are constant along the motion, now. */
export const integrals = () => (kernels.first_integrals ? evaluated("first_integrals") : []);
