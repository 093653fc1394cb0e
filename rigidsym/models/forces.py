"""What acts on a body that turns about a fixed point: a potential and generalised forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import sympy as sp

from rigidsym.errors import ModelError
from rigidsym.models.body import Parameter, RigidBody
from rigidsym.models.rotation import RotationModel
from rigidsym.models.so3 import TIME, symbolic
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name


@dataclass(frozen=True, kw_only=True, slots=True)
class Forces:
    """A potential energy V(q), in joules, and generalised forces Q by coordinate, in N m.

    Symbols that are no coordinates are constants; they become parameters of the body. Forces may
    depend on the rates as well.
    """

    potential: sp.Expr = sp.S.Zero
    generalised: Mapping[sp.Expr, sp.Expr] = field(default_factory=lambda: MappingProxyType({}))

    def with_parameters(self, body: RigidBody, model: RotationModel) -> RigidBody:
        """The body with the constants of the forces among its parameters.

        Raises ModelError for a potential that depends on the rates or on t by itself, and for a
        force on what is no coordinate.
        """
        if self.potential.has(sp.Derivative):
            raise ModelError(f"the potential {self.potential} depends on rates; expected V(q)")
        for coordinate in self.generalised:
            if coordinate not in model.coordinates:
                names = ", ".join(str(q.func) for q in model.coordinates)
                raise ModelError(f"a force on {coordinate}, which is none of {names}")
        known = {p.symbol for p in body.parameters} | {*model.constants, TIME}
        given = (self.potential, *self.generalised.values())
        symbols = set().union(*(expression.free_symbols for expression in given)) - known
        more = (Parameter(symbol=s, positive=False) for s in sp.ordered(symbols))
        return replace(body, parameters=(*body.parameters, *more))


def forces_on(
    model: RotationModel, potential: sp.Expr | str | int, forces: Mapping[str, sp.Expr | str]
) -> Forces:
    """A potential and forces by the names of the coordinates; texts are read as in a file.

    In a text `theta_dot` is the rate of theta; other names are constants. Raises ModelError for
    a force on what is no coordinate, ExpressionError for a text that cannot be read.
    """
    known = {q.func.__name__: q for q in model.coordinates}
    names = known | {f"{name}_dot": sp.diff(q, TIME) for name, q in known.items()}
    generalised = {}
    for name, force in forces.items():
        if name not in known:
            raise ModelError(f"a force on {name}, which is none of {', '.join(known)}")
        generalised[known[name]] = _read(force, names)
    return Forces(potential=_read(potential, names), generalised=MappingProxyType(generalised))


def _read(given: sp.Expr | str | int, names: Mapping[str, sp.Expr]) -> sp.Expr:
    if not isinstance(given, str):
        return symbolic(given, "a potential or a force")
    used = {name: names.get(name) or sp.Symbol(check_name(name)) for name in names_in(given)}
    return parse_expression(given, used)
