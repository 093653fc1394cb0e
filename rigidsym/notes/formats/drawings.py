"""The pens for a drawing: a tikzpicture for LaTeX, an inline SVG for HTML.

Both draw the same lines and areas in the same order; the style sheet of the page colours the SVG.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from html import escape
from math import hypot

from rigidsym.formula.tree import Formula
from rigidsym.notes.figure.drawing import TYPE_SIZE, Color, Drawing, Label, Stroke
from rigidsym.notes.figure.scene import Point
from rigidsym.notes.formats.escape import cleaned
from rigidsym.system.resources import environment

_UNIT = 0.3865 / TYPE_SIZE  # cm: an em at 11 points


def _shapes(
    drawing: Drawing,
    line: Callable[[Stroke], str],
    area: Callable[[Iterable[Point], Color | None], str],
    label: Callable[[Label], str],
) -> list[str]:
    """All of a drawing from the back to the front; a sector has no color of its own."""
    return [
        *(line(x) if isinstance(x, Stroke) else area(x.points, x.color) for x in drawing.body),
        *(area((x.centre, *x.points), None) for x in drawing.strokes if x.centre is not None),
        *map(line, drawing.strokes),
        *map(label, drawing.labels),
    ]


def _styles(stroke: Stroke) -> list[str]:
    """The styles of a stroke, which TikZ and the style sheet of the page call alike."""
    return [stroke.kind, *("thin",) * stroke.is_thin, *("hidden",) * stroke.is_hidden]


def tikz(drawing: Drawing) -> str:
    """The drawing in TikZ; it needs the library arrows.meta."""

    def path(points: Iterable[Point]) -> str:
        return " -- ".join(f"({_rounded(x, 3)},{_rounded(y, 3)})" for x, y in points)

    def line(stroke: Stroke) -> str:
        options = [*_styles(stroke), *["->"] * stroke.has_arrow]
        return rf"\draw[{', '.join(options)}] {path(stroke.points)};"

    def area(points: Iterable[Point], color: Color | None) -> str:
        if color is None:
            return rf"\fill[turn, opacity=.1] {path(points)} -- cycle;"
        red, green, blue = color
        rgb = f"{{rgb,255:red,{red};green,{green};blue,{blue}}}"
        return rf"\filldraw[line width=.4pt, color={rgb}] {path(points)} -- cycle;"

    def label(x: Label) -> str:
        return rf"\node[{x.kind}, inner sep=0pt] at {path([x.place])} {{${x.symbol.latex}$}};"

    shapes = "\n".join(_shapes(drawing, line, area, label))
    template = environment().get_template("drawing.tex.jinja")
    return template.render(scale=f"{_UNIT:.3f}", shapes=shapes)


_SCALE = 18.0 / TYPE_SIZE  # pixels: an em of a label
_PAD = 6.0  # pixels around all
# the forms of the letters that LaTeX has, without arrows, which browsers do not place reliably
_AS_IN_FORMULAS = str.maketrans("φε", "ϕϵ", "\u20d7")
_ARROW = 9.0  # pixels, the length of a head


def svg(drawing: Drawing, *, title: str, description: str, name: str) -> str:
    """The drawing as an SVG element; `name` makes its identifiers unique in a page."""

    def path(points: Iterable[Point]) -> str:
        return " ".join(f"{_rounded(x * _SCALE)},{_rounded(-y * _SCALE)}" for x, y in points)

    def line(stroke: Stroke) -> str:
        kinds = " ".join(_styles(stroke))
        whole = f'<polyline class="{kinds}" points="{path(stroke.points)}"/>'
        if not stroke.has_arrow:
            return whole
        (x0, y0), (x1, y1) = stroke.points[-2:]
        # The head is a triangle along the last piece of the line, two thirds as wide as it is long.
        size = _ARROW / _SCALE / (hypot(x1 - x0, y1 - y0) or 1.0)
        dx, dy = size * (x1 - x0), size * (y1 - y0)
        x, y = x1 - dx, y1 - dy  # the foot of a slim head
        head = ((x1, y1), (x - dy / 3, y + dx / 3), (x + dy / 3, y - dx / 3))
        return f'{whole}\n<polygon class="head {stroke.kind}" points="{path(head)}"/>'

    def area(points: Iterable[Point], color: Color | None) -> str:
        kind = 'class="area turn"'
        if color is not None:
            rgb = "#" + "".join(f"{part:02x}" for part in color)
            kind = f'fill="{rgb}" stroke="{rgb}"'
        return f'<polygon {kind} points="{path(points)}"/>'

    def label(x: Label) -> str:
        left, top = path([x.place]).split(",")
        text = escape(in_a_figure(x.symbol))
        return f'<text class="{x.kind}" x="{left}" y="{top}" dy=".32em">{text}</text>'

    (left, low), (right, high) = drawing.bounds
    width, height = (right - left) * _SCALE + 2 * _PAD, (high - low) * _SCALE + 2 * _PAD
    corner = (left * _SCALE - _PAD, -high * _SCALE - _PAD)
    box = " ".join(map(_rounded, (*corner, width, height)))
    return "\n".join(
        [
            f'<svg viewBox="{box}" width="{_rounded(width)}" height="{_rounded(height)}" '
            f'role="img" aria-labelledby="{name}-title {name}-desc">',
            f'<title id="{name}-title">{escape(cleaned(title))}</title>',
            f'<desc id="{name}-desc">{escape(cleaned(description))}</desc>',
            *_shapes(drawing, line, area, label),
            "</svg>",
        ]
    )


def in_a_figure(symbol: Formula) -> str:
    """A symbol as the text of a label."""
    return cleaned(symbol.text.translate(_AS_IN_FORMULAS))


def _rounded(value: float, digits: int = 1) -> str:
    """So many digits after the point, and never -0.0."""
    return f"{round(value, digits) + 0.0:.{digits}f}"
