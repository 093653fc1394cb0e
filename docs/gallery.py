"""The gallery: rotations, solids, composites and motions, each with figure, formula and files.

    python docs/gallery.py [--no-pdf] [--jobs N]

writes the note (LaTeX, HTML, PDF), the live page and the kernels of each into `build/gallery`, and
its thumbnail and formula into `build/gallery_entries`, from which the documentation is built. An
entry that is missing there, or was made by other code, is derived when the documentation is built.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from functools import cache
from hashlib import sha256
from itertools import groupby, product
from math import cos, sin
from os import cpu_count
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import sympy as sp

import rigidsym as rs
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.solids import SHAPES, shaped
from rigidsym.notes.formats.pdf import has_tex, typeset
from rigidsym.pipeline import Output, output_of, read
from rigidsym.spec.derivation_file import read_spec
from rigidsym.spec.derivation_spec import DerivationSpec

ROOT = Path(__file__).parents[1]
BUILT = ROOT / "build" / "gallery"  # the documentation's own folder gallery/ is in it
ENTRIES = ROOT / "build" / "gallery_entries"
KERNELS = ("numpy", "c", "javascript")
CHAINS = ("z(phi) x(theta) z(psi) y(delta)", "[1,1,0](beta)", "z(phi) [1,2,2](theta) x(psi)")
FILES = (
    "lecture",
    "yaw_pitch_roll",
    "solid_cone",
    "composite_body",
    "free_symmetric_body",
    "heavy_symmetric_top",
    "heavy_asymmetric_body",
    "free_body",
    "dual_spin_satellite",
    "kovalevskaya_top",
    "quadcopter_attitude",
)
KEYS = {  # the formula of an entry, if it is not that of its kind
    "lecture": "rotational_energy",
    "yaw_pitch_roll": "rates_from_angular_velocity_body",
    "free_symmetric_body": "angular_momentum_rotation",
    "heavy_symmetric_top": "lagrangian",
    "heavy_asymmetric_body": "lagrangian",
    "free_body": "energy",
    "dual_spin_satellite": "energy",
    "kovalevskaya_top": "energy",
    "quadcopter_attitude": "mass_matrix",
}
_FORMULA = re.compile(r"<math.*?</math>", re.DOTALL)
_FIGURE = re.compile(r"<svg.*?</svg>", re.DOTALL)
_IDENTIFIER = re.compile(r"figure-\d+")
_SIZES = {"a": "1", "b": "2/3", "c": "1/2", "h": "3/2", "l": "2"}  # in the thumbnails


@dataclass(frozen=True)
class Item:
    """One entry: a rotation, a solid, or a derivation file, by its name."""

    name: str
    kind: str = "rotation"  # or "solid", "file"

    @property
    def key(self) -> str:
        usual = "angular_velocity_body" if self.kind == "rotation" else "inertia_tensor"
        return KEYS.get(self.name, usual)

    def spec(self) -> DerivationSpec:
        """What is derived and written; solids are turned by the angles of the lecture."""
        if self.kind == "solid":
            text = f'[body]\nshape = "{self.name}"\n'
            spec = read_spec(text, source=self.name, name=f"solid_{self.name}")
        else:
            spec = read(self.name)
        motion = spec.dynamics or {}
        is_shown = not motion.get("parts")  # by a page's figure
        note = ("tex", "html", "page") if is_shown else ("tex", "html")
        return replace(spec, kernels=KERNELS, note=note)

    def write(self, *, pdf: bool) -> str:
        """Write its files and its entry; its folder."""
        output = output_of(self.spec())
        folder = BUILT / "gallery" / output.name
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in output.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        if pdf:
            paper = typeset(output.files[f"{output.name}.tex"])
            (folder / f"{output.name}.pdf").write_bytes(paper.pdf)
        entry = ENTRIES / f"{self._slug}.html"
        entry.parent.mkdir(parents=True, exist_ok=True)
        entry.write_text(f"{state_of_the_code()}\n{self._made(output)}", encoding="utf-8")
        return output.name

    @property
    def _slug(self) -> str:
        return re.sub(r"\W+", "-", f"{self.kind}-{self.name}").strip("-")

    def entry(self, level: int = 2) -> str:
        """A heading, the figure, the formula and the files, in Markdown with HTML inside."""
        made = ENTRIES / f"{self._slug}.html"
        stamp, _, html = made.read_text("utf-8").partition("\n") if made.is_file() else ("", "", "")
        if stamp != state_of_the_code():
            spec = replace(self.spec(), kernels=(), note=("html",))
            if self.kind != "file":  # a file may abbreviate what several quantities share
                spec = replace(spec, quantities=(self.key,))
            html = self._made(output_of(spec))
        title, _, rest = html.partition("\n")
        name, _, body = rest.partition("\n")
        return "\n\n".join([f"{'#' * level} {escaped(title)}", body, _links(name)])

    def _made(self, output: Output) -> str:
        """Three lines: the title, the name, and the figure beside the formula."""
        note = output.files[f"{output.name}.html"]
        figure = wireframe(self.name) if self.kind == "solid" else _first(_FIGURE, note)
        figure = _IDENTIFIER.sub(f"figure-{output.name}", figure)
        _, _, after = note.partition(f'<div class="equation" id="{self.key}"')
        end = ' id="' if self.kind == "solid" else '<a class="number"'  # I₁ = ... come next
        formulas = _FORMULA.findall(after.partition(end)[0])
        formula = f'<div class="formula" tabindex="0">{"<br>".join(formulas)}</div>'
        title = output.motion.title if self.kind == "file" else self.name
        if self.kind == "solid":
            title = SHAPES[self.name].title
        body = f'<div class="entry">{figure}{formula}</div>'
        return f"{title}\n{output.name}\n{one_line(body)}"


def _links(name: str) -> str:
    folder = BUILT / "gallery" / name
    files = sorted(folder.iterdir()) if folder.is_dir() else []
    links = [f'<a href="gallery/{name}/{file.name}">{file.name}</a>' for file in files]
    return f"<p>{' '.join(links)}</p>" if links else ""


def _first(pattern: re.Pattern[str], text: str) -> str:
    found = pattern.search(text)
    return found[0] if found else ""


@cache
def state_of_the_code() -> str:
    """By which an entry knows the code that made it."""
    digest = sha256()
    folders = (ROOT / "rigidsym", ROOT / "templates", ROOT / "derivations")
    files = [file for folder in folders for file in folder.rglob("*") if file.is_file()]
    for file in sorted([Path(__file__), *files]):
        if "__pycache__" not in file.parts:
            digest.update(file.read_bytes())
    return digest.hexdigest()


def escaped(title: str) -> str:
    """A title without the marks of Markdown."""
    return re.sub(r"([*_[])", r"\\\1", title)


def one_line(html: str) -> str:
    """Without line ends, which would end a block of HTML in Markdown."""
    return html.replace("\n", " ")


# Solids


def wireframe(shape: str, steps: int = 24) -> str:
    """The outer surface of a shape as an SVG: lines along each coordinate on the faces."""
    sizes = [sp.Rational(_SIZES[name]) for name in SHAPES[shape].names]
    if shape.startswith("hollow"):
        sizes[0] /= 2
    solid = shaped(shape, sizes, mass=sp.Symbol("M"))
    place = sp.lambdify(solid.coordinates, list(solid.place), "math")
    bounds = enumerate(solid.bounds)
    ends = [sp.lambdify(solid.coordinates[:k], tuple(pair), "math") for k, pair in bounds]

    def point(fractions: tuple[float, ...]) -> tuple[float, float]:
        values: list[float] = []
        for fraction, end in zip(fractions, ends, strict=True):
            low, high = (float(value) for value in end(*values))
            values.append(low + fraction * (high - low))
        x, y, z = place(*values)
        across, depth = x * cos(0.6) - y * sin(0.6), x * sin(0.6) + y * cos(0.6)
        return across, -(z * cos(0.45) - depth * sin(0.45))

    closed = {k for k, (low, high) in enumerate(solid.bounds) if high - low == 2 * sp.pi}
    curves = [_bent([point(at) for at in line]) for line in _lines(len(ends), closed, steps)]
    points = [p for curve in curves for p in curve]
    low, high = (tuple(map(end, zip(*points, strict=True))) for end in (min, max))
    scale = 150 / max(high[0] - low[0], high[1] - low[1])
    middle = [(low[k] + high[k]) / 2 for k in (0, 1)]

    def at(p: tuple[float, float]) -> str:
        return ",".join(f"{80 + (p[k] - middle[k]) * scale:.0f}" for k in (0, 1))

    drawn = dict.fromkeys(" ".join(p for p, _ in groupby(map(at, curve))) for curve in curves)
    lines = "".join(f'<polyline class="thin" points="{line}"/>' for line in drawn if " " in line)
    return (
        f'<svg role="img" aria-label="{SHAPES[shape].title}" viewBox="0 0 160 160">'
        f'<g class="body">{lines}</g></svg>'
    )


def _bent(curve: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """A straight line by its ends only, a closed curve to its beginning."""
    (x0, y0), (x1, y1) = curve[0], curve[-1]
    off = max(abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) for x, y in curve)
    is_straight = off < 1e-9 and (x0, y0) != (x1, y1) and not _returns(curve)
    return [curve[0], curve[-1]] if is_straight else curve


def _returns(curve: list[tuple[float, float]]) -> bool:
    (x0, y0), (x1, y1) = curve[0], curve[-1]
    return any((x - x0) * (x - x1) + (y - y0) * (y - y1) > 1e-9 for x, y in curve)


def _lines(count: int, closed: set[int], steps: int) -> Iterator[list[tuple[float, ...]]]:
    """Lines along one coordinate, by fractions of the bounds, on the outer faces."""
    grid = [k / 4 for k in range(5)]
    for along in range(count):
        others = [k for k in range(count) if k != along]
        for fixed in product(grid, repeat=len(others)):
            faces = [f in (0, 1) for k, f in zip(others, fixed, strict=True) if k not in closed]
            if count == 3 and not any(faces):
                continue
            line = []
            for step in range(steps + 1):
                at = dict(zip(others, fixed, strict=True)) | {along: step / steps}
                line.append(tuple(at[k] for k in range(count)))
            yield line


# Pages


def sections() -> dict[str, dict[str, list[Item]]]:
    """What is on each page of the gallery, by headings."""
    return {
        "conventions": {
            "About turning axes": [Item(s) for s in rs.EULER_SEQUENCES if s.isupper()],
            "About fixed axes": [Item(s) for s in rs.EULER_SEQUENCES if s.islower()],
        },
        "parametrisations": {
            "Parametrisations": [Item(name) for name in PARAMETRISATIONS],
            "Angles of well-known texts": [Item(name) for name in PRESETS],
            "Turns about any axes": [Item(text) for text in CHAINS],
        },
        "solids": {"": [Item(name, "solid") for name in SHAPES if name != "tetrahedron"]},
        "motions": {"": [Item(name, "file") for name in FILES]},
    }


def _page(name: str) -> str:
    parts = []
    for title, items in sections()[name].items():
        parts += [f"## {title}"] if title else []
        parts += [item.entry(3 if title else 2) for item in items]
    return "\n\n".join(parts)


def conventions_gallery() -> str:
    return _page("conventions")


def parametrisations_gallery() -> str:
    return _page("parametrisations")


def solids_gallery() -> str:
    return _page("solids")


def motions_gallery() -> str:
    return _page("motions")


def everything() -> list[Item]:
    """Each entry, those that take longest first."""
    found = [item for page in sections().values() for items in page.values() for item in items]
    return sorted(found, key=lambda item: item.kind != "file")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-pdf", action="store_true", help="do not typeset; needs no TeX")
    parser.add_argument("--jobs", type=int, default=cpu_count(), help="processes, by default all")
    given = parser.parse_args()
    if not has_tex() and not given.no_pdf:
        parser.error("pdflatex not found; --no-pdf needs no TeX")
    begin, items = time.perf_counter(), everything()
    with ProcessPoolExecutor(given.jobs) as pool:
        work = [pool.submit(item.write, pdf=not given.no_pdf) for item in items]
        for done in as_completed(work):
            print(done.result(), flush=True)
    print(f"{len(items)} entries in {time.perf_counter() - begin:.0f} s, {given.jobs} processes")


if __name__ == "__main__":
    main()
