"""The pen for LaTeX: a drawing as a tikzpicture with named coordinates, and arcs as arcs."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from math import degrees
from unicodedata import normalize

from rigidsym.formula.tree import Formula
from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.drawing import TYPE_SIZE, Drawing, Ellipse, Facet, Stroke

_EM = 0.3865  # cm, at 11 points
_UNIT = _EM / TYPE_SIZE
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
            *_coordinates(lines, ends),
            *_strokes(drawing.behind, ends),
            *_facets(drawing.facets),
            *_sectors(drawing.sectors),
            *_strokes(drawing.strokes, ends),
            *(
                rf"\node[{x.kind}, inner sep=0pt] at {_point(x.place)} "
                rf"{{${written[x.symbol][0]}$}};"
                for x in drawing.labels
            ),
            r"\end{tikzpicture}",
        ]
    )


def _coordinates(strokes: Iterable[Stroke], ends: Mapping[Formula, str]) -> Iterator[str]:
    yield r"\coordinate (O) at (0,0);"
    for stroke in strokes:
        if stroke.name is not None:
            yield rf"\coordinate {ends[stroke.name]} at {_point(stroke.points[-1])};"


def _end(names: str) -> str:
    """The end of an axis by the first of its names: (z') for z′ = z″, (N1) for N₁."""
    first = normalize("NFKD", names.split(" = ")[0]).replace("′", "'")
    return "(" + re.sub(r"[^A-Za-z0-9']", "", first) + ")"


def _sectors(arcs: Iterable[Ellipse]) -> Iterator[str]:
    for arc in arcs:
        yield rf"\fill[turn, opacity=.1, {_plane(arc)}] (0,0) -- {_turned(arc)} -- cycle;"


def _facets(facets: Iterable[Facet]) -> Iterator[str]:
    for facet in facets:
        red, green, blue = facet.color
        color = f"{{rgb,255:red,{red};green,{green};blue,{blue}}}"
        outline = " -- ".join(map(_point, facet.points))
        yield rf"\filldraw[line width=.4pt, color={color}] {outline} -- cycle;"


def _strokes(strokes: Iterable[Stroke], ends: Mapping[Formula, str]) -> Iterator[str]:
    for stroke in strokes:
        options: list[str] = [stroke.kind]
        options += ["thin"] if stroke.is_thin else []
        options += ["hidden"] if stroke.is_hidden else []
        options += ["->"] if stroke.has_arrow else []
        if stroke.arc is not None:
            yield rf"\draw[{', '.join([*options, _plane(stroke.arc)])}] {_turned(stroke.arc)};"
        else:
            *line, end = map(_point, stroke.points)
            tip = end if stroke.name is None else ends[stroke.name]
            yield rf"\draw[{', '.join(options)}] {' -- '.join([*line, tip])};"


def _plane(arc: Ellipse) -> str:
    """The plane of an arc, seen obliquely: its centre and the radii at 0 and 90 degrees."""
    centre = _point(arc.centre)
    shift = "" if centre == "(O)" else f"shift={{{centre}}}, "
    u, v = (f"({_number(x)}cm,{_number(y)}cm)" for x, y in (arc.u, arc.v))
    return f"{shift}x={{{u}}}, y={{{v}}}"


def _turned(arc: Ellipse) -> str:
    start, end = (f"{degrees(angle):.1f}" for angle in (arc.start, arc.end))
    return f"({start}:1) arc ({start}:{end}:1)"


def _point(point: Point) -> str:
    x, y = map(_number, point)
    return "(O)" if x == y == _number(0.0) else f"({x},{y})"


def _number(value: float) -> str:
    """Three digits after the point, and never -0.000."""
    return f"{round(value, 3) + 0.0:.3f}"
