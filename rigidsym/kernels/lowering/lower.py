"""Expressions of a derivation -> kernels.

Tangents and cotangents become quotients of sines and cosines, and the sine and cosine of an angle
and the common parts of the outputs are computed once. Removable singularities in n = √(v·v) are
written in Stumpff functions of n², divisors 1 ± cos θ in θ/2, and divisors that can vanish are
guarded. Sums may be factored anew. Nothing else is changed: substituted into each other, the
assignments give the expression of the derivation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import sympy as sp

from rigidsym.algebra.stable_forms import stable_forms
from rigidsym.formula.tree import with_names
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.derivatives import Jacobian
from rigidsym.kernels.lowering.graph import Graph, Weighted, write
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.rounding import error_of_form, guarded
from rigidsym.mechanics.conversions.function import ConversionFunction, Converted
from rigidsym.mechanics.derivation import Argument as Vector, Derivation, Step, phrase

MARGIN = "singularity_margin"
NO_CONVERSIONS = Converted()

Pairs = tuple[tuple[sp.Expr, Any], ...]
Given = tuple[Pairs, Pairs, tuple[sp.Expr, ...]]  # inputs with their names, definitions, entries


def lower(
    derivation: Derivation,
    reserved: Iterable[str] = (),
    derivatives: Iterable[Jacobian] = (),
    added: Converted = NO_CONVERSIONS,
) -> ir.Program:
    """The kernels of a derivation: its quantities in the order of equations, derivatives,
    then what conversions have `added`.

    `reserved` are the words of the target that no name may be. Raises KernelError for an
    expression that kernels cannot hold.
    """
    kernels = _Lowering(derivation, Names(reserved))
    # a tensor given in numbers takes no arguments, and is no function
    steps = (*derivation.steps, *derivation.functions.values())
    found = (
        *kernels.of_steps([step for step in steps if step.quantity.inputs]),
        *kernels.margin(),
        *kernels.of_steps(tuple(derivatives)),
        *kernels.of_steps(added.steps),
        *map(kernels.of_function, added.functions),
    )
    used = {argument.name for kernel in found for argument in kernel.arguments}
    body, is_top = derivation.body, derivation.about_fixed_point
    return ir.Program(
        name=derivation.name,
        title=derivation.title,
        arguments=tuple(a for name, a in kernels.arguments.items() if name in used),
        kernels=found,
        model=derivation.model,
        of_body=tuple(body.sentences(about_fixed_point=is_top)) if body else (),
        remarks=added.remarks,
        continuity=added.continuity,
    )


class _Lowering:
    """The kernels of one derivation, over the same names."""

    def __init__(self, derivation: Derivation, names: Names) -> None:
        self.derivation = derivation
        self._names = names
        self._known: dict[sp.Expr, str] = {}  # the names of components
        self.arguments: dict[str, ir.KernelArgument] = {}
        self._vectors = {vector.name: vector for vector in derivation.arguments}
        for vector in derivation.arguments:
            self._argument(vector)
        self._definitions = {d.symbol: d.expression for d in derivation.definitions}

    def _argument(self, vector: Vector, *, is_matrix: bool = False) -> ir.KernelArgument:
        """The argument; components of another keep their names."""
        if vector.name not in self.arguments:
            for symbol, name in zip(vector.symbols, vector.names, strict=True):
                if symbol not in self._known:
                    self._known[symbol] = self._names.fresh(name)
            self.arguments[vector.name] = ir.KernelArgument(
                name=vector.name,
                components=tuple(self._known[symbol] for symbol in vector.symbols),
                units=vector.units,
                about=vector.about,
                shape=(3, 3) if is_matrix else (len(vector.names),) * (not vector.is_scalar),
            )
        return self.arguments[vector.name]

    def of_steps(self, steps: Sequence[Step]) -> Iterator[ir.Kernel]:
        """The kernels of quantities: those of their originals, but for the order and the names."""
        originals = [step.original or (step.expression, {}) for step in steps]
        forms = self._stable(map(self._over_squares, entries.flat()) for entries, _ in originals)
        for step, (original, others), entries in zip(steps, originals, forms, strict=True):
            quantity = step.quantity
            kernel = self._kernel(
                quantity.name,
                [self._vectors[name] for name in quantity.inputs],
                entries,
                shape=step.shape,
                equation=step.number or None,
                symbol=quantity.symbol.text,
                definition=quantity.definition.text,
                about=quantity.about,
                unit=quantity.unit,
            )
            renamed = original.xreplace(others) if others else original
            of_entries = dict(zip(renamed, kernel.outputs, strict=True))
            outputs = tuple(of_entries[entry] for entry in step.expression)
            if others or outputs != kernel.outputs:
                pairs = ((self._known[a], self._known[b]) for a, b in others.items())
                names = {ir.Name(one): ir.Name(other) for one, other in pairs}
                lines, outputs = with_names((kernel.assignments, outputs), names)
                kernel = replace(kernel, assignments=lines, outputs=outputs, original=kernel)
            yield kernel

    def of_function(self, function: ConversionFunction) -> ir.Kernel:
        """The kernel of a conversion: its values one by one, as they are written."""
        argument = self._argument(function.argument, is_matrix=function.is_matrix)
        inputs = {symbol: self._known[symbol] for symbol in function.argument.symbols}
        graph = Graph(function.name, inputs, self._definitions)
        for symbol, value in function.values:
            graph.hold(symbol, value)
        weighted = list(map(graph.weighted, function.outputs))
        plain = Graph(function.name, inputs)
        _, halves = write(plain, list(map(plain.weighted, function.halves)), self._names.copy())
        return _written(
            graph,
            weighted,
            self._names.copy(),
            name=function.name,
            arguments=(argument,),
            shape=(len(weighted),),
            symbol=function.symbol,
            about=function.about,
            remarks=function.remarks,
            unit=function.unit,
            halves=halves,
        )

    def margin(self) -> Iterator[ir.Kernel]:
        """How far the coordinates are from a singular orientation, where rates are asked for."""
        found = self.derivation.singularities
        if found is None or (found.is_solved and not any(p.places for p in found.points)):
            return
        (minors,) = self._stable([found.minors])
        about = phrase("quantities", MARGIN)
        if len(minors) == 1:
            value = sp.Abs(minors[0], evaluate=False)
        else:
            # By the Cauchy-Binet formula, Σ minors² is the square of the product of those singular
            # values that can differ from 0.
            value = sp.sqrt(sp.Add(*(minor**2 for minor in minors)))
        inputs = [self._vectors[name] for name in ("q", "parameters") if name in self._vectors]
        size = f"√({found.measure})" if "ᵀ" in found.measure else f"|{found.measure}|"
        symbol = "√Σ minors²" if found.measure == "minors" else size
        kernel = self._kernel(MARGIN, inputs, [value], shape=(), symbol=symbol, about=about)
        coordinates, *constants = kernel.arguments
        if constants and all(kernel.used.isdisjoint(a.components) for a in constants):
            kernel = replace(kernel, arguments=(coordinates,))
        yield kernel

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
        # The determinant of W Wᵀ or Wᵀ W is Σ minors² by the Cauchy-Binet formula.
        squares = sp.Add(*(minor**2 for minor in found.minors)) / number
        return {base: squares, -base: -squares}

    @cached_property
    def _given(self) -> list[sp.Expr]:
        """What the entries are made of."""
        derivation = self.derivation
        inputs = [symbol for vector in derivation.arguments for symbol in vector.symbols]
        roots: list[sp.Expr] = []
        if derivation.body is not None:
            # a body adds roots of numbers to those of R, such as √3 where a part is turned
            entries = (entry for step in derivation.steps for entry in step.expression)
            powers = {power for entry in entries for power in entry.atoms(sp.Pow)}
            roots += sp.ordered(p for p in powers if p.is_number and p.exp.is_Rational)
        return [*derivation.model.matrix, *inputs, *roots]

    def _stable(self, groups: Iterable[Iterable[sp.Expr]]) -> list[list[sp.Expr]]:
        """Groups of entries in forms that keep their digits where they can."""
        lists = [list(entries) for entries in groups]
        return stable_forms(lists, self._given, self.derivation.model.constraints)

    def _kernel(
        self, name: str, vectors: Sequence[Vector], entries: Iterable[sp.Expr], **words: Any
    ) -> ir.Kernel:
        """A kernel whose common subexpressions are shared, with its divisors guarded."""
        arguments = tuple(map(self._argument, vectors))
        inputs = tuple((s, self._known[s]) for vector in vectors for s in vector.symbols)
        given = inputs, tuple(self._definitions.items()), tuple(entries)
        return _lowered(name, arguments, given, frozenset(self._names.taken), **words)


@lru_cache(maxsize=128)  # conventions that differ by the names of axes share them
def _lowered(
    name: str, arguments: tuple[ir.KernelArgument, ...], given: Given, taken: Set[str], **words: Any
) -> ir.Kernel:
    constants = tuple(c for a in arguments if a.name == "parameters" for c in a.components)
    graph, weighted = _shared(name, given, constants)
    names = Names(taken)
    return guarded(_written(graph, weighted, names, name=name, arguments=arguments, **words), names)


def _written(graph: Graph, weighted: Sequence[Weighted], names: Names, **words: Any) -> ir.Kernel:
    assignments, outputs = write(graph, weighted, names)
    return ir.Kernel(assignments=assignments, outputs=outputs, **words)


@lru_cache(maxsize=64)  # a page and a module share the same, and then name it in their languages
def _shared(name: str, given: Given, constants: tuple[str, ...]) -> tuple[Graph, list[Weighted]]:
    """The entries as nodes of a graph, in which what they have in common is one node.

    They are factored anew if that saves a tenth of the operations and the bound on rounding gets no
    larger. Where quotients leave no bound, the error at operands of one may grow by an eighth.
    """
    inputs, definitions, entries = given
    graph = Graph(name, dict(inputs), dict(definitions))
    weighted = list(map(graph.weighted, entries))
    roots = [node for _, node in weighted]
    # A product of constants makes some forms shorter, and parts the common factors of others.
    anew = [graph.factored(roots, each) for each in dict.fromkeys(((), constants))]
    forms = [graph, *filter(None, anew)]
    for form in forms:
        form.share(roots)
    counts = [sum(map(form.operations, form.reachable(roots))) for form in forms]
    best = forms[counts.index(min(counts))]
    if min(counts) < 0.9 * counts[0]:
        names = [text for _, text in inputs]
        limit, error = (error_of_form(*write(g, weighted, Names(names))) for g in (graph, best))
        if error <= limit * (1.125 if graph.divides(roots) else 1):
            graph = best
    return graph, weighted
