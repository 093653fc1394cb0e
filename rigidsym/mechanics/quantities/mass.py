r"""The quantities of a mass distribution, one entry each.

A workspace k (`mechanics.body`) has the body, and the moments of its mass distribution: ∫ dm,
∫ x′ dm and ∫ x′x′ᵀ dm. For particles the integrals are sums.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Quantity, by_name, law, when
from rigidsym.models.rotation import SOURCES

MASS = formula("M")
INERTIA = formula(r"\I'")
INERTIA_SPACE = formula(r"\I")
POINT = formula(r"\p")
DIRECTION = formula(r"\n")
# I′ + M (|d|² 1 − d dᵀ), the theorem of parallel axes
STEINER = r"#1 + #2\,(|#3|^2\,\1 - #4 #4^T)"
_ONE = sp.eye(3)
AT_REST = "no_free_centre"  # of quantities that need a centre of mass which moves freely
OF_BODY, OF_INERTIA = "body", "inertia"  # sections of the note
_BODY: dict[str, Any] = {"section": OF_BODY, "is_result": True}
_INERTIA: dict[str, Any] = {"unit": "kg m^2", "section": OF_INERTIA}

_TENSOR = r"\int \left(|\x'-\c|^2\,\1 - (\x'-\c)(\x'-\c)^T\right)\,dm"


def _of_particles(integral: str) -> str:
    """An integral over the mass as a sum over particles: Σ mᵢ xᵢ′ for ∫ x′ dm."""
    whole = integral.replace(r"\int", r"\sum_i m_i\,").replace(r"\,dm", "")
    return whole.replace(r"\x'", r"\x'_i")


def _integrated(
    *claims: tuple[str, Callable[[Any, Any], Any]], definition: str = ""
) -> dict[str, Any]:
    """A definition and laws with integrals over the mass, which are sums for particles."""

    def changes(spelled: Callable[[str], str]) -> dict[str, Any]:
        fields: dict[str, Any] = {"definition": formula(spelled(definition))} if definition else {}
        return {**fields, "laws": tuple(law(spelled(claim), e) for claim, e in claims)}

    return {**changes(str), "variants": (when("particles", **changes(_of_particles)),)}


mass = Quantity(
    **_BODY,
    symbol=MASS,
    unit="kg",
    shape="scalar",
    **_integrated(definition=r"\int\,dm"),
    value=lambda k: k.body.mass if k.is_distributed and not k.body.mass.is_Symbol else None,
    rests_on=lambda k: k.moments.proofs,
    without="given_mass",
    reason="sum_of_parts",
)

centre_of_mass = Quantity(
    **_BODY,
    symbol=formula(r"\c"),
    unit="m",
    shape="vector",
    **_integrated(
        (r"\int (\x'-\c)\,dm = \0", lambda k, x: k.moments.first - k.body.mass * x),
        definition=r"\frac{1}{M}\int \x'\,dm",
    ),
    source=SOURCES["Landau 8"],
    value=lambda k: k.body.centre if k.is_distributed else None,
    rests_on=lambda k: k.moments.proofs if k.body.mass.is_Symbol else (),
    without="unknown_distribution",
    reason="mean_position",
)

_SYMMETRIC = law(r"\I' = \I'^T", lambda _, x: x - x.T)
_ABOUT_ORIGIN = law(
    rf"\I'_O = {STEINER}",
    lambda k, x: k.tensor(k.moments.second) - x - k.steiner(k.body.mass, k.body.centre),
    *(INERTIA, MASS, formula(r"\c"), formula(r"\c")),
)
_OF_PARTS = law(
    r"\I' = \sum_k \left(\R_k\I'_k\R_k^T + m_k(|\d_k|^2\,\1 - \d_k\d_k^T)\right)",
    lambda k, x: k.inertia_of_parts() - x,
)

_TENSOR_P = r"\int \left(|\x'-\p|^2\,\1 - (\x'-\p)(\x'-\p)^T\right)\,dm"


def _about_point(k: Any, x: sp.MatrixBase) -> sp.MatrixBase:
    return k.tensor(k.second_about_point) - x


inertia_tensor = Quantity(
    **_BODY,
    symbol=INERTIA,
    unit="kg m^2",
    source=SOURCES["Landau 32"],
    value=lambda k: k.body.inertia,
    laws=(_SYMMETRIC,),
    reason="given_tensor",
    variants=(
        when(
            "distributed",
            definition=formula(_TENSOR),
            laws=(_SYMMETRIC, _ABOUT_ORIGIN),
            reason="tensor_about_centre",
        ),
        when("particles", definition=formula(_of_particles(_TENSOR))),
        when("composite", laws=(_SYMMETRIC, _ABOUT_ORIGIN, _OF_PARTS), reason="tensors_of_parts"),
        when(
            "fixed_point",
            meaning="inertia_tensor_fixed_point",
            reason="given_tensor_about_fixed_point",
        ),
        when(
            "stated_point",
            definition=formula(STEINER, formula(r"\I'_C"), MASS, formula(r"\d"), formula(r"\d")),
            laws=(_SYMMETRIC, law(rf"\I' = {_TENSOR_P}", _about_point)),
            reason="tensor_about_fixed_point",
        ),
    ),
)

inertia_tensor_point = Quantity(
    **_INERTIA,
    symbol=formula(r"\I'_P"),
    inputs=("point",),
    definition=formula(r"\I' + M\,(|\p-\c|^2\,\1 - (\p-\c)(\p-\c)^T)"),
    source=SOURCES["Landau 32 (32.12)"],
    value=lambda k: k.body.inertia + k.steiner(k.body.mass, k.point - k.body.centre),
    **_integrated((rf"\I'_P = {_TENSOR_P}", _about_point)),
    reason="parallel_axes",
    without=AT_REST,
)


def _moment_by_mass(k: Any, x: sp.Expr) -> sp.Matrix:
    """∫ |n × (x − p)|² dm less the moment, where |n × y|² = n·n y·y − (n·y)²."""
    n, second = k.direction, k.second_about_point
    return sp.Matrix([n.dot(n) * second.trace() - (n.T * second * n)[0] - x])


moment_of_inertia = Quantity(
    **_INERTIA,
    symbol=formula("I_n"),
    inputs=("point", "direction"),
    shape="scalar",
    definition=formula(r"\n^T\,\I'_P\,\n"),
    source=SOURCES["Goldstein 5.3"],
    value=lambda k: k.moment_about_line(),
    **_integrated((r"I_n = \int |\n\times(\x'-\p)|^2\,dm", _moment_by_mass)),
    reason="form_of_tensor",
    without=AT_REST,
)


def _characteristic(k: Any, moments: sp.Matrix) -> sp.Matrix | None:
    """The determinants of I′ − I_k 1; None if there are axes, which prove that they vanish."""
    if k.principal.axes is not None:
        return None
    return sp.Matrix([k.volume(k.body.inertia - moment * _ONE) for moment in moments])


principal_moments = Quantity(
    **_INERTIA,
    symbol=formula(r"\left(I_1, I_2, I_3\right)"),
    shape="vector",
    source=SOURCES["Landau 32"],
    value=lambda k: k.principal and k.principal.moments,
    laws=(law(r"\det(\I' - I_k\1) = 0", _characteristic),),
    without="no_closed_moments",
    words=lambda k: k.principal.because,
    is_result=True,
)

principal_axes = Quantity(
    symbol=formula(r"\E"),
    source=SOURCES["Landau 32"],
    value=lambda k: k.principal and k.principal.axes,
    laws=(
        law(
            r"\I'\,\E = \E\,\operatorname{diag}(I_1, I_2, I_3)",
            lambda k, x: k.body.inertia * x - x * sp.diag(*k.principal.moments),
        ),
        law(
            r"\E^T\E = \1,\ \det\E = 1",
            lambda k, x: (x.T * x - _ONE).col_join(sp.Matrix([[k.volume(x) - 1, 0, 0]])),
        ),
    ),
    without="no_closed_axes",
    reason="eigenvectors",
    section=OF_INERTIA,
)

inertia_tensor_space = Quantity(
    **_INERTIA,
    symbol=INERTIA_SPACE,
    inputs=("q",),
    definition=formula(r"\R\,\I'\,\R^T"),
    source=SOURCES["Goldstein 5.2"],
    value=lambda k: k.rotation @ (k.inertia @ k.rotation.T),
    laws=(
        law(r"\I' = \R^T\,\I\,\R", lambda k, x: k.rotation.T @ (x @ k.rotation) - k.inertia),
        law(
            r"\operatorname{tr} \I = \operatorname{tr} \I'",
            lambda k, x: k.scalar(k.trace(x - k.inertia)),
        ),
    ),
    reason="tensor_rotated",
    is_result=True,
    variants=(when("fixed_point", meaning="inertia_tensor_space_fixed_point"),),
)

INERTIA_QUANTITIES = by_name(globals())
BODY_ALONE = "body"  # asks for all that a body has without a rotation
OF_BODY_ALONE = INERTIA_QUANTITIES.keys() - {"inertia_tensor_space"}  # which depends on q
