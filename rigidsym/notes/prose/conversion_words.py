"""The formulas in sentences about conversions, as their plain text writes them."""

from __future__ import annotations

from collections.abc import Mapping

from rigidsym.mechanics.derivation import Markup

_HALF = r"\tfrac{\beta}{2}"
_MIDDLE = r"\tfrac{\beta'}{2}"
_FORMULAS = {
    # a product of turns, and three turns with the middle one across
    "e": r"\mathbf{e}",
    "β": r"\beta",
    "cos β/2 + e sin β/2": rf"\cos{_HALF} + \mathbf{{e}}\sin{_HALF}",
    "C": r"\mathbf{C}",
    "R C": r"\mathbf{R}\,\mathbf{C}",
    "β′": r"\beta'",
    "κ": r"\kappa",
    "σ": r"\sigma",
    "δ": r"\delta",
    "cos β′/2 cos σ": rf"\cos{_MIDDLE}\cos\sigma",
    "cos β′/2 sin σ": rf"\cos{_MIDDLE}\sin\sigma",
    "sin β′/2 cos δ": rf"\sin{_MIDDLE}\cos\delta",
    "sin β′/2 sin δ": rf"\sin{_MIDDLE}\sin\delta",
    "tan β′/2": rf"\tan{_MIDDLE}",
    "σ = atan2(a₁, a₀)": r"\sigma = \operatorname{atan2}(a_1, a_0)",
    "δ = atan2(a₃, a₂)": r"\delta = \operatorname{atan2}(a_3, a_2)",
    "(a₀, a₁)": "(a_0, a_1)",
    "(a₂, a₃)": "(a_2, a_3)",
    # turns about any axes
    "e₁": r"\mathbf{e}_1",
    "e₂": r"\mathbf{e}_2",
    "e₃": r"\mathbf{e}_3",
    "e₃ = e₁": r"\mathbf{e}_3 = \mathbf{e}_1",
    "p₊": r"\mathbf{p}_+",
    "p₋": r"\mathbf{p}_-",
    "m₊": r"\mathbf{m}_+",
    "m₋": r"\mathbf{m}_-",
    "m₊ = p₊": r"\mathbf{m}_+ = \mathbf{p}_+",
    "m₋ = p₋": r"\mathbf{m}_- = \mathbf{p}_-",
    "p₊ = (p − e₁ p e₃)/2": r"\mathbf{p}_+ = (\mathbf{p} - \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2",
    "p₋ = (p + e₁ p e₃)/2": r"\mathbf{p}_- = (\mathbf{p} + \mathbf{e}_1\mathbf{p}\,\mathbf{e}_3)/2",
    "m = 1": r"\mathbf{m} = 1",
    "m = cos β/2 + e₂ sin β/2": rf"\mathbf{{m}} = \cos{_HALF} + \mathbf{{e}}_2\sin{_HALF}",
    "cos β/2": rf"\cos{_HALF}",
    "sin β/2": rf"\sin{_HALF}",
    "2 atan2(p₊·e₁, p₊·1)": r"2\operatorname{atan2}(\mathbf{p}_+\cdot\mathbf{e}_1, "
    r"\mathbf{p}_+\cdot 1)",
    "χ = 2 atan2(|p₋|, |p₊|)": r"\chi = 2\operatorname{atan2}(|\mathbf{p}_-|, |\mathbf{p}_+|)",
    "atan2(B, A)": r"\operatorname{atan2}(B, A)",
    "A = e₁·e₃ − k₁ k₃": r"A = \mathbf{e}_1\cdot\mathbf{e}_3 - k_1 k_3",
    "B = e₁·(e₂ × e₃)": r"B = \mathbf{e}_1\cdot(\mathbf{e}_2\times\mathbf{e}_3)",
    "k₁ = e₁·e₂": r"k_1 = \mathbf{e}_1\cdot\mathbf{e}_2",
    "k₃ = e₂·e₃": r"k_3 = \mathbf{e}_2\cdot\mathbf{e}_3",
    "θ₁": r"\theta_1",
    "θ₃": r"\theta_3",
    "k₁": "k_1",
    "k₃": "k_3",
    # parametrisations
    "φ": r"\varphi",
    "cos φ/2 + e sin φ/2": r"\cos\tfrac{\varphi}{2} + \mathbf{e}\sin\tfrac{\varphi}{2}",
    "sin φ/2": r"\sin\tfrac{\varphi}{2}",
    "n": "n",
    "n = |v|": r"n = |\mathbf{v}|",
    "v": r"\mathbf{v}",
    "v/n": r"\mathbf{v}/n",
    "cos n/2 + v/n sin n/2": r"\cos\tfrac{n}{2} + \tfrac{\mathbf{v}}{n}\sin\tfrac{n}{2}",
    "cos n/2": r"\cos\tfrac{n}{2}",
    "sin n/2": r"\sin\tfrac{n}{2}",
    "1 + g": r"1 + \mathbf{g}",
    "s = tan n/4 e": r"\mathbf{s} = \tan\tfrac{n}{4}\,\mathbf{e}",
    "α = w + i z": r"\alpha = w + i z",
    "β = y + i x": r"\beta = y + i x",
}
_CONDITIONS = {
    "|α|² + |β|² = 1": r"|\alpha|^2 + |\beta|^2 = 1",
    "s·s ≤ 1": r"\mathbf{s}\cdot\mathbf{s} \le 1",
}


def _markups(latex: Mapping[str, str]) -> dict[str, Markup]:
    return {text: Markup(formula, text) for text, formula in latex.items()}


HOW = _markups(_FORMULAS)  # what follows, and how
WHICH = _markups(_CONDITIONS)  # of the coordinates that are possible
