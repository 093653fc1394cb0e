"""The pen for LaTeX: a drawing as a tikzpicture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rigidsym.notes.figure.camera import Point
from rigidsym.notes.figure.drawing import TYPE_SIZE, Area, Drawing, Label, Stroke

_EM = 0.3865  # cm, at 11 points
_STYLES = (
    "space/.style={black!80}, body/.style={blue!65!black, line width=1pt}, "
    "node/.style={red!70!black, line width=.8pt, dash pattern=on 6pt off 2pt on 1pt off 2pt}, "
    "vector/.style={red!70!black, line width=1pt}, "
    "turn/.style={teal!75!black, line width=.9pt}, guide/.style={black!45}"
)


def tikz(drawing: Drawing) -> str:
    """The drawing in TikZ; it needs the library arrows.meta."""
    lines = [*_areas(drawing.areas), *_strokes(drawing.strokes), *_labels(drawing.labels)]
    scale = f"{_EM / TYPE_SIZE:.3f}"
    options = f"scale={scale}, >={{Latex[length=2mm]}}, line join=round, line cap=round, {_STYLES}"
    return "\n".join([rf"\begin{{tikzpicture}}[{options}]", *lines, r"\end{tikzpicture}"])


def _areas(areas: Iterable[Area]) -> Iterator[str]:
    for area in areas:
        yield rf"\fill[{area.kind}, opacity=.1] {_path(area.points)} -- cycle;"


def _strokes(strokes: Iterable[Stroke]) -> Iterator[str]:
    for stroke in strokes:
        options: list[str] = [stroke.kind]
        options += ["line width=.4pt"] if stroke.is_thin else []
        options += ["densely dashed", "opacity=.6"] if stroke.is_hidden else []
        options += ["->"] if stroke.has_arrow else []
        yield rf"\draw[{', '.join(options)}] {_path(stroke.points)};"


def _labels(labels: Iterable[Label]) -> Iterator[str]:
    for label in labels:
        at, symbol = _point(label.place), f"${label.symbol.latex}$"
        yield rf"\node[{label.kind}, inner sep=0pt] at {at} {{{symbol}}};"


def _path(points: Iterable[Point]) -> str:
    return " -- ".join(map(_point, points))


def _point(point: Point) -> str:
    return f"({_number(point[0])},{_number(point[1])})"


def _number(value: float) -> str:
    """Three digits after the point, and no minus before nothing."""
    return f"{round(value, 3) + 0.0:.3f}"
