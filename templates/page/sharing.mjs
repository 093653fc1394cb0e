// Copying equations and the link, saving the figure, and the whole screen for it.

import { page } from "./generated.mjs";
import { at } from "./main.mjs";
import { said } from "./state.mjs";

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const field = document.createElement("textarea"); // without access to the clipboard
    field.value = text;
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done;
  }
}

/** Copy, and say so: on the button and aloud. */
async function copyFrom(button, text, name) {
  const done = await copy(text);
  at("said").textContent = done ? `${said("Copied:")} ${name}` : said("It could not be copied.");
  button.classList.toggle("done", done);
  setTimeout(() => button.classList.remove("done"), 1500);
  button.focus();
}

/** A button that copies one equation in one language. */
function buttonFor(place, language) {
  const name = place.dataset.of;
  const button = document.createElement("button");
  button.type = "button";
  button.dataset.copy = language;
  button.textContent = page.languages[language];
  button.setAttribute("aria-label", `${said("Copy equation")} (${place.textContent}): ${button.textContent}`);
  button.addEventListener("click", () => copyFrom(button, page.copies[name][language], button.textContent));
  return button;
}

for (const place of document.querySelectorAll(".copy")) {
  const known = Object.keys(page.copies[place.dataset.of]);
  place.replaceChildren(`${said("Copy")} `, ...known.map((language) => buttonFor(place, language)));
}

at("link").addEventListener("click", () => copyFrom(at("link"), location.href, said("Link")));

// --- saving the figure

const KEPT = ["fill", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin", "stroke-linecap",
  "opacity", "paint-order", "font-family", "font-size", "font-style", "font-weight", "text-anchor"];

/** The figure as the text of a file, with its style written into each element. */
function svgText() {
  const figure = at("figure");
  const whole = figure.cloneNode(true);
  const styled = [...figure.querySelectorAll("g *")];
  whole.querySelectorAll("g *").forEach((element, k) => {
    const style = getComputedStyle(styled[k]);
    element.setAttribute("style", KEPT.map((name) => `${name}: ${style.getPropertyValue(name)}`).join("; "));
    element.removeAttribute("class");
  });
  const [x, y, width, height] = figure.getAttribute("viewBox").split(" ");
  const paper = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  const area = { x, y, width, height, fill: getComputedStyle(document.body).backgroundColor };
  for (const [key, value] of Object.entries(area)) paper.setAttribute(key, value);
  whole.querySelector("g").prepend(paper);
  whole.setAttribute("width", width);
  whole.setAttribute("height", height);
  return new XMLSerializer().serializeToString(whole);
}

function save(blob, ending) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = `${page.name}.${ending}`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const svgBlob = () => new Blob([svgText()], { type: "image/svg+xml" });

at("save-svg").addEventListener("click", () => save(svgBlob(), "svg"));
at("save-png").addEventListener("click", () => {
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [3 * image.width, 3 * image.height];
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    URL.revokeObjectURL(image.src);
    canvas.toBlob((blob) => save(blob, "png"));
  };
  image.src = URL.createObjectURL(svgBlob());
});

// --- the whole screen

at("full").hidden = !document.fullscreenEnabled;
at("full").addEventListener("click", () => {
  if (document.fullscreenElement) document.exitFullscreen();
  else at("board").requestFullscreen();
});
document.addEventListener("fullscreenchange", () => {
  at("full").textContent = document.fullscreenElement ? said("Leave full screen") : said("Full screen");
});
