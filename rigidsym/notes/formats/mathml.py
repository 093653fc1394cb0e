"""LaTeX of the notes -> MathML, by math-core."""

from __future__ import annotations

import re
from functools import lru_cache
from html import escape

from math_core import LatexError, LatexToMathML

from rigidsym.errors import AlgebraError

_CONVERTER = LatexToMathML(fancy_error=False)
_CLASSES = {  # for the style sheet
    "<mo>′</mo>": '<mo class="prime">′</mo>',  # most fonts have it smaller than readers notice
    # a combining arrow stands beside its letter in some browsers
    '<mo stretchy="false">\u20d7</mo>': '<mo class="arrow" stretchy="false">→</mo>',
    # attributes of MathML Core, which not every validator knows
    ' scriptlevel="0"': "",
    '<mfrac displaystyle="true">': '<mfrac class="tall">',
    '<mfrac displaystyle="false">': '<mfrac class="flat">',
    '<mrow displaystyle="true">': '<mrow class="tall">',
    '<mrow displaystyle="false">': '<mrow class="flat">',
    # menclose is not in MathML Core: the style sheet draws the box
    '<menclose notation="box">': '<mrow class="boxed">',
    "</menclose>": "</mrow>",
}
# browsers centre a dot over the foot of a slanted letter
_DOTTED = re.compile(r'(<mover accent="true"><mi>[A-Za-zα-ωϕϵ]</mi><mo)(>[˙¨])')
_LARGE = re.compile(r"\\[bB]ig([lr])[()]")
_ROW_SPACE = re.compile(r"\\\\\[\d+pt\]")  # the style sheet sets the distance of rows


def mathml(latex: str, text: str, *, is_display: bool = False) -> str:
    """One formula as a MathML element, with `text` for readers that do not know MathML.

    Raises AlgebraError for a macro that has no MathML.
    """
    element = _converted(latex, is_display)
    return element.replace("<math", f'<math alttext="{escape(text)}"', 1)


def _with_whole_bases(latex: str) -> str:
    """A power of what stands in large brackets is raised above all of it, not above its bracket."""
    opened: list[int] = []
    braces: list[tuple[int, str]] = []
    for bracket in _LARGE.finditer(latex):
        if bracket[1] == "l":
            opened.append(bracket.start())
        elif opened:
            start, end = opened.pop(), bracket.end()
            if latex.startswith("^", end) and "&" not in latex[start:end]:  # on one line
                braces += [(start, "{"), (end, "}")]
    for place, brace in sorted(braces, reverse=True):
        latex = latex[:place] + brace + latex[place:]
    return latex


@lru_cache(maxsize=4096)
def _converted(latex: str, is_display: bool) -> str:
    try:
        element = _CONVERTER.convert_with_local_state(
            _ROW_SPACE.sub(r"\\\\", _with_whole_bases(latex)), displaystyle=is_display
        )
    except LatexError as error:
        raise AlgebraError(f"no MathML for {latex}: {error}") from error
    for plain, classed in _CLASSES.items():
        element = element.replace(plain, classed)
    return _DOTTED.sub(r'\1 class="dot"\2', element)
