r"""Formulas in LaTeX, translated into Python.

python_of(r"\dot\phi \sin^2\theta")     phi_dot*sin(theta)**(2)

Names become words in quotes, and each bracket, from the inside out, a letter of the private use
area. A formula without brackets is then read from right to left, so that a function finds its
argument, and a base its power.
"""

from __future__ import annotations

import re

from rigidsym.errors import ExpressionError
from rigidsym.text.bounds import FUNCTIONS
from rigidsym.text.names import GREEK_LETTERS, spelled
from rigidsym.tools.compare.language import function_word
from rigidsym.tools.compare.syntax import patterns

_FIRST, _MARKS = 0xE000, "\ue000-\uf8ff"
_TOKEN = re.compile(r'\\[A-Za-z]+|"\w+"|\d+(?:\.\d+)?|\S')
_LETTER = re.compile(rf'\\[A-Za-z]+|"\w+"|[A-Za-z{GREEK_LETTERS}]')
_WORD = r'"(\w+)"'
_SCRIPT = rf"\s*_\s*(?:\{{([^{{}}]*)\}}|{_WORD}|(\d))"
_SIGNS = {"+": "+", "-": "-", r"\cdot": "*", "*": "*", "/": "/"}
_NAMES = {letter: letter for letter in map(spelled, GREEK_LETTERS)}
_NAMES |= {"varphi": "phi", "vartheta": "theta", "top": "T", "intercal": "T"}


def python_of(text: str) -> str:
    """The last side of an equation; if a side contains a matrix, the last such side."""
    if mark := re.search(f"[{_MARKS}]", text):
        raise ExpressionError(f"unexpected {mark[0]!r} in LaTeX")
    parts: list[str] = []  # which letters stand for

    def matrix(match: re.Match[str]) -> str:
        lines = [line for line in re.split(r"\\\\(?:\[[^\]]*\])?", match[2]) if line.strip()]
        cells = (", ".join(_sum(cell, parts) for cell in line.split("&")) for line in lines)
        return _kept(f"[{', '.join(f'[{row}]' for row in cells)}]", parts)

    text = patterns.styled_script.sub("", patterns.tex_comment.sub("", text))
    sides = patterns.tex_matrix.sub(matrix, text).split("=")
    side = next((s for s in reversed(sides) if re.search(f"[{_MARKS}]", s)), sides[-1])
    side = patterns.end_of_side.split(side)[0] if parts else side
    side = _sum(patterns.punctuation.sub("", side), parts)
    for number in reversed(range(len(parts))):  # a part consists of earlier ones
        side = side.replace(chr(_FIRST + number), parts[number])
    return side


def _kept(part: str, parts: list[str]) -> str:
    parts.append(part)
    return chr(_FIRST + len(parts) - 1)


def _styled(match: re.Match[str]) -> str:
    r"""\mathrm{cos} is a function, \mathbf{x} a letter, \mathrm{yaw} one name."""
    word = match[1] or ""
    if function_word(word) in FUNCTIONS:
        return f"\\{word} "
    return f'"{word}"' if len(word) > 1 and word[0] != "\\" else f"{word} "


def _named(match: re.Match[str]) -> str:
    word = match[0].strip('\\"')
    is_command = match[0][0] == "\\" and word not in _NAMES
    return match[0] if is_command else f'"{spelled(_NAMES.get(word, word))}"'


def _scripted(match: re.Match[str]) -> str:
    """A name with its index; the dots of a derivative come last."""
    stem, dots = re.fullmatch(r"(.*?)((?:_d?dot)?)", match[1]).groups()  # type: ignore[union-attr]
    index = re.sub(r'[\s"]', "", match[2] or match[3] or match[4] or "")
    if not index.isalnum():
        raise ExpressionError(f"unexpected index {index!r} in LaTeX")
    return f'"{stem}_{index}{dots}"'


def _sum(text: str, parts: list[str]) -> str:
    """An entry of a matrix, or a formula in which letters stand for matrices."""
    text = patterns.layout.sub(" ", patterns.styled.sub(_styled, text))
    if word := re.search(rf"{_WORD}\s*[(\[]", text):
        raise ExpressionError(f"{word[1]} is not a function that is known")
    text = _LETTER.sub(_named, text)
    text = re.sub(_WORD + _SCRIPT, _scripted, text)
    text = re.sub(rf"\\(d?dot)\s*(\{{)?\s*{_WORD}\s*(?(2)\}})", r'"\3_\1"', text)
    text = re.sub(_WORD + _SCRIPT, _scripted, text)
    text = patterns.tex_short_turn.sub(  # c\theta
        lambda m: _kept(f"{'cos' if m[1] in 'cC' else 'sin'}({m[2]})", parts), text
    )
    while match := re.search(r"\(([^][(){}]*)\)|\[([^][(){}]*)\]|\{([^][(){}]*)\}", text):
        inner = _product(match[match.lastindex or 0], parts)
        text = text[: match.start()] + _kept(f"({inner})", parts) + text[match.end() :]
    return _product(text, parts)


def _product(text: str, parts: list[str]) -> str:
    """A formula without brackets."""
    stack: list[str] = []  # factors and signs, the first at the end
    power = ""

    def taken(*, is_digit: bool = False) -> str:
        r"""The next factor, or the first digit of several: \frac12."""
        factor = stack.pop() if stack else "end"
        if factor == "end" or factor in _SIGNS:
            raise ExpressionError(f"unexpected {factor!r} in LaTeX")
        if is_digit and factor.isdigit() and len(factor) > 1:
            stack.append(factor[1:])
            return factor[0]
        return factor

    tokens = ["", *_TOKEN.findall(text)]
    for place in range(len(tokens) - 1, 0, -1):
        before, token = tokens[place - 1 : place + 1]
        function = function_word(token[1:]) if token[0] == "\\" else ""
        if token == "^":
            power = taken(is_digit=True)
            power = parts[ord(power) - _FIRST] if re.fullmatch(f"[{_MARKS}]", power) else power
            continue
        if token in _SIGNS:
            factor = token
        elif token in (r"\frac", r"\tfrac", r"\dfrac"):
            factor = f"({taken(is_digit=True)}/{taken(is_digit=True)})"
        elif function in FUNCTIONS:
            # sin⁻¹ is the inverse function, although sin² is a power
            if power == "(-1)" and tokens[place + 1] == "^":
                function, power = f"a{function}", ""
            argument = taken(is_digit=function == "sqrt")
            # \sin 2\theta
            if argument.isdigit() and function != "sqrt" and stack and stack[-1] not in _SIGNS:
                argument += f"*{taken()}"
            factor = f"{function}({argument})"
        elif re.fullmatch(rf'"\w+"|[\d.]+|[{_MARKS}]', token):
            factor = "λ" if token == '"lambda"' else token.strip('"')  # a keyword of Python
        else:
            raise ExpressionError(f"unexpected {token!r} in LaTeX")
        # \sin(a)^2 is the square of the sine
        is_argument = token[-1] >= chr(_FIRST) and function_word(before[1:]) in FUNCTIONS
        if power and not is_argument:
            factor = f"({factor}).T" if power.strip("()") == "T" else f"{factor}**({power})"
            power = ""
        stack.append(factor)
    if not stack or stack[0] in _SIGNS:
        raise ExpressionError("unexpected 'end' in LaTeX")
    product = ""
    for factor in stack[::-1]:
        is_second = product and product[-1] not in "+-*/" and factor not in _SIGNS
        product += "*" * bool(is_second) + _SIGNS.get(factor, factor)
    return product
