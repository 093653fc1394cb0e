"""The formulas in sentences about conversions, by their plain text."""

from __future__ import annotations

from collections.abc import Iterable

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula

_FORMULAS = (
    r"\mathbf{e}",
    r"\beta",
    r"\cos\frac{\beta}{2} + \mathbf{e}\sin\frac{\beta}{2}",
    r"\mathbf{C}",
    r"\mathbf{R}\,\mathbf{C}",
    r"\beta'",
    r"\kappa",
    r"\sigma",
    r"\delta",
    r"\cos\frac{\beta'}{2}\cos\sigma",
    r"\cos\frac{\beta'}{2}\sin\sigma",
    r"\sin\frac{\beta'}{2}\cos\delta",
    r"\sin\frac{\beta'}{2}\sin\delta",
    r"\tan\frac{\beta'}{2}",
    r"\sigma = \operatorname{atan2}(a_1, a_0)",
    r"\delta = \operatorname{atan2}(a_3, a_2)",
    "(a_0, a_1)",
    "(a_2, a_3)",
    r"\mathbf{e}_1",
    r"\mathbf{e}_2",
    r"\mathbf{e}_3",
    r"\mathbf{e}_3 = \mathbf{e}_1",
    r"\mathbf{p}_+",
    r"\mathbf{p}_-",
    r"\mathbf{m}_+",
    r"\mathbf{m}_-",
    r"\mathbf{m}_+ = \mathbf{p}_+",
    r"\mathbf{m}_- = \mathbf{p}_-",
    r"\mathbf{p}_+ = (\mathbf{p} - \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2",
    r"\mathbf{p}_- = (\mathbf{p} + \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2",
    r"\mathbf{m} = 1",
    r"\mathbf{m} = \cos\frac{\beta}{2} + \mathbf{e}_2\sin\frac{\beta}{2}",
    r"\cos\frac{\beta}{2}",
    r"\sin\frac{\beta}{2}",
    r"2\operatorname{atan2}(\mathbf{p}_+\cdot\mathbf{e}_1, \mathbf{p}_+\cdot 1)",
    r"\chi = 2\operatorname{atan2}(|\mathbf{p}_-|, |\mathbf{p}_+|)",
    r"\operatorname{atan2}(B, A)",
    r"A = \mathbf{e}_1\cdot\mathbf{e}_3 - k_1 k_3",
    r"B = \mathbf{e}_1\cdot(\mathbf{e}_2\times\mathbf{e}_3)",
    r"k_1 = \mathbf{e}_1\cdot\mathbf{e}_2",
    r"k_3 = \mathbf{e}_2\cdot\mathbf{e}_3",
    r"\theta_1",
    r"\theta_3",
    "k_1",
    "k_3",
    r"\varphi",
    r"\cos\frac{\varphi}{2} + \mathbf{e}\sin\frac{\varphi}{2}",
    r"\sin\frac{\varphi}{2}",
    "n",
    r"n = |\mathbf{v}|",
    r"\mathbf{v}",
    r"\mathbf{v}/n",
    r"\cos\frac{n}{2} + \frac{\mathbf{v}}{n}\sin\frac{n}{2}",
    r"\cos\frac{n}{2}",
    r"\sin\frac{n}{2}",
    r"1 + \mathbf{g}",
    r"\mathbf{s} = \tan\frac{n}{4}\,\mathbf{e}",
    r"\alpha = w + i z",
    r"\beta = y + i x",
)
_CONDITIONS = (
    r"|\alpha|^2 + |\beta|^2 = 1",
    r"\mathbf{s}\cdot\mathbf{s} \le 1",
)


def _by_text(typed: Iterable[str]) -> dict[str, Formula]:
    return {found.text: found for found in map(formula, typed)}


HOW = _by_text(_FORMULAS)  # what follows, and how
WHICH = _by_text(_CONDITIONS)  # of the coordinates that are possible
