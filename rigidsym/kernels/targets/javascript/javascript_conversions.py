"""Conversions in JavaScript: formulas of one orientation, and trajectories sample by sample."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from string import Template
from textwrap import wrap

from rigidsym.kernels.conversions.conversions import ConversionProgram, Formula
from rigidsym.kernels.conversions.formulas import MATRIX, Line
from rigidsym.kernels.conversions.unwrap import ChainUnwrapping, Unwrapping
from rigidsym.kernels.targets.javascript.function import (
    WIDTH,
    Function,
    Paragraph,
    Vector,
    comment,
    placed,
    taken_from,
)
from rigidsym.system import resources

_HELPERS = "kernels_javascript_conversions.jinja"
_UNWRAP = "kernels_javascript_unwrap_{}.jinja"
_SPELLING = {name: name for name in ("sqrt", "atan2", "hypot", "sin", "cos")} | {
    "pick": "_pick",
    "wrapped": "_wrapped",
    "tiny": "_TINY",
    "reach": "_REACH",
    "nan": "NaN",
    "pi": "Math.PI",
}
_OF_MATH = re.compile(r"\$(sqrt|atan2|hypot|sin|cos)|\b(abs)\(")
_SAID = {
    "p": "w, x, y, z",
    "matrix": "rows of R, or its entries row by row",
}


def function(formula: Formula, known: Mapping[str, tuple[str, ...]]) -> Function:
    """The pieces of one conversion; `known` are the components of the derivation's arguments."""
    vectors = tuple(
        Vector(
            name=name,
            given=name,
            components=components or known[name],
            about=_SAID.get(name, ", ".join(components or known[name])),
            entries="_flat(matrix)" if name == "matrix" else "",
            default=f"new Array({len(components)}).fill(0)" if name == "kept" else "",
        )
        for name, components in formula.components.items()
    )
    places = tuple(f"{vector.name}_at" for vector in vectors)
    return Function(
        name=formula.name,
        about=comment(_about(formula, vectors)),
        vectors=vectors,
        places=places,
        body="\n".join(_body(formula, vectors, places)),
        returned="values",
        count=len(formula.outputs),
    )


def imports(program: ConversionProgram) -> frozenset[str]:
    """What the conversions need of `Math`."""
    return frozenset(
        found for text in _texts(program) for pair in _OF_MATH.findall(text) for found in pair
    ) - {""}


def helpers(program: ConversionProgram) -> str:
    """What serves all conversions, and `unwrap`."""
    environment = resources.environment()
    text = environment.get_template(_HELPERS).render() if program.formulas else ""
    return text + (_unwrap(program.unwrapping) if program.unwrapping else "")


def _texts(program: ConversionProgram) -> Iterator[str]:
    for formula in program.formulas:
        yield from (value for _, value in formula.lines)
        yield from formula.outputs
    if program.unwrapping and program.unwrapping.chain:
        yield from (value for _, value in program.unwrapping.chain.lines)


def _about(formula: Formula, vectors: Sequence[Vector]) -> list[Paragraph]:
    unit = f" in {formula.unit}" if formula.unit else ""
    return [
        formula.about,
        *formula.remarks,
        [
            *(f"@param {{number[]}} {v.name} {v.about}" for v in vectors),
            f"@returns {{number[]}} ({len(formula.outputs)}){unit}",
        ],
    ]


def _body(formula: Formula, vectors: Sequence[Vector], places: Sequence[str]) -> Iterator[str]:
    changed = Counter(name for names, _ in formula.lines for name in names.split(", "))
    known: set[str] = set()
    if not formula.inputs:
        given = ", ".join(f"{v.name}, {p}" for v, p in zip(vectors, places, strict=True))
        word = "let" if any(changed[name] for name in MATRIX) else "const"
        yield f"  {word} [{', '.join(MATRIX)}] = _rotation_matrix([], 0, {given});"
        known.update(MATRIX)
        vectors = places = ()
    for vector, place in zip(vectors, places, strict=True):
        for name, line in taken_from(vector, place):
            yield line.replace("const ", "let ") if changed[name] else line
            known.add(name)
    yield from _lines(formula.lines, changed, known)
    for k, output in enumerate(formula.outputs):
        yield _fitted(f"  out[{placed('at', k)}] = {_spelled(output)};")


def _lines(lines: Sequence[Line], changed: Counter[str], known: set[str]) -> Iterator[str]:
    """Assignments; what is assigned once is constant."""
    for names, value in lines:
        each = names.split(", ")
        word = "let " if any(changed[name] > 1 for name in each) else "const "
        word = "" if known.issuperset(each) else word
        known.update(each)
        if len(each) > 1:
            yield f"  {word}[{names}] = [{_spelled(value)}];"
        else:
            yield _fitted(f"  {word}{names} = {_spelled(value)};")


def _fitted(line: str) -> str:
    return "\n".join(
        wrap(
            line,
            WIDTH,
            subsequent_indent="    ",
            drop_whitespace=True,
            break_long_words=False,
            break_on_hyphens=False,
        )
    )


def _spelled(text: str) -> str:
    text = Template(text).substitute(_SPELLING)
    return text.replace(" == ", " === ").replace(") & (", ") && (")


def _unwrap(unwrapping: Unwrapping) -> str:
    template = resources.environment().get_template(_UNWRAP.format(unwrapping.kind))
    chain = _chain(unwrapping.chain) if unwrapping.chain else {}
    text: str = template.render(
        about=comment(_about_unwrap(unwrapping)), **unwrapping.numbers, **chain
    )
    return text


def _about_unwrap(unwrapping: Unwrapping) -> list[Paragraph]:
    constants = unwrapping.chain.constants if unwrapping.chain else ()
    return [
        "The coordinates along a trajectory, continuous from sample to sample.",
        *unwrapping.remarks,
        "The first sample stays as it is. A sample with NaN is passed over.",
        [
            "@param {Float64Array} q the samples, a row after the other, in a flat array",
            *(f"@param {{number[]}} parameters {', '.join(c)}" for c in [constants] if c),
            "@returns {Float64Array} as q",
        ],
    ]


def _chain(chain: ChainUnwrapping) -> dict[str, object]:
    """The pieces of `unwrap` for turns about any axes."""
    lines = [(name, f"parameters[{place}]") for name, place in chain.used]
    lines += chain.lines
    changed = Counter(name for name, _ in lines)
    return {
        "signature": "q, parameters" if chain.constants else "q",
        "constants": len(chain.constants),
        "size": chain.size,
        "known": "\n".join(_lines(lines, changed, set())),
        "samples": [*_taken(chain.samples, chain.angles)],
        "kept": [*_taken(chain.samples, (value for _, value in chain.placed))],
        "angles": [_spelled(angle) for angle in chain.angles],
        "turns": [(turn, k) for k, turn in enumerate(chain.turns) if turn != "_"],
        "placed": chain.placed,
        "is_triangle": chain.is_triangle,
    }


def _taken(samples: Sequence[tuple[str, int]], texts: Iterable[str]) -> Iterator[str]:
    """The coordinates that stand in some texts, from the array that holds them."""
    words = set(re.findall(r"\w+", " ".join(texts)))
    return (f"const {name} = sample[{place}];" for name, place in samples if name in words)
