"""The pen for HTML: a drawing as an inline SVG, coloured by the style sheet of the page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape
from math import hypot

from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.drawing import TYPE_SIZE, Drawing, Stroke
from rigidsym.notes.sanitize import cleaned

_EM = 18.0  # pixels
_SCALE = _EM / TYPE_SIZE
_PAD = 6.0  # pixels around all
_AS_IN_FORMULAS = str.maketrans("φε", "ϕϵ")  # the forms of the letters that LaTeX has
_ARROW = 9.0  # pixels, the length of a head
_STYLE = """
svg { color: #1c1d21; background: #fff; }
polyline { fill: none; stroke: currentColor; stroke-width: 1.8; stroke-linejoin: round; }
.thin { stroke-width: 1; } .hidden { stroke-dasharray: 4 4; opacity: .6; }
.area { fill: currentColor; opacity: .12; } .head, text { fill: currentColor; }
text { font: italic 18px Georgia, serif; text-anchor: middle; }
.body { color: #1d4fb4; } .node, .vector { color: #b3261e; } .turn { color: #0b7268; }
polyline.node { stroke-dasharray: 9 3 2 3; } .guide { color: #5a5d66; }
"""


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


def alone(element: str) -> str:
    """The element as a picture of its own, with the colours of a light page."""
    namespace = '<svg xmlns="http://www.w3.org/2000/svg" '
    return element.replace("<svg ", namespace, 1).replace("\n", f"\n<style>{_STYLE}</style>\n", 1)


def _elements(drawing: Drawing) -> Iterator[str]:
    yield from _strokes(drawing.behind)
    for facet in drawing.facets:
        color = "#" + "".join(f"{part:02x}" for part in facet.color)
        yield f'<polygon fill="{color}" stroke="{color}" points="{_points(facet.points)}"/>'
    for arc in drawing.sectors:
        yield f'<polygon class="area turn" points="{_points((arc.centre, *arc.points))}"/>'
    yield from _strokes(drawing.strokes)
    symbols = [label.symbol.text for label in drawing.labels]
    for label, symbol in zip(drawing.labels, symbols, strict=True):
        x, y = label.place
        yield (
            f'<text class="{label.kind}" x="{_number(x * _SCALE)}" y="{_number(-y * _SCALE)}" '
            f'dy=".32em">{escape(as_in_formulas(symbol))}</text>'
        )


def _strokes(strokes: Iterable[Stroke]) -> Iterator[str]:
    for stroke in strokes:
        names = [
            stroke.kind,
            *(["thin"] if stroke.is_thin else []),
            *(["hidden"] if stroke.is_hidden else []),
        ]
        yield f'<polyline class="{" ".join(names)}" points="{_points(stroke.points)}"/>'
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
