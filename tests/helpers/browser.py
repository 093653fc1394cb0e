"""Pages in headless Chromium: each in a frame of a given width, measured and looked at by axe."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path

CHROMIUM = (
    "chromium",
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--host-resolver-rules=MAP * ~NOTFOUND",
)
_TO_THE_END = ("--virtual-time-budget=1000000", "--enable-logging=stderr", "--dump-dom")
_CONSOLE = re.compile(r".*CONSOLE.*")
_POLICY = re.compile(r'<meta http-equiv="Content-Security-Policy"[^>]*>')  # axe is a script
_LOOK = """
async function look(page) {
  const frame = document.createElement("iframe");
  frame.style.cssText = `border: 0; width: ${page.widths[0]}px; height: 900px`;
  const loaded = new Promise((resolve) => (frame.onload = resolve));
  frame.srcdoc = page.html;
  document.body.append(frame);
  await loaded;
  const seen = [];
  for (const width of page.widths) {
    frame.style.width = `${width}px`;
    seen.push(await measured(frame.contentWindow, width, page.with_axe));
  }
  frame.remove();
  return seen;
}
async function measured(view, width, with_axe) {
  const root = view.document.documentElement;
  const shown = [...root.querySelectorAll(".formula, .scroll")].filter((box) => box.offsetParent);
  const wide = shown.filter((box) => box.scrollWidth > box.clientWidth + 1);
  return {
    width,
    page_width: root.scrollWidth,
    formulas: shown.length,
    wide: wide.map((box) => box.textContent.slice(0, 80)),
    faults: with_axe ? await faults(view) : [],
  };
}
async function faults(view) {
  const script = view.document.createElement("script");
  script.textContent = axe_source;
  view.document.head.append(script);
  const found = await view.axe.run();
  return found.violations.map(
    (fault) => `${fault.id}: ${fault.help}: ${fault.nodes.map((n) => n.html).join(" ")}`);
}
(async () => {
  const seen = [];
  for (const page of pages) seen.push(...(await look(page)));
  const result = document.createElement("pre");
  result.id = "result";
  result.textContent = JSON.stringify(seen);
  document.body.replaceChildren(result);
})();
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Seen:
    """What Chromium made of one page at one width."""

    width: int
    page_width: int  # more than `width` where the page has to be scrolled sideways
    formulas: int
    wide: tuple[str, ...]  # what has to be scrolled inside its box
    faults: tuple[str, ...]  # what axe found


def look_at(
    pages: Sequence[tuple[str, int]], folder: Path, *, with_axe: bool = False
) -> list[Seen]:
    """Each page, given as HTML, in a frame of its width in pixels. Fails on a console message."""
    data = json.dumps(
        [
            {
                "html": _POLICY.sub("", html),
                "widths": [width for _, width in same],  # loaded once for all of them
                "with_axe": with_axe,
            }
            for html, same in groupby(pages, lambda page: page[0])
        ]
    ).replace("</", "<\\/")
    axe = json.dumps(axe_source()).replace("</", "<\\/")
    harness = folder / "look.html"
    harness.write_text(
        f'<!DOCTYPE html><meta charset="utf-8"><body><script>const pages = {data};'
        f"const axe_source = {axe};{_LOOK}</script>",
        encoding="utf-8",
    )
    dom, log = _dump(harness, folder)
    assert not _CONSOLE.findall(log), log
    match = re.search(r'<pre id="result">(.*?)</pre>', dom, re.DOTALL)
    assert match, log
    seen = json.loads(
        match.group(1).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
    )
    return [Seen(**one | {k: tuple(one[k]) for k in ("wide", "faults")}) for one in seen]


def open_page(html: str, folder: Path) -> tuple[str, str]:
    """(DOM after loading, log) of a page with all its own policy."""
    page = folder / "page.html"
    page.write_text(html, encoding="utf-8")
    return _dump(page, folder)


def _dump(page: Path, folder: Path) -> tuple[str, str]:
    done = subprocess.run(
        [*CHROMIUM, *_TO_THE_END, f"--user-data-dir={folder / 'profile'}", page.as_uri()],
        capture_output=True,
        text=True,
        check=True,
        timeout=300,
    )
    return done.stdout, done.stderr


def axe_source() -> str:
    """The source of axe-core, which a package for Playwright carries; nothing of it is imported."""
    spec = find_spec("axe_core_python")
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).with_name("axe.min.js").read_text(encoding="utf-8")
