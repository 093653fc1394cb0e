"""Facts about generated files for their templates, and how paragraphs of text are set."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from math import ceil
from textwrap import wrap

from rigidsym.algebra.stable_forms import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.ir import (
    Call,
    Choice,
    Expression,
    Kernel,
    Negative,
    Product,
    Program,
    Sum,
    walk,
)
from rigidsym.kernels.lowering.rounding import SINE, adds_angles, rounding
from rigidsym.kernels.targets.infix import broken
from rigidsym.system import resources
from rigidsym.version import OWNERSHIP, __version__

_BLANK_LINES = re.compile(r"\n\s*\n")
_COUNTED = {"sin": "trigonometric", "cos": "trigonometric", "sqrt": "roots", "abs": "sizes"}
_COUNTED["atan2"] = "inverse"

Paragraph = str | Sequence[str]  # filled, or lines that are kept


def paragraphs(template: str, **facts: object) -> list[Paragraph]:
    """What a template says; lines that begin with a blank or @ are kept, others are filled."""
    text = resources.environment().get_template(template).render(**facts)
    blocks = (block.strip("\n") for block in _BLANK_LINES.split(text) if block.strip())
    return [b.split("\n") if b[0] in " @" else b.replace("\n", " ") for b in blocks]


def about_module(template: str, program: Program, **facts: object) -> list[Paragraph]:
    """The paragraphs at the head of a file."""
    kernels = [kernel.original or kernel for kernel in program.kernels]
    each = map(series_of, range(FIRST_SERIES, program.last + 1))
    return paragraphs(
        template,
        program=program,
        adds_angles=any(map(adds_angles, kernels)),
        has_bounds=any(map(rounding, kernels)),
        sine=f"{SINE:g}",
        series=[(series, ceil(series.error)) for series in each],
        version=__version__,
        ownership=OWNERSHIP,
        **facts,
    )


@lru_cache(maxsize=256)
def about_kernel(template: str, kernel: Kernel, **facts: object) -> list[Paragraph]:
    """The paragraphs on a function, the same for all that differ in names alone."""
    kernel = kernel.original or kernel
    return paragraphs(
        template,
        kernel=kernel,
        operations=count(kernel.values),
        bound=rounding(kernel),
        in_units=in_units,
        **facts,
    )


def series(program: Program, form: str, width: int, *, more: int = 0) -> str:
    """The table of series: k, and the switch, c_{k-2}(0) and the coefficients of c_k."""
    lines = []
    for order in range(FIRST_SERIES, program.last + more + 1):
        each = series_of(order)
        numbers = map(float, (each.switch, taylor(order - 2)[0], *each.coefficients))
        lines.append(form.format(order, ", ".join(map(repr, numbers))))
    return "\n".join(broken(line, width, " " * 8) for line in lines)


def in_units(units: Sequence[str]) -> str:
    """The unit of components behind their names: " in rad"; a dash if none is declared."""
    if not any(units):
        return ""
    same = len(set(units)) == 1
    return f" in {units[0] if same else '(' + ', '.join(unit or '-' for unit in units) + ')'}"


def table(rows: Sequence[tuple[str, str, str]]) -> str:
    """Rows with their first two columns aligned."""
    first, second = (max((len(row[k]) for row in rows), default=0) for k in (0, 1))
    return "\n".join(f"  {a:<{first}}  {b:<{second}}  {c}".rstrip() for a, b, c in rows)


def filled(paragraph: Paragraph, width: int) -> list[str]:
    """The lines of a paragraph."""
    return list(_wrapped(paragraph, width) if isinstance(paragraph, str) else paragraph)


@lru_cache(maxsize=1024)  # modules of one kind have most paragraphs in common
def _wrapped(paragraph: str, width: int) -> list[str]:
    return wrap(paragraph, width, break_long_words=False, break_on_hyphens=False)


def comment(texts: Sequence[Paragraph], width: int, safe: Callable[[str], str]) -> str:
    """Lines of a comment; `safe` sees to it that no text can end it."""
    blocks = (filled(paragraph, width - len(" * ")) for paragraph in texts)
    text = safe("\n\n".join("\n".join(block) for block in blocks))
    return "\n".join(f" * {line}".rstrip() for line in text.split("\n"))


def count(expressions: Iterable[Expression]) -> Counter[str]:
    """The operations in expressions as they are written; subtractions count as additions."""
    counts: Counter[str] = Counter()
    for node in (node for expression in expressions for node in walk(expression)):
        match node:
            case Choice():
                counts["choices"] += 1
            case Call("eps"):
                pass  # a constant of the type
            case Call(function):
                counts[_COUNTED.get(function, "entire")] += 1
            case Product(factors, divisors):
                counts["multiplications"] += len(factors) - 1 + max(len(divisors) - 1, 0)
                counts["divisions"] += bool(divisors)
            case Sum(terms):
                counts["additions"] += len(terms) - 1
                # A negative term after the first is a subtraction, which its sum has counted.
                counts["negations"] -= sum(isinstance(term, Negative) for term in terms[1:])
            case Negative():
                counts["negations"] += 1
    return counts
