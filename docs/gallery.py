"""The gallery: every rotation and solid, with its figure, its formula and its files.

    python docs/gallery.py [--pdf] [--out FOLDER]

writes the note, the live page and the kernels of each; the documentation links to them if they are
there. Figures and formulas of the pages are derived when the documentation is built.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))


import rigidsym as rs
from rigidsym.models.library import PARAMETRISATIONS, PRESETS
from rigidsym.models.solids import SHAPES

BUILT = Path(__file__).parents[1] / "build" / "gallery" / "gallery"
CHAINS = ("z(phi) x(theta) z(psi) y(delta)", "[1,1,0](beta)", "z(phi) [1,2,2](theta) x(psi)")
_FORMULA = re.compile(r"<math.*?</math>", re.DOTALL)
_FIGURE = re.compile(r"<svg.*?</svg>", re.DOTALL)
_IDENTIFIER = re.compile(r"figure-\d+")


@dataclass(frozen=True)
class Item:
    """One entry: a rotation, or a solid turned by the angles of the lecture."""

    rotation: str
    solid: str = ""

    @property
    def title(self) -> str:
        return self.solid.replace("_", " ").capitalize() if self.solid else self.rotation

    @property
    def key(self) -> str:
        return "inertia_tensor" if self.solid else "angular_velocity_body"

    def derive(self) -> rs.Motion:
        if not self.solid:
            return rs.derive(self.rotation)
        return rs.derive(self.rotation, body=rs.solid(self.solid))

    def entry(self, level: int = 3) -> str:
        """A heading, the figure and the formula, in Markdown with HTML inside."""
        motion = self.derive()
        note = motion.note().html()
        figures = [] if self.solid else _FIGURE.findall(note)[:1]
        name = re.sub(r"\W+", "-", f"{self.rotation}-{self.solid}").strip("-")
        figure = _IDENTIFIER.sub(f"figure-{name}", one_line("".join(figures)))
        _, _, after = note.partition(f'<div class="equation" id="{self.key}"')
        formulas = _FORMULA.findall(after.partition('<a class="number"')[0])
        formula = one_line("<br>".join(formulas))
        formula = f'<div class="formula" tabindex="0">{formula}</div>'
        return "\n\n".join(
            [
                f"{'#' * level} {escaped(self.title)}",
                f'<div class="entry">{figure}{formula}</div>',
                self._links(self.folder(motion)),
            ]
        )

    def folder(self, motion: rs.Motion) -> str:
        return f"{motion.name}_{self.solid}" if self.solid else motion.name

    def _links(self, name: str) -> str:
        files = sorted((BUILT / name).iterdir()) if (BUILT / name).is_dir() else []
        links = [f'<a href="gallery/{name}/{f.name}">{f.name}</a>' for f in files]
        return f"<p>{' '.join(links)}</p>" if links else ""

    def write(self, out: Path, *, pdf: bool) -> str:
        from rigidsym.notes.formats.pdf import typeset

        motion = self.derive()
        folder = out / self.folder(motion)
        folder.mkdir(parents=True, exist_ok=True)
        note = motion.note()
        (folder / f"{motion.name}.html").write_text(note.html(), encoding="utf-8")
        if not self.solid:
            (folder / f"{motion.name}_page.html").write_text(motion.page(), encoding="utf-8")
        for target in ("numpy", "c", "javascript"):
            for name, text in motion.kernels(target).files.items():
                (folder / name).write_text(text, encoding="utf-8")
        if pdf:
            (folder / f"{motion.name}.pdf").write_bytes(typeset(note.latex()).pdf)
        return self.folder(motion)


def escaped(title: str) -> str:
    """A title without the marks of Markdown."""
    return re.sub(r"([*_[])", r"\\\1", title)


def one_line(html: str) -> str:
    """Without line ends, which would end a block of HTML in Markdown."""
    return html.replace("\n", " ")


def sections() -> dict[str, list[Item]]:
    return {
        "About turning axes": [Item(s) for s in rs.EULER_SEQUENCES if s.isupper()],
        "About fixed axes": [Item(s) for s in rs.EULER_SEQUENCES if s.islower()],
        "Other parametrisations": [Item(name) for name in PARAMETRISATIONS],
        "Angles of well-known texts": [Item(name) for name in PRESETS],
        "Turns about any axes": [Item(text) for text in CHAINS],
    }


def solids() -> list[Item]:
    return [Item("ZXZ", name) for name in SHAPES if name != "tetrahedron"]


@cache
def rotation_gallery() -> str:
    parts = [
        f"## {title}\n\n" + "\n\n".join(item.entry() for item in items)
        for title, items in sections().items()
    ]
    return "\n\n".join(parts)


@cache
def solid_gallery() -> str:
    return "\n\n".join(item.entry(level=2) for item in solids())


def everything() -> Iterator[Item]:
    for items in sections().values():
        yield from items
    yield from solids()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pdf", action="store_true", help="typeset each note too; needs TeX")
    parser.add_argument("--out", type=Path, default=BUILT)
    given = parser.parse_args()
    with ProcessPoolExecutor() as pool:
        work = [pool.submit(item.write, given.out, pdf=given.pdf) for item in everything()]
        for done in work:
            print(done.result(), flush=True)


if __name__ == "__main__":
    main()
