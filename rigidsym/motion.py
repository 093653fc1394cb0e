"""The Python face: `derive` gives a Motion, which prints its own kernels and its own note."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any

from rigidsym.mechanics.derivation import Argument, Derivation, Step
from rigidsym.mechanics.kinematics import derive as kinematics
from rigidsym.models.rotation import RotationModel
from rigidsym.models.rotation_text import rotation_from
from rigidsym.notes.formula.manner import DEFAULT, Manner

if TYPE_CHECKING:
    from rigidsym.kernels.lowering.derivatives import Asked
    from rigidsym.kernels.module import KernelModule
    from rigidsym.mechanics.conversions.conversions import Conversions
    from rigidsym.models.body import BodyDescription, RigidBody
    from rigidsym.models.distribution import Distribution
    from rigidsym.notes.note import Note


@dataclass(frozen=True, kw_only=True)
class Motion(Derivation):
    """A derivation with its two ways out: functions and a document.

    It stands above kernels and notes, so that neither has to know of the other, and the
    derivation of neither. `manner` is the notation in which it is printed.
    """

    manner: Manner = DEFAULT

    def __repr__(self) -> str:
        """One line, for a prompt; the steps themselves would fill pages."""
        count = sum(not proof.is_exact for proof in self.proofs)
        names = ", ".join(step.quantity.name for step in self.steps)
        return f"<Motion {self.name}, {f'{count} unproved' if count else 'proved'}: {names}>"

    def kernels(
        self,
        target: str = "numpy",
        *,
        conversions: bool = False,
        derivatives: Asked = (),
    ) -> KernelModule:
        """The module of functions for one target: `.source`, `.load()`, `.write(path)`.

        `conversions` adds the functions to and from the unit quaternion and the matrix, and
        `unwrap`; `derivatives` those of quantities by their inputs, with the value before them:
        {"angular_velocity_body": ("q", "q_dot")} adds `angular_velocity_body_jacobian_q` and so
        on, "q jvp" and "q vjp" products with a vector. Raises KernelError for an unknown target or
        derivative.
        """
        from rigidsym.kernels.module import generate

        return generate(self, target, conversions=conversions, derivatives=derivatives)

    @property
    def conversions(self) -> Conversions:
        """What converts between the coordinates, the unit quaternion and R, with its proofs."""
        from rigidsym.mechanics.conversions.conversions import conversions_of

        return conversions_of(self.model)

    def note(self, *, with_kernels: bool = True, conversions: bool = False) -> Note:
        """The document that shows the derivation: `.latex()`, `.html()`, `.markdown()`,
        `.notebook()`.

        `with_kernels` names the functions of the NumPy module beside their equations;
        `conversions` adds a section on the unit quaternion and the matrix.
        """
        from rigidsym.notes.note import note

        converting = self.conversions if conversions else None
        module = f"{self.name}.py" if with_kernels else None
        return note(self, module=module, manner=self.manner, conversions=converting)

    def page(self, *, with_kernels: bool = True) -> str:
        """One HTML file: the note, and a figure with sliders that moves, without network.

        At most 150 kB: where the note is longer, its longest parts are packed.
        """
        from rigidsym.page.page import print_page

        return print_page(self, self.note(with_kernels=with_kernels).document)

    def written(self, **choices: Any) -> Motion:
        """The same in another notation: `rates`, `vectors`, `body`, `angular_velocity`, `frames`.

        Raises ModelError for a choice that is not one of those in `rigidsym.notes.formula.manner`.
        """
        manner = replace(self.manner, **choices)
        steps = tuple(
            replace(step, manner=manner) if isinstance(step, MotionStep) else step
            for step in self.steps
        )
        return replace(self, manner=manner, steps=steps)

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        """What Jupyter shows: the note, the equations alone, or what a terminal shows."""
        from rigidsym.notes.formats.jupyter import bundle_of

        return bundle_of(self, self.note(with_kernels=False), self.manner)

    def _repr_latex_(self) -> str:
        return self._repr_mimebundle_()["text/latex"]


@dataclass(frozen=True, kw_only=True)
class MotionStep(Step):
    """A step that can show itself."""

    arguments: tuple[Argument, ...] = field(repr=False)
    model: RotationModel | None = field(default=None, repr=False)
    manner: Manner = DEFAULT

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        """What Jupyter shows: the equation with its number, or plain text."""
        from rigidsym.notes.formats.jupyter import step_bundle_of

        return step_bundle_of(self, self.arguments, self.manner, self.model)

    def _repr_latex_(self) -> str:
        return self._repr_mimebundle_()["text/latex"]


def derive(
    model: RotationModel | str,
    only: Collection[str] = (),
    *,
    body: RigidBody | BodyDescription | Distribution | None = None,
    theory: bool = False,
) -> Motion:
    """The proved kinematics of a rotation model; `only` names the quantities that are wanted.

    A text is read as on the command line: "ZXZ", "z(phi) x(theta)", "quaternion". With a `body`
    its kinetic energy and angular momentum follow, in the principal axes or any others; a
    description of one, or a distribution of mass, is integrated first. `theory`
    puts before it what holds for every body and rotation, equations 1 to 16 of the lecture.

    Raises NotARotation for a matrix with R Rᵀ ≠ 1 or det R ≠ 1, showing what is left over,
    AlgebraError for expressions that the ring cannot hold, and TypeError for what is no model.
    """
    rotation = rotation_from(model) if isinstance(model, str) else model
    if not isinstance(rotation, RotationModel):
        raise TypeError(
            f"expected a rotation, such as 'ZXZ' or rs.EulerAngles('ZXZ'), got {model!r}"
        )
    derivation = _derivation(rotation, only, body, has_theory=theory)
    steps = tuple(
        MotionStep(**_values(step), arguments=derivation.arguments, model=rotation)
        for step in derivation.steps
    )
    return Motion(**(_values(derivation) | {"steps": steps}))


def _derivation(
    model: RotationModel,
    only: Collection[str],
    body: RigidBody | BodyDescription | Distribution | None,
    *,
    has_theory: bool,
) -> Derivation:
    if has_theory:
        from rigidsym.mechanics.lecture.numbering import NEEDED, with_theory

        wanted = only and {*only, *NEEDED}
        return with_theory(_derivation(model, wanted, body, has_theory=False))
    if body is None:
        return kinematics.derive(model, only)
    from rigidsym.mechanics.energy import energy

    return energy.derive(model, body, only)


def _values(data: Derivation | Step) -> dict[str, Any]:
    names = _OF_STEP if isinstance(data, Step) else _OF_DERIVATION
    return {name: getattr(data, name) for name in names}


_OF_STEP, _OF_DERIVATION = (tuple(f.name for f in fields(k)) for k in (Step, Derivation))
