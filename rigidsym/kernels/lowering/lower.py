"""Expressions of a derivation -> kernels.

Tangents and their like become sines over cosines, the sine and the cosine of an angle are taken
once, and what the outputs of a kernel have in common is computed once. Where n = √(v·v) leaves a
removable singularity, it is written in Stumpff functions of n²; where 1 ± cos θ divides, in
θ/2; and divisors that can vanish are guarded. Nothing else is changed: put back into each other,
the assignments are the derivation's own expression.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.halves import halved
from rigidsym.algebra.stumpff import Stumpff, at_zero, rewriter_of
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.derivatives import Derivative
from rigidsym.kernels.lowering.guard import guarded
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.read import Reader
from rigidsym.kernels.lowering.schedule import write
from rigidsym.mechanics.conversions.conversion_functions import Continuity, Converted, converted
from rigidsym.mechanics.conversions.conversions import Conversions
from rigidsym.mechanics.conversions.function import ConversionFunction, ConversionInput
from rigidsym.mechanics.derivation import (
    Argument as Vector,
    Derivation,
    Measure,
    Singularities,
    Step,
)
from rigidsym.mechanics.quantities.energy import body_in_words
from rigidsym.models.rotation import RotationModel

MARGIN = "singularity_margin"


def lower(
    derivation: Derivation,
    reserved: Iterable[str] = (),
    derivatives: Iterable[Derivative] = (),
    conversions: Conversions | None = None,
) -> ir.Program:
    """The kernels of a derivation: its quantities in the order of equations, derivatives,
    conversions.

    `reserved` are the words of the target that no name may be. Raises KernelError for an
    expression that kernels cannot hold.
    """
    kernels = _Lowering(derivation, Names(reserved))
    # a tensor given in numbers takes no arguments, and is no function
    steps = (*derivation.steps, *derivation.functions)
    found = tuple(kernels.of_step(step) for step in steps if step.quantity.inputs)
    found += tuple(kernels.margin())
    found += tuple(map(kernels.of_derivative, derivatives))
    added = converted(derivation, conversions) if conversions else Converted()
    found += tuple(map(kernels.of_step, added.steps))
    found += tuple(map(kernels.of_function, added.functions))
    used = {argument.name for kernel in found for argument in kernel.arguments}
    model = derivation.model
    return ir.Program(
        name=derivation.name,
        title=derivation.title,
        convention=(*_convention(model), *body_in_words(derivation.body)),
        source=str(model.source),
        arguments=tuple(a for name, a in kernels.arguments.items() if name in used),
        kernels=found,
        remarks=added.remarks,
        unwrapping=kernels.unwrapping(added.continuity) if added.continuity else None,
    )


def rewritten(derivation: Derivation, entries: Iterable[sp.Expr]) -> list[sp.Expr]:
    """Expressions in the form that kernels evaluate them in."""
    return _Lowering(derivation, Names()).rewritten(entries)


def margins_of(derivation: Derivation) -> tuple[sp.Expr, sp.Expr] | None:
    """What `singularity_margin` is, exactly and as evaluated; None where there is none."""
    return _Lowering(derivation, Names()).margins()


def _convention(model: RotationModel) -> tuple[str, ...]:
    """The convention in sentences, the frames of R among them."""
    presented = (
        "Passive: rotation_matrix is the direction cosine matrix A = Rᵀ, which takes space "
        "components to body components, x′ = A x; R itself turns the body."
        if model.passive
        else "Active: R takes body components to space components, x = R x′."
    )
    product = (f"R = {model.product}.",) if model.turns else ()
    bound = tuple(f"R is a rotation where {condition}." for condition in model.conditions)
    return (*product, *model.convention, presented, *bound)


def _roots(derivation: Derivation) -> list[sp.Expr]:
    """The roots of numbers that a body adds to those of R, such as √3 where a part is turned."""
    entries = (entry for step in derivation.steps for entry in step.expression)
    powers = {power for entry in entries for power in entry.atoms(sp.Pow)}
    return list(sp.ordered(p for p in powers if p.is_number and p.exp.is_Rational))


def _named(vector: Vector, names: Names, known: dict[sp.Expr, str]) -> ir.KernelArgument:
    """The argument, its components named as where they are known from another."""
    for symbol, name in zip(vector.symbols, vector.names, strict=True):
        if symbol not in known:
            known[symbol] = names.fresh(name)
    return ir.KernelArgument(
        name=vector.name,
        components=tuple(known[symbol] for symbol in vector.symbols),
        units=vector.units,
        about=vector.about,
        is_scalar=vector.is_scalar,
    )


class _Lowering:
    """The kernels of one derivation, over the same names."""

    def __init__(self, derivation: Derivation, names: Names) -> None:
        self.derivation = derivation
        self._vectors = {vector.name: vector for vector in derivation.arguments}
        self._known: dict[sp.Expr, str] = {}  # the names of components
        self.arguments = {v.name: _named(v, names, self._known) for v in derivation.arguments}
        self._names = names
        self._definitions = {d.symbol: d.expression for d in derivation.definitions}
        model = derivation.model
        inputs = [symbol for vector in derivation.arguments for symbol in vector.symbols]
        self._given = [*model.matrix, *inputs, *_roots(derivation)]
        self._rewriter = rewriter_of(self._given, model.constraints)

    def of_step(self, step: Step) -> ir.Kernel:
        """The kernel of one quantity."""
        quantity = step.quantity
        entries = self.rewritten(map(self._over_squares, step.expression))
        kernel = self._kernel(quantity.name, quantity.inputs, entries, step.shape)
        return replace(
            kernel,
            equation=step.number or None,
            symbol=quantity.symbol.text,
            definition=quantity.definition.text,
            about=quantity.about,
            unit=quantity.unit,
        )

    def of_derivative(self, derivative: Derivative) -> ir.Kernel:
        """The kernel of a value and its derivative, one after the other."""
        for vector in derivative.vectors:
            if vector.name not in self.arguments:
                self._vectors[vector.name] = vector
                self.arguments[vector.name] = _named(vector, self._names, self._known)
        step = derivative.step
        count = len(step.expression)
        entries = self.rewritten([*step.expression, *derivative.jacobian()])
        entries = [*entries[:count], *derivative.results(entries[count:])]
        inputs = [vector.name for vector in derivative.vectors]
        kernel = self._kernel(derivative.request.name, inputs, entries, (len(entries),))
        return replace(
            kernel,
            symbol=f"{step.quantity.symbol.text} by {derivative.by.name}",
            about=derivative.about,
            unit=step.quantity.unit,
            parts=derivative.parts,
        )

    def of_function(self, function: ConversionFunction) -> ir.Kernel:
        """The kernel of a conversion: its values one by one, as they are written."""
        arguments = tuple(map(self._taken, function.inputs))
        known = {
            symbol: component
            for taken, argument in zip(function.inputs, arguments, strict=True)
            for symbol, component in zip(taken.argument.symbols, argument.components, strict=True)
        }
        reader = Reader(function.name, known, self._definitions)
        reader.graph.share([reader.define(symbol, value) for symbol, value in function.shared])
        for symbol, value in function.values:
            reader.hold(symbol, value)
        weighted = list(map(reader.weighted, function.outputs))
        assignments, outputs = write(
            reader.graph, weighted, list(known.values()), self._names.copy()
        )
        return ir.Kernel(
            name=function.name,
            arguments=arguments,
            assignments=assignments,
            outputs=outputs,
            shape=(len(outputs),),
            symbol=function.symbol,
            about=function.about,
            remarks=function.remarks,
            unit=function.unit,
        )

    def _taken(self, given: ConversionInput) -> ir.KernelArgument:
        """An argument of a conversion; the coordinates that are kept are called as in q."""
        name = given.argument.name
        if name not in self.arguments:
            self.arguments[name] = replace(
                _named(given.argument, self._names, self._known),
                is_matrix=given.is_matrix,
                is_optional=given.is_optional,
            )
        return self.arguments[name]

    def unwrapping(self, found: Continuity) -> ir.Unwrapping:
        return ir.Unwrapping(
            kind=found.kind,
            arguments=tuple(self.arguments[name] for name in found.inputs),
            remarks=found.remarks,
            turns=self.of_function(found.turns) if found.turns else None,
            coordinates=self.of_function(found.coordinates) if found.coordinates else None,
        )

    def margin(self) -> Iterator[ir.Kernel]:
        """How far the rate matrix is from failing, where it is among the quantities and may."""
        found = self._failing
        if found is None:
            return
        minors = self.rewritten(found.minors)
        scale, about = _scaled(minors, found)
        value = _size(minors, scale)
        is_free = value.free_symbols.isdisjoint(self.derivation.model.constants)
        inputs = ("q",) if is_free else ("q", "parameters")
        kernel = self._kernel(MARGIN, inputs, [value], ())
        yield replace(kernel, symbol=_symbol(found.measure) + _over(scale), about=about)

    def margins(self) -> tuple[sp.Expr, sp.Expr] | None:
        """The same in the derivation's own minors, and as the kernel evaluates it."""
        found = self._failing
        if found is None:
            return None
        minors = self.rewritten(found.minors)
        scale, _ = _scaled(minors, found)
        return _size(found.minors, scale), _size(minors, scale)

    @property
    def _failing(self) -> Singularities | None:
        found = self.derivation.singularities
        return found if found is not None and _can_fail(found) else None

    def _over_squares(self, entry: sp.Expr) -> sp.Expr:
        """The entry with the minors squared in place of the determinant that divides.

        They are equal, but a sum of squares keeps its digits where it is nearly zero.
        """
        for below in entry.atoms(sp.Pow) if self._squares else ():
            number, base = below.base.as_content_primitive()
            if below.exp == -1 and base in self._squares:
                entry = entry.xreplace({below: 1 / (number * self._squares[base])})
        return entry

    @cached_property
    def _squares(self) -> dict[sp.Expr, sp.Expr]:
        """The determinant but for a number, either sign: the same as a sum of squares."""
        found = self.derivation.singularities
        if found is None or found.determinant is None or len(found.minors) < 2:
            return {}
        number, base = found.determinant.as_content_primitive()
        squares = sp.Add(*(minor**2 for minor in found.minors)) / number
        return {base: squares, -base: -squares}

    def rewritten(self, entries: Iterable[sp.Expr]) -> list[sp.Expr]:
        """The entries in forms that keep their digits where they can: see `algebra`."""
        plain = list(entries)
        if self._rewriter is None:
            return halved(plain, self._given, self.derivation.model.constraints)
        moving = ((e, self._rewriter.rewritten(e) if e.has(AppliedUndef) else None) for e in plain)
        return [old if new is None else new for old, new in moving]  # a new one may be zero

    def _kernel(
        self, name: str, inputs: Sequence[str], entries: Iterable[sp.Expr], shape: tuple[int, ...]
    ) -> ir.Kernel:
        arguments = tuple(self.arguments[vector] for vector in inputs)
        known = {
            symbol: component
            for argument in arguments
            for symbol, component in zip(
                self._vectors[argument.name].symbols, argument.components, strict=True
            )
        }
        reader = Reader(name, known, self._definitions)
        weighted = [reader.weighted(entry) for entry in entries]
        reader.graph.share(node for _, node in weighted)
        names = self._names.copy()
        assignments, outputs = write(reader.graph, weighted, list(known.values()), names)
        kernel = ir.Kernel(
            name=name, arguments=arguments, assignments=assignments, outputs=outputs, shape=shape
        )
        return guarded(kernel, names)


def _can_fail(found: Singularities) -> bool:
    return any(point.places for point in found.points) or not found.is_solved


def _size(minors: Sequence[sp.Expr], scale: sp.Rational) -> sp.Expr:
    """The size of the only minor over a scale; of several, the root of the sum of their squares."""
    if len(minors) == 1:
        return sp.Abs(minors[0] / scale, evaluate=False)
    return sp.sqrt(sp.Add(*(minor**2 for minor in minors)))


def _symbol(measure: Measure) -> str:
    roots = {"det W Wᵀ": "√det(W Wᵀ)", "det Wᵀ W": "√det(Wᵀ W)", "det [W, J]": "|det [W; J]|"}
    return roots.get(measure, "|det W|" if measure == "det W" else "√Σ minors²")


def _scaled(minors: Sequence[sp.Expr], found: Singularities) -> tuple[sp.Rational, str]:
    """The number that scales the margin to at most 1, and what the margin is in words.

    A product of sines, cosines and Stumpff functions is largest where each of them is; of anything
    else the determinant is taken as it is.
    """
    about = "how far the rates are from failing"
    if found.measure not in ("det W", "det [W, J]"):
        return sp.S.One, f"{about}, the product of the singular values of W; 0 where they do"
    number, rest = minors[0].as_coeff_Mul()
    factors = [factor.as_base_exp()[0] for factor in sp.Mul.make_args(rest)]
    if not all(isinstance(factor, sp.sin | sp.cos | Stumpff) for factor in factors):
        return sp.S.One, f"{about}; 0 where they do"
    value = at_zero(rest) if rest.has(Stumpff) else sp.S.One
    scale = abs(number) * (value if value.is_Rational and value else 1)
    return scale, f"{about}; 1 at most, 0 where they do"


def _over(scale: sp.Rational) -> str:
    return "" if scale == 1 else f"/({scale})"
