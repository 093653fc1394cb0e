// The page: sliders, numbers, the figure, and the address that holds their state.

const { controls, scene } = page;
const at = (id) => document.getElementById(id);
const group = at("figure").querySelector("g");
const count = scene.turns.length;
const MOST_TRACE = 1500; // points
const view = { shown: new Set(), done: count, trace: [], time: 0 };
let busy = null; // the field that is being typed in
let warned = ""; // what the warning says

// --- numbers

const fixed = (value, digits) => {
  const text = Number.isFinite(value) ? value.toFixed(digits).replace("-", "−") : "–";
  return /[1-9]/.test(text) ? text : text.replace("−", "");
};
const rounded = (value, step) =>
  Number.isFinite(value) ? String(Number(value.toFixed(step < 1 ? 3 : 1))) : "";

function showControls() {
  for (const { kind, place, factor, step } of controls) {
    const key = `${kind}-${place}`;
    at(key).dataset.value = String(state[kind][place]);
    for (const field of [at(key), at(`${key}-number`)]) {
      const text = rounded(state[kind][place] / factor, step);
      if (field !== busy && field.value !== text) field.value = text;
    }
  }
}

/** The values of a function in its table, in the unit that is shown. */
function showNumbers(name, factor) {
  const values = [evaluated(name)].flat(2);
  at(`${name}-value`).querySelectorAll("data").forEach((cell, k) => {
    cell.value = String(values[k]);
    cell.textContent = fixed(values[k] / factor, factor === 1 ? 4 : 2);
  });
}

/** Show the distance from gimbal lock; returns whether it is small. */
function showMargin() {
  if (!kernels.singularity_margin) return false;
  const margin = evaluated("singularity_margin");
  at("margin").value = Math.min(margin, 1);
  at("margin-number").value = String(margin);
  at("margin-number").textContent = fixed(margin, 4);
  const isNear = margin < 0.1;
  document.body.classList.toggle("near-a-pole", isNear);
  const words = isNear ? at("pole").innerHTML : "";
  if (words !== warned) at("warning").innerHTML = words; // else it would be read out again
  warned = words;
  return isNear;
}

// --- the figure

/** The turns as the product has them, or the single turn that R is. */
function turnsOf(rows, stage, q, body) {
  if (rows) {
    return rows.map(([x, y, z, angle, rate]) => ({
      axis: scaled(1 / length([x, y, z]), [x, y, z]), angle, rate,
    }));
  }
  const vector = stage.vector.length ? stage.vector.map((place) => q[place]) : null;
  const whole = wholeTurn(body, vector, q[stage.angle]);
  return whole ? [{ ...whole, rate: 0 }] : [];
}

function leaveTrace(pose, turns) {
  const axis = kernels.turns && turns.length ? turns.at(-1).axis : STANDARD[2];
  const tip = within(axis, pose.frames.at(-1));
  const last = view.trace.at(-1);
  const step = last ? length(minus(tip, last)) : 1;
  if (step < 0.01) return;
  if (step > 0.3) view.trace = []; // a jump is not a motion
  view.trace.push(tip);
  if (view.trace.length > MOST_TRACE) view.trace.shift();
}

function show() {
  const matrix = evaluated("rotation_matrix");
  const omega = evaluated("angular_velocity_space");
  showControls();
  for (const [name, factor] of Object.entries(page.values)) showNumbers(name, factor);
  const isLocked = showMargin();
  const columns = [0, 1, 2].map((k) => matrix.map((row) => row[k]));
  const axes = page.passive ? matrix : columns; // of the body
  if (!axes.flat().every(Number.isFinite)) return; // the last figure stays
  const turns = turnsOf(kernels.turns && evaluated("turns"), scene, state.q, axes);
  const pose = posed(scene, turns, view.done);
  const isWhole = view.done >= count;
  if (view.shown.has("trace") && isWhole) leaveTrace(pose, turns);
  const camera = cameraAt(at("azimuth").valueAsNumber, at("elevation").valueAsNumber, scene.up);
  const options = {
    shown: view.shown,
    body: view.shown.has("body") ? page.body ?? cuboidOf(page.moments ?? evaluated("moments").flat()) : null,
    omega: isWhole ? omega : null,
    omegaName: scene.omega,
    trace: view.shown.has("trace") ? view.trace : [],
    done: view.done,
    letters: scene.letters,
    isLocked,
  };
  draw(group, pose, camera, options);
}

/** Read the numbers aloud once they have come to rest, and keep them in the address. */
let resting = 0;
function rest() {
  clearTimeout(resting);
  resting = setTimeout(() => {
    const factor = page.values.angular_velocity_body;
    const omega = evaluated("angular_velocity_body").map((part) => fixed(part / factor, 2));
    at("said").textContent = `angular velocity, body components: ${omega.join(", ")} ${factor === 1 ? "rad/s" : "degrees per second"}`;
    remember();
  }, 700);
}

// --- the state in the address

const inputsOf = (kind) => controls.filter((control) => control.kind === kind);

function remember() {
  const words = new URLSearchParams();
  for (const kind of Object.keys(state).filter((kind) => state[kind].length)) {
    const shown = inputsOf(kind).map(({ place, factor }) => Number((state[kind][place] / factor).toPrecision(7)));
    words.set(kind, shown.join(" "));
  }
  words.set("view", [at("azimuth").value, at("elevation").value].join(" "));
  words.set("show", [...view.shown].join(" "));
  if (view.done < count) words.set("turns", String(view.done));
  history.replaceState(null, "", `#${words}`);
}

/** Take over the state that an address holds; what is not a number is left as it is. */
function recall() {
  const words = new URLSearchParams(location.hash.slice(1));
  const numbers = (name) => (words.get(name) ?? "").split(" ").map((word) => (word === "" ? NaN : Number(word)));
  for (const kind of Object.keys(state)) {
    const given = numbers(kind);
    inputsOf(kind).forEach(({ place, factor }, k) => {
      if (Number.isFinite(given[k])) state[kind][place] = given[k] * factor;
    });
  }
  const [azimuth, elevation] = numbers("view");
  if (Number.isFinite(azimuth)) at("azimuth").value = azimuth;
  if (Number.isFinite(elevation)) at("elevation").value = elevation;
  if (words.has("show")) setShown(words.get("show").split(" "));
  const [done] = numbers("turns");
  setDone(Number.isFinite(done) ? done : count);
}

// --- controls

/** The state is where a motion starts. */
function restart() {
  view.time = 0;
  view.trace = [];
  showTime();
  begin();
}

function showTime() {
  at("time").value = view.time;
  at("clock").textContent = `${fixed(view.time, 2)} s`;
}

function set({ kind, place, factor }, value) {
  if (!Number.isFinite(value)) return;
  state[kind][place] = value * factor;
  bind(`${kind}-${place}`);
  restart();
  show();
  rest();
}

for (const control of controls) {
  const key = `${control.kind}-${control.place}`;
  for (const field of [at(key), at(`${key}-number`)]) {
    field.addEventListener("input", () => {
      busy = field;
      set(control, field.valueAsNumber);
    });
    field.addEventListener("change", () => {
      busy = null;
      showControls();
    });
  }
}

const boxes = [...document.querySelectorAll("[data-show]")];
const shownAtFirst = boxes.filter((box) => box.defaultChecked).map((box) => box.dataset.show);

function setShown(names) {
  for (const box of boxes) box.checked = names.includes(box.dataset.show);
  view.shown = new Set(boxes.filter((box) => box.checked).map((box) => box.dataset.show));
  if (!view.shown.has("trace")) view.trace = [];
}

/** Show only the first turns; a fraction is part of a turn. */
function setDone(done) {
  view.done = Math.min(count, Math.max(0, done));
  if (at("turns")) at("turns").value = view.done;
  const whole = view.done < count ? Math.floor(view.done) : count;
  [...at("turn-words").children].forEach((words, k) => (words.hidden = k !== whole));
}

function change(act) {
  return (event) => {
    act(event);
    show();
    rest();
  };
}

for (const box of boxes) {
  box.addEventListener("change", change(() => setShown(boxes.filter((b) => b.checked).map((b) => b.dataset.show))));
}
for (const id of ["azimuth", "elevation"]) at(id).addEventListener("input", change(() => {}));
at("turns")?.addEventListener("input", change(() => {
  stepping = null;
  setDone(at("turns").valueAsNumber);
}));

at("figure").addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  const turn = (id, by) => {
    const [value, low, high] = [at(id).valueAsNumber, Number(at(id).min), Number(at(id).max)];
    const full = id === "azimuth" ? ((value + by - low + 360) % 360) + low : value + by;
    at(id).value = Math.min(high, Math.max(low, full));
  };
  turn("azimuth", -event.movementX / 2);
  turn("elevation", event.movementY / 2);
  show();
  rest();
});

// --- playing: the coordinates change at their rates; or the turns are made one by one

const calm = matchMedia("(prefers-reduced-motion: reduce)");
let last = null; // the time of the last frame in milliseconds; null if nothing moves
let stepping = null; // how many turns are shown, while they are made one by one

/** Go to a time; false if it is the last, or a coordinate has come to its end. */
function reach(time) {
  view.time = Math.max(0, Math.min(LAST, time));
  const goes = goTo(view.time);
  at("stopped").textContent = goes ? "" : "The motion cannot be computed further: the coordinates are at a pole.";
  const ends = inputsOf("q");
  state.q = state.q.map((value, k) => {
    const { period, factor } = ends[k];
    return period ? value - period * factor * Math.round(value / (period * factor)) : value;
  });
  showTime();
  const isIn = ({ place, period, factor, high }) => period || Math.abs(state.q[place] / factor) <= high;
  return goes && view.time < LAST && ends.every(isIn);
}

const advance = (seconds) => reach(view.time + seconds);

function frame(time) {
  if (last === null) return;
  const seconds = Math.min(0.05, (time - last) / 1000);
  last = time;
  let goes = true;
  if (stepping === null) goes = advance(seconds * Number(at("speed").value));
  else {
    stepping += seconds * 0.8;
    // rest for a moment after each turn
    const whole = Math.floor(stepping);
    setDone(whole + Math.min(1, 1.4 * (stepping - whole)));
    goes = stepping < count;
  }
  show();
  if (goes) requestAnimationFrame(frame);
  else pause();
}

function pause() {
  last = null;
  stepping = null;
  at("play").textContent = calm.matches ? "Step" : "Play";
  rest();
}

function start() {
  last = performance.now();
  at("play").textContent = "Pause";
  requestAnimationFrame(frame);
}

at("time").addEventListener("input", change(() => {
  pause();
  setDone(count);
  if (at("time").valueAsNumber < view.time) view.trace = [];
  reach(at("time").valueAsNumber);
}));

at("play").addEventListener("click", () => {
  const wasPlaying = last !== null;
  if (view.time >= LAST) restart();
  if (wasPlaying) pause();
  setDone(count);
  if (calm.matches) change(() => advance(0.1 * Number(at("speed").value)))();
  else if (!wasPlaying) start();
});
at("one-by-one")?.addEventListener("click", () => {
  pause();
  if (calm.matches) change(() => setDone(view.done >= count ? 0 : Math.floor(view.done) + 1))();
  else {
    stepping = 0;
    setDone(0);
    start();
  }
});
calm.addEventListener("change", pause);
document.addEventListener("visibilitychange", () => document.hidden && last !== null && pause());

at("reset").addEventListener("click", () => {
  pause();
  for (const { kind, place, start: value, factor } of controls) state[kind][place] = value * factor;
  at("azimuth").value = scene.azimuth;
  at("elevation").value = scene.elevation;
  at("speed").value = "1";
  setShown(shownAtFirst);
  setDone(count);
  settle();
  restart();
  show();
});

setShown(shownAtFirst);
recall();
pause();
clearTimeout(resting);
settle();
restart();
show();
addEventListener("hashchange", () => {
  recall();
  settle();
  restart();
  show();
});
document.documentElement.classList.add("scripted");
