"""The pens for a drawing: a tikzpicture for LaTeX, an inline SVG for HTML.

TikZ names the ends of axes and draws arcs as arcs; the style sheet of the page colours the SVG.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from math import degrees, hypot
from unicodedata import normalize

from rigidsym.formula.tree import Formula
from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.drawing import TYPE_SIZE, Drawing, Ellipse, Stroke
from rigidsym.notes.formats.escape import cleaned

_UNIT = 0.3865 / TYPE_SIZE  # cm: an em at 11 points
_STYLES = (
    "space/.style={black!80}, body/.style={blue!65!black, line width=1pt}, "
    "node/.style={red!70!black, line width=.8pt, dash pattern=on 6pt off 2pt on 1pt off 2pt}, "
    "vector/.style={red!70!black, line width=1pt}, "
    "turn/.style={teal!75!black, line width=.9pt}, guide/.style={black!45}, "
    "hidden/.style={densely dashed, opacity=.6}"
)


def tikz(drawing: Drawing) -> str:
    """The drawing in TikZ; it needs the library arrows.meta."""
    lines = (*drawing.strokes, *drawing.behind)
    names = {stroke.name for stroke in lines if stroke.name is not None}
    written = {x: (x.latex, x.text) for x in (*names, *(label.symbol for label in drawing.labels))}
    ends = {name: _end(written[name][1]) for name in names}
    options = f"scale={_UNIT:.3f}, >={{Latex[length=2mm]}}, line join=round, line cap=round"
    return "\n".join(
        [
            rf"\begin{{tikzpicture}}[{options}, {_STYLES}]",
            r"\coordinate (O) at (0,0);",
            *(
                rf"\coordinate {ends[x.name]} at {_point(x.points[-1])};"
                for x in lines
                if x.name is not None
            ),
            *_lines(drawing.behind, ends),
            *(
                rf"\filldraw[line width=.4pt, color={{rgb,255:red,{red};green,{green};"
                rf"blue,{blue}}}] {' -- '.join(map(_point, outline))} -- cycle;"
                for outline, (red, green, blue) in ((x.points, x.color) for x in drawing.facets)
            ),
            *(
                rf"\fill[turn, opacity=.1, {_plane(arc)}] (0,0) -- {_turned(arc)} -- cycle;"
                for arc in drawing.sectors
            ),
            *_lines(drawing.strokes, ends),
            *(
                rf"\node[{x.kind}, inner sep=0pt] at {_point(x.place)} "
                rf"{{${written[x.symbol][0]}$}};"
                for x in drawing.labels
            ),
            r"\end{tikzpicture}",
        ]
    )


def _end(names: str) -> str:
    """The end of an axis by the first of its names: (z') for z′ = z″, (N1) for N₁."""
    first = normalize("NFKD", names.split(" = ")[0]).replace("′", "'")
    return "(" + re.sub(r"[^A-Za-z0-9']", "", first) + ")"


def _lines(strokes: Iterable[Stroke], ends: Mapping[Formula, str]) -> Iterator[str]:
    for stroke in strokes:
        options = [*_kinds(stroke), *(["->"] if stroke.has_arrow else [])]
        if stroke.arc is not None:
            yield rf"\draw[{', '.join([*options, _plane(stroke.arc)])}] {_turned(stroke.arc)};"
        else:
            *line, end = map(_point, stroke.points)
            tip = end if stroke.name is None else ends[stroke.name]
            yield rf"\draw[{', '.join(options)}] {' -- '.join([*line, tip])};"


def _kinds(stroke: Stroke) -> list[str]:
    """The styles of a stroke, which TikZ and the style sheet of the page call alike."""
    thin, hidden = ("thin",) * stroke.is_thin, ("hidden",) * stroke.is_hidden
    return [stroke.kind, *thin, *hidden]


def _plane(arc: Ellipse) -> str:
    """The plane of an arc, seen obliquely: its centre and the radii at 0 and 90 degrees."""
    centre = _point(arc.centre)
    shift = "" if centre == "(O)" else f"shift={{{centre}}}, "
    u, v = (f"({_in_cm(x)}cm,{_in_cm(y)}cm)" for x, y in (arc.u, arc.v))
    return f"{shift}x={{{u}}}, y={{{v}}}"


def _turned(arc: Ellipse) -> str:
    start, end = (f"{degrees(angle):.1f}" for angle in (arc.start, arc.end))
    return f"({start}:1) arc ({start}:{end}:1)"


def _point(point: Point) -> str:
    x, y = map(_in_cm, point)
    return "(O)" if x == y == _in_cm(0.0) else f"({x},{y})"


def _in_cm(value: float) -> str:
    """Three digits after the point, and never -0.000."""
    return f"{round(value, 3) + 0.0:.3f}"


_SCALE = 18.0 / TYPE_SIZE  # pixels: an em of a label
_PAD = 6.0  # pixels around all
_AS_IN_FORMULAS = str.maketrans("φε", "ϕϵ")  # the forms of the letters that LaTeX has
_ARROW = 9.0  # pixels, the length of a head


def svg(drawing: Drawing, *, title: str, description: str, name: str) -> str:
    """The drawing as an SVG element; `name` makes its identifiers unique in a page."""
    (left, low), (right, high) = drawing.bounds
    x, y = left * _SCALE - _PAD, -high * _SCALE - _PAD
    width, height = (right - left) * _SCALE + 2 * _PAD, (high - low) * _SCALE + 2 * _PAD
    box = " ".join(map(_number, (x, y, width, height)))
    return "\n".join(
        [
            f'<svg viewBox="{box}" width="{_number(width)}" height="{_number(height)}" role="img" '
            f'aria-labelledby="{name}-title {name}-desc">',
            f'<title id="{name}-title">{escape(cleaned(title))}</title>',
            f'<desc id="{name}-desc">{escape(cleaned(description))}</desc>',
            *_elements(drawing),
            "</svg>",
        ]
    )


def _elements(drawing: Drawing) -> Iterator[str]:
    yield from _strokes(drawing.behind)
    for facet in drawing.facets:
        color = "#" + "".join(f"{part:02x}" for part in facet.color)
        yield f'<polygon fill="{color}" stroke="{color}" points="{_points(facet.points)}"/>'
    for arc in drawing.sectors:
        yield f'<polygon class="area turn" points="{_points((arc.centre, *arc.points))}"/>'
    yield from _strokes(drawing.strokes)
    for label in drawing.labels:
        x, y = label.place
        yield (
            f'<text class="{label.kind}" x="{_number(x * _SCALE)}" y="{_number(-y * _SCALE)}" '
            f'dy=".32em">{escape(as_in_formulas(label.symbol.text))}</text>'
        )


def _strokes(strokes: Iterable[Stroke]) -> Iterator[str]:
    for stroke in strokes:
        yield f'<polyline class="{" ".join(_kinds(stroke))}" points="{_points(stroke.points)}"/>'
        if stroke.has_arrow:
            yield f'<polygon class="head {stroke.kind}" points="{_points(_head(stroke))}"/>'


def _head(stroke: Stroke) -> tuple[Point, ...]:
    """A slim arrow head whose point is the end of the stroke."""
    (x0, y0), (x1, y1) = stroke.points[-2:]
    size = _ARROW / _SCALE / (hypot(x1 - x0, y1 - y0) or 1.0)
    dx, dy = size * (x1 - x0), size * (y1 - y0)
    foot = (x1 - dx, y1 - dy)
    return ((x1, y1), (foot[0] - dy / 3, foot[1] + dx / 3), (foot[0] + dy / 3, foot[1] - dx / 3))


def as_in_formulas(text: str) -> str:
    """A symbol as the text of a label."""
    return cleaned(text.translate(_AS_IN_FORMULAS))


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{_number(x * _SCALE)},{_number(-y * _SCALE)}" for x, y in points)


def _number(value: float) -> str:
    """One digit after the point, and never -0.0."""
    return f"{round(value, 1) + 0.0:.1f}"
