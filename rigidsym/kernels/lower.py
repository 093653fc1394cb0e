"""Expressions of a derivation -> kernels.

Tangents and their like become sines over cosines, the sine and the cosine of an angle are taken
once, and what the outputs of a kernel have in common is computed once. Nothing is approximated:
put back into each other, the assignments are the derivation's own expression.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

import sympy as sp

from rigidsym.errors import KernelError
from rigidsym.kernels import ir
from rigidsym.kernels.assign import write
from rigidsym.kernels.naming import Names
from rigidsym.kernels.sharing import Factors, Graph, Weighted
from rigidsym.mechanics.derivation import Argument as Vector
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.models.rotation import RotationModel

Monomial = tuple[Fraction, Factors]  # a number times nodes of the graph, ~node dividing

_QUOTIENTS: Mapping[type, tuple[str, str]] = {  # numerator and denominator; "" for one
    sp.tan: ("sin", "cos"),
    sp.cot: ("cos", "sin"),
    sp.sec: ("", "cos"),
    sp.csc: ("", "sin"),
    sp.sin: ("sin", ""),
    sp.cos: ("cos", ""),
}


def lower(derivation: Derivation, reserved: Iterable[str] = ()) -> ir.Program:
    """The kernels of a derivation, one a quantity, in the order of its equations.

    `reserved` are the words of the target that no name may be. Raises KernelError for an
    expression that kernels cannot hold.
    """
    names = Names(reserved)
    named = {vector.name: _named(vector, names) for vector in derivation.arguments}
    kernels = tuple(_kernel(derivation, step, named, names) for step in derivation.steps)
    used = {argument.name for kernel in kernels for argument in kernel.arguments}
    model = derivation.model
    return ir.Program(
        name=derivation.name,
        title=derivation.title,
        convention=_convention(model),
        source=str(model.source),
        arguments=tuple(argument for name, argument in named.items() if name in used),
        kernels=kernels,
    )


def _convention(model: RotationModel) -> tuple[str, ...]:
    """The convention in sentences, the frames of R among them."""
    presented = (
        "Passive: rotation_matrix is the direction cosine matrix A = Rᵀ, which takes space "
        "components to body components, x′ = A x; R itself turns the body."
        if model.passive
        else "Active: R takes body components to space components, x = R x′."
    )
    product = (f"R = {model.product}.",) if model.turns else ()
    return (*product, *model.convention, presented)


def _named(vector: Vector, names: Names) -> ir.Argument:
    return ir.Argument(
        name=vector.name,
        components=tuple(names.fresh(name) for name in vector.names),
        units=vector.units,
        about=vector.about,
    )


def _kernel(
    derivation: Derivation, step: Step, named: Mapping[str, ir.Argument], names: Names
) -> ir.Kernel:
    quantity = step.quantity
    arguments = tuple(named[name] for name in quantity.inputs)
    inputs = {
        symbol: component
        for argument in arguments
        for symbol, component in zip(
            derivation.argument(argument.name).symbols, argument.components, strict=True
        )
    }
    reader = _Reader(quantity.name, inputs)
    weighted = [reader.weighted(entry) for entry in step.expression]
    reader.graph.share(node for _, node in weighted)
    assignments, outputs = write(reader.graph, weighted, list(inputs.values()), names.copy())
    return ir.Kernel(
        name=quantity.name,
        arguments=arguments,
        assignments=assignments,
        outputs=outputs,
        shape=step.shape,
        equation=step.number,
        symbol=quantity.symbol.text,
        definition=quantity.definition.text,
        about=quantity.about,
        unit=quantity.unit,
    )


class _Reader:
    """From SymPy to one graph; inputs are its atoms, by their names."""

    def __init__(self, kernel: str, inputs: Mapping[sp.Expr, str]) -> None:
        self.graph = Graph()
        self._kernel = kernel
        self._inputs = inputs
        self._known: dict[sp.Expr, Monomial] = {
            symbol: (Fraction(1), (self.graph.atom(name),)) for symbol, name in inputs.items()
        }

    def weighted(self, expression: sp.Expr) -> Weighted:
        """The expression as one node of the graph with a number before it."""
        coefficient, factors = self._monomial(expression)
        return coefficient, self.graph.product(factors)

    def _monomial(self, expression: sp.Expr) -> Monomial:
        known = self._known.get(expression)
        if known is None:
            known = self._known[expression] = self._read(expression)
        return known

    def _read(self, expression: sp.Expr) -> Monomial:
        if expression.is_Rational:
            return Fraction(int(expression.p), int(expression.q)), ()
        if expression.is_number and expression.is_real:
            return Fraction(1), (self.graph.irrational(float(expression)),)
        if expression.is_Mul:
            return self._times(self._monomial(factor) for factor in expression.args)
        if expression.is_Add:
            return self._factored(self.graph.sum(map(self.weighted, expression.args)))
        if expression.is_Pow and (2 * expression.exp).is_Integer:
            return self._power(expression.base, expression.exp)
        if type(expression) in _QUOTIENTS:
            above, below = _QUOTIENTS[type(expression)]
            (argument,) = map(self.weighted, expression.args)
            factors = [self.graph.call(above, argument)] if above else []
            factors += [~self.graph.call(below, argument)] if below else []
            return Fraction(1), tuple(factors)
        raise KernelError(
            f"{self._kernel}: no kernel can compute {expression} ({type(expression).__name__}); "
            "expected sums, products, roots, sines and cosines of "
            + ", ".join(map(str, self._inputs))
        )

    def _power(self, base: sp.Expr, exponent: sp.Rational) -> Monomial:
        if not exponent.is_Integer:
            root = self.graph.call("sqrt", self.weighted(base))
            coefficient, factors = Fraction(1), _factors(root)
        else:
            coefficient, factors = self._monomial(base)
        times = int(exponent) if exponent.is_Integer else int(2 * exponent)
        factors = factors if times > 0 else tuple(~factor for factor in factors)
        return coefficient**times, factors * abs(times)

    def _times(self, monomials: Iterable[Monomial]) -> Monomial:
        coefficient, factors = Fraction(1), _factors()
        for number, more in monomials:
            coefficient, factors = coefficient * number, factors + more
        return coefficient, factors

    def _factored(self, weighted: Weighted) -> Monomial:
        coefficient, node = weighted
        return coefficient, self.graph.factors(node)


def _factors(*nodes: int) -> Factors:
    return nodes
