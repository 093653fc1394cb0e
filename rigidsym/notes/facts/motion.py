"""What is constant along a motion, what follows from it, and the pictures of its examples."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator
from functools import cached_property

import sympy as sp

from rigidsym.errors import MissingExtra
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import decimal
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula, equal
from rigidsym.mechanics.derivation import Consequence, Derivation, FirstIntegral
from rigidsym.mechanics.quantities.dynamics import MOTION
from rigidsym.models.forces import OMEGA_COMPONENTS, Forces, initial_values
from rigidsym.models.rotation import OMEGA_BODY, TIME
from rigidsym.notes.document import Equation, Figure
from rigidsym.notes.equations import claims_of
from rigidsym.notes.figure.motion_picture import motion_picture
from rigidsym.notes.template import figure_with
from rigidsym.system.records import Record


class MotionFacts(Record):
    """The motion of a body under forces."""

    derivation: Derivation
    forces: Forces
    letters: Letters

    @property
    def is_of_angular_velocity(self) -> bool:
        """Whether Ω′ takes the place of the rates: Euler's equations."""
        return any(step.quantity.name == "torque_body" for step in self.derivation.steps)

    @property
    def applied(self) -> list[sp.Matrix | None]:
        """The torque N′, (3, 1), and Q beside it, (n, 1), as they are given; None for no force."""
        forces = [self.forces.generalised.get(q, 0) for q in self.derivation.model.coordinates]
        return [sp.Matrix(given) if any(given) else None for given in (self.forces.torque, forces)]

    @property
    def are_proved(self) -> bool:
        return all(integral.proof.is_exact for integral in self.derivation.first_integrals)

    @property
    def conserved(self) -> list[tuple[FirstIntegral, str]]:
        """The first integrals, each with the quantity whose equation prints it, or nothing."""
        steps = [step for step in self.derivation.steps if step.quantity.section == MOTION]
        owners = {entry: s.quantity.name for s in reversed(steps) for entry in s.expression}
        return [(each, owners.get(each.expression, "")) for each in self.derivation.first_integrals]

    @property
    def consequences(self) -> Iterator[tuple[Consequence, Equation]]:
        """The motion as a whole: effective potential, steady motions, exact solutions."""
        for each in self.derivation.consequences:
            proved, unproved = claims_of(each.proofs)
            sides = (
                side if isinstance(side, Formula) else formula_of(side, self.letters)
                for side in (each.left, each.value)
            )
            yield each, Equation(sides=tuple(sides), proved=proved, unproved=unproved)

    @cached_property
    def picture(self) -> Figure | None:
        """The examples, with their numbers, in common and apart, in the caption."""
        try:
            picture = motion_picture(self.derivation, self.letters)
        except MissingExtra as error:
            warnings.warn(f"a note without the picture of its examples: {error}", stacklevel=2)
            return None
        if picture is None:
            return None
        examples, model = self.forces.examples, self.derivation.model
        symbols: dict[str, sp.Expr] = dict(zip(OMEGA_COMPONENTS, OMEGA_BODY, strict=True))
        symbols |= {q.func.__name__: q for q in model.coordinates}
        symbols |= {f"{q.func.__name__}_dot": q.diff(TIME) for q in model.coordinates}

        def equations(values: Iterable[tuple[str, float]]) -> list[Formula]:
            named = ((symbols.get(name, sp.Symbol(name)), value) for name, value in values)
            return [equal(formula_of(e, self.letters), decimal(value)) for e, value in named]

        starts = [initial_values(model, example.initial) for example in examples]
        moving = {name for start in starts for name, value in start.items() if value}
        values = [
            {**example.parameters, **{name: start[name] for name in start if name in moving}}
            for example, start in zip(examples, starts[: picture.told], strict=False)
        ]
        common = [item for item in values[0].items() if all(item in v.items() for v in values)]
        own = [equations(item for item in each.items() if item not in common) for each in values]
        return figure_with(
            "en/motion_picture",
            picture.drawing,
            self.letters,
            has_several=len(own) > 1,
            parameters=equations(item for item in common if item[0] not in starts[0]),
            initial=equations(item for item in common if item[0] in starts[0]),
            differing=[each for each in own if each],
            polhodes=picture.polhodes,
            is_still=picture.is_still,
            # whether θ goes to and fro between the roots of the effective potential
            is_bounded=any(s.quantity.name == "effective_potential" for s in self.derivation.steps),
        )
