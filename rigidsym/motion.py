"""What a Python user holds: `derive` returns a Motion, which prints its own kernels and note."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import fields, replace
from types import ModuleType
from typing import TYPE_CHECKING, Any

import sympy as sp

from rigidsym.errors import ModelError, offer
from rigidsym.formula.notation import CHOICES as CHOICES, DEFAULT as DEFAULT, Notation as Notation
from rigidsym.formula.tree import Words
from rigidsym.kernels.lowering.derivatives import Asked
from rigidsym.kernels.module import KernelModule as KernelModule, generate
from rigidsym.mechanics.derivation import Derivation, Proof
from rigidsym.mechanics.derive import derive as derivation_of
from rigidsym.mechanics.prove import identity
from rigidsym.mechanics.quantities import NAMES, check_quantity
from rigidsym.models.library import rotation_from
from rigidsym.models.rotation import RotationModel
from rigidsym.system.processes import rare_collections, time_limit

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions
    from rigidsym.models.body import Body
    from rigidsym.notes.note import Note
    from rigidsym.simulation.trajectory import Trajectory

QUANTITIES = NAMES


class Motion(Derivation, kw_only=True):
    """A derivation and the notation in which it is printed; every quantity is an attribute.

    It prints kernels, notes and pages, and simulates motions.
    """

    notation: Notation = DEFAULT

    def __repr__(self) -> str:
        """One line, since the steps themselves would fill pages."""
        count = sum(not proof.is_exact for proof in self.proofs)
        names = ", ".join(step.quantity.name for step in self.steps)
        return f"<Motion {self.name}, {f'{count} unproved' if count else 'proved'}: {names}>"

    def __getattr__(self, name: str) -> Any:
        """A quantity. Raises QuantityError, which is an AttributeError, with what it needs."""
        if name in NAMES:
            check_quantity(name, body=self.body, forces=self.forces)
        return super().__getattr__(name)

    def latex(self, quantity: str) -> str:
        """The equation of one quantity in LaTeX; raises QuantityError for an unknown one."""
        return self._printed(quantity, "latex")

    def text(self, quantity: str) -> str:
        """The equation of one quantity as the terminal shows it."""
        return self._printed(quantity, "text")

    def _printed(self, quantity: str, form: str) -> str:
        # the notes are imported when something is printed
        from rigidsym.notes.formats.terminal import printed_step

        return printed_step(self.step(quantity), form, self, self.notation)

    def kernels(
        self,
        target: str = "numpy",
        *,
        conversions: bool = False,
        derivatives: Asked = (),
        **options: str | bool,
    ) -> KernelModule:
        """The functions in one language: `.source`, `.load()`, `.write(path)`.

        `conversions` adds conversions to and from the unit quaternion and the matrix, and
        `unwrap`. `derivatives` adds functions that return the Jacobian of a quantity:
        {"spin_matrix": ("q", "q_dot")} adds `spin_matrix_jacobian_q` and
        `spin_matrix_jacobian_q_dot`.
        `options` depend on the target: `kernels("c", lean="double")` prints C for firmware.
        Raises KernelError for an unknown target, option or derivative.
        """
        return generate(self, target, conversions=conversions, derivatives=derivatives, **options)

    def equality(self, left: sp.MatrixBase, right: sp.MatrixBase) -> Proof:
        """The proof that two matrices in coordinates, rates and other inputs are equal.

        Raises DerivationError, with the residual, if they are not.
        """
        model = self.model
        difference = left - right
        return identity(difference, Words("equality"), self.name, model.constraints, model.example)

    @property
    def conversions(self) -> Conversions:
        """The conversions between the coordinates, the unit quaternion and R, with proofs."""
        from rigidsym.mechanics.conversions.conversions import Conversions

        return Conversions(self.model)

    def note(
        self, *, with_kernels: bool = True, conversions: bool = False, style: str = "lecture"
    ) -> Note:
        """The note on the derivation: `.latex()`, `.html()`, `.markdown()`.

        `style` is "lecture", which explains, or "audit", which shows every identity and, with
        `with_kernels`, the function of the NumPy module beside its equation. `conversions` adds
        a section on the unit quaternion and the matrix.
        """
        from rigidsym.notes.note import note

        return note(
            self,
            module=f"{self.name}.py" if with_kernels else None,
            notation=self.notation,
            conversions=self.conversions if conversions else None,
            style=style,
        )

    def simulate(
        self,
        initial: Mapping[str, Any],
        parameters: Mapping[str, float],
        t_end: float,
        **options: Any,
    ) -> Trajectory:
        """The motion from t = 0 to `t_end` seconds, with the drift of its first integrals.

        `initial` contains coordinates and rates by name (theta, theta_dot), `parameters` every
        constant; for the options see `rigidsym.simulation.solver.simulate`.
        """
        from rigidsym.simulation.solver import simulate

        return simulate(self, initial, parameters, t_end, **options)

    def page(self, *, with_kernels: bool = True, start: Mapping[str, float] | None = None) -> str:
        """One HTML file that needs no network: the note, and a figure with sliders.

        `start` contains initial values of coordinates, rates and constants by name, in SI units.
        """
        from rigidsym.page.print_page import print_page

        return print_page(self, self.note(with_kernels=with_kernels).document, start or {})

    def with_notation(self, **choices: Any) -> Motion:
        """The same motion in another notation: `rates`, `vectors`, `angular_velocity`, as in
        [notation] of a derivation file. Raises ModelError for others.
        """
        for unknown in choices.keys() - CHOICES.keys():
            raise ModelError(f"notation has no {unknown}; {offer(unknown, CHOICES)}")
        return replace(self, notation=replace(self.notation, **choices))

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        """What Jupyter shows: the note, the equations, or the text of the terminal."""
        from rigidsym.notes.formats.terminal import show

        equations = [(self.latex(step.quantity.name), step.number) for step in self.steps]
        numbered = (f"$$\n{equation}\n\\tag{{{number}}}\n$$" for equation, number in equations)
        return {
            "text/markdown": self.note(with_kernels=False).markdown(),
            "text/latex": "\n\n".join(numbered),
            "text/plain": show(self, notation=self.notation),
        }


@rare_collections()
def derive(
    model: RotationModel | str,
    only: str | Collection[str] = (),
    *,
    body: Body | None = None,
    potential: sp.Expr | str | None = None,
    forces: Mapping[str, sp.Expr | str] | None = None,
    torque: Sequence[sp.Expr | str] | None = None,
    first_integrals: Mapping[str, sp.Expr | str] | None = None,
    parts: Sequence[Mapping[str, Any]] | None = None,
    fixed_point: Sequence[sp.Expr | str | float] | str | None = None,
    method: str | None = None,
    examples: Sequence[Mapping[str, Any]] | None = None,
    theory: bool = False,
    timeout: float | None = None,
) -> Motion:
    """Derive and prove the kinematics of a rotation; `only` names the quantities wanted.

    A rotation may be a text, as on the command line: "ZXZ", "z(phi) x(theta)", "quaternion".

    A `body` adds its kinetic energy and angular momentum, in principal or any other axes; a shape
    or another distribution of mass is integrated first.

    A `potential` V(q, t), `forces` by coordinate ("theta": "-c*theta_dot") or a `torque` in body
    components adds the equations of motion about a fixed point. Principal moments, or a tensor
    without a centre of mass, are then about this point. For any other body `fixed_point` is
    needed: three components in the description of the body, (0, 0, "-l"), or "centre_of_mass";
    its tensor is moved there by the parallel-axis theorem. `method` is "lagrange", with the state
    (q, q̇) and constraint forces that do no work, or "euler", with the state (q, Ω′).
    `first_integrals` are claims by name, to be proved.
    `parts` are other moving parts, {"rotation", "principal_moments"} or {"velocity", "mass"}.
    `examples` are motions that the note draws, {"parameters", "initial", "time"}; values that an
    example does not name are those of the first.

    `theory` adds equations 1 to 16 of the lecture, which hold for every body and rotation.
    `timeout` limits the time, in seconds.

    Raises NotARotation, with the residual, if R Rᵀ ≠ 1 or det R ≠ 1; AlgebraError for expressions
    that exact algebra cannot represent; QuantityError for an unknown quantity; LimitReached when
    the time is up; TypeError for arguments of the wrong type.
    """
    rotation = rotation_from(model) if isinstance(model, str) else model
    if not isinstance(rotation, RotationModel):
        raise TypeError(
            "expected a rotation, such as 'ZXZ', rs.EulerAngles('ZXZ'), or rs.given(matrix, "
            f"name='mine') for a matrix R(q); got {model!r}"
        )
    if body is not None:
        # A derivation without a body needs none of its kinds.
        from rigidsym.models.body import Body, RigidBody

        if not isinstance(body, Body):
            raise TypeError(f"expected a body, such as rs.solid('cone'), got {body!r}")
        body = body.as_described if isinstance(body, RigidBody) else body
    if not (isinstance(only, Collection) and all(isinstance(name, str) for name in only)):
        raise TypeError(f"only: expected names of quantities, got {only!r}")
    wanted = (only,) if isinstance(only, str) else tuple(only)
    with nullcontext() if timeout is None else time_limit(timeout):
        acting = None
        given = {"potential": potential, "forces": forces, "torque": torque, "method": method}
        given |= {"first_integrals": first_integrals, "parts": parts, "examples": examples}
        given |= {"fixed_point": fixed_point}
        moving: dict[str, Any] = {key: e for key, e in given.items() if e is not None}
        if moving:
            if body is None:
                raise ModelError("forces act on a body; expected body=rs.principal_moments(...)")
            from rigidsym.models.forces import forces_on

            acting = forces_on(rotation, **moving)
        derivation = derivation_of(rotation, wanted, body=body, forces=acting, theory=theory)
    return Motion(**{f.name: getattr(derivation, f.name) for f in fields(Derivation)})


def kernels(
    model: RotationModel | str,
    target: str = "numpy",
    *,
    only: str | Collection[str] = (),
    body: Body | None = None,
    conversions: bool = False,
    derivatives: Asked = (),
    **options: str | bool,
) -> ModuleType:
    """The functions of a rotation, loaded: `rs.kernels("ZYX").rate_matrix_body(q)`.

    This is `derive`, `Motion.kernels` and `load` in one step, and raises the same errors.
    """
    motion = derive(model, only, body=body)
    module = motion.kernels(target, conversions=conversions, derivatives=derivatives, **options)
    return module.load()
