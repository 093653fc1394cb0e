r"""The quantities of a mass distribution, one entry each.

A workspace k (`mechanics.body`) has the body, and the moments of its mass distribution: ∫ dm,
∫ x′ dm and ∫ x′x′ᵀ dm. For particles the integrals are sums.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.derivation import Law, Quantity, by_name, when
from rigidsym.models.rotation import SOURCES

MASS = formula("M")
INERTIA = formula(r"\mathbf{I}'")
INERTIA_SPACE = formula(r"\mathbf{I}")
PLACE = formula(r"\mathbf{x}'")
POINT = formula(r"\mathbf{p}")
DIRECTION = formula(r"\mathbf{n}")
# I′ + M (|d|² 1 − d dᵀ), the theorem of parallel axes
STEINER = r"#1 + #2\,(|#3|^2\,\mathbf{1} - #4 #4^{\mathsf T})"
_ONE = sp.eye(3)
OF_BODY, OF_INERTIA = "body", "inertia"  # sections of the note


def _of_particles(integral: str) -> Formula:
    """An integral over the mass as a sum over particles: Σ mᵢ xᵢ′ for ∫ x′ dm."""
    whole = integral.replace(r"\int", r"\sum_i m_i\,").replace(r"\,dm", "")
    return formula(whole.replace(r"\mathbf{x}'", r"\mathbf{x}'_i"))


_TOTAL = r"\int\,dm"
_MEAN = r"\frac{1}{M}\int \mathbf{x}'\,dm"
_CENTRED = r"\int (\mathbf{x}'-\mathbf{c})\,dm = \mathbf{0}"
_TENSOR = (
    r"\int \left(|\mathbf{x}'-\mathbf{c}|^2\,\mathbf{1} "
    r"- (\mathbf{x}'-\mathbf{c})(\mathbf{x}'-\mathbf{c})^{\mathsf T}\right)\,dm"
)
_ABOUT_POINT = (
    r"\mathbf{I}'_P = \int \left(|\mathbf{x}'-\mathbf{p}|^2\,\mathbf{1} "
    r"- (\mathbf{x}'-\mathbf{p})(\mathbf{x}'-\mathbf{p})^{\mathsf T}\right)\,dm"
)
_ABOUT_LINE = r"I_n = \int |\mathbf{n}\times(\mathbf{x}'-\mathbf{p})|^2\,dm"


mass = Quantity(
    name="mass",
    symbol=MASS,
    about="mass",
    unit="kg",
    shape="scalar",
    definition=formula(_TOTAL),
    value=lambda k: k.body.mass if k.is_distributed and not k.body.mass.is_Symbol else None,
    rests_on=lambda k: k.moments.proofs,
    without="it is given, not added up",
    reason="sum_of_parts",
    section=OF_BODY,
    is_result=True,
    variants=(when("particles", definition=_of_particles(_TOTAL)),),
)

centre_of_mass = Quantity(
    name="centre_of_mass",
    symbol=formula(r"\mathbf{c}"),
    about="centre of mass, in the axes of the description",
    unit="m",
    shape="vector",
    definition=formula(_MEAN),
    source=SOURCES["Landau 8"],
    value=lambda k: k.body.centre if k.is_distributed else None,
    rests_on=lambda k: k.moments.proofs if k.body.mass.is_Symbol else (),
    laws=(Law(formula(_CENTRED), lambda k, x: k.moments.first - k.body.mass * x),),
    without="how its mass is distributed is not given",
    reason="mean_position",
    section=OF_BODY,
    is_result=True,
    variants=(
        when(
            "particles",
            definition=_of_particles(_MEAN),
            laws=(
                Law(
                    _of_particles(_CENTRED),
                    lambda k, x: k.moments.first - k.body.mass * x,
                ),
            ),
        ),
    ),
)

_SYMMETRIC = Law(formula(r"\mathbf{I}' = \mathbf{I}'^{\mathsf T}"), lambda _, x: x - x.T)
_ABOUT_ORIGIN = Law(
    formula(rf"\mathbf{{I}}'_O = {STEINER}", INERTIA, MASS, *(formula(r"\mathbf{c}"),) * 2),
    lambda k, x: (
        k.moments.second.trace() * _ONE
        - k.moments.second
        - x
        - k.steiner(k.body.mass, k.body.centre)
    ),
)
_OF_PARTS = Law(
    formula(
        r"\mathbf{I}' = \sum_k \left(\mathbf{R}_k\mathbf{I}'_k\mathbf{R}_k^{\mathsf T} "
        r"+ m_k(|\mathbf{d}_k|^2\,\mathbf{1} - \mathbf{d}_k\mathbf{d}_k^{\mathsf T})"
        r"\right)"
    ),
    lambda k, x: k.inertia_of_parts() - x,
)

inertia_tensor = Quantity(
    name="inertia_tensor",
    symbol=INERTIA,
    about="inertia tensor about the centre of mass, body components",
    unit="kg m^2",
    source=SOURCES["Landau 32"],
    value=lambda k: k.body.inertia,
    laws=(_SYMMETRIC,),
    reason="given_tensor",
    section=OF_BODY,
    is_result=True,
    variants=(
        when(
            "distributed",
            definition=formula(_TENSOR),
            laws=(_SYMMETRIC, _ABOUT_ORIGIN),
            reason="tensor_about_centre",
        ),
        when("particles", definition=_of_particles(_TENSOR)),
        when("composite", laws=(_SYMMETRIC, _ABOUT_ORIGIN, _OF_PARTS), reason="tensors_of_parts"),
        when(
            "fixed_point",
            about="inertia tensor about the fixed point, body components",
            reason="given_tensor_about_fixed_point",
        ),
    ),
)

inertia_tensor_point = Quantity(
    name="inertia_tensor_point",
    symbol=formula(r"\mathbf{I}'_P"),
    about="inertia tensor about a point p, body components",
    unit="kg m^2",
    inputs=("point",),
    definition=formula(
        r"\mathbf{I}' + M\,(|\mathbf{p}-\mathbf{c}|^2\,\mathbf{1} "
        r"- (\mathbf{p}-\mathbf{c})(\mathbf{p}-\mathbf{c})^{\mathsf T})"
    ),
    source=SOURCES["Landau 32 (32.12)"],
    value=lambda k: k.shifted_inertia(),
    laws=(
        Law(
            formula(_ABOUT_POINT),
            lambda k, x: k.second_about_point.trace() * _ONE - k.second_about_point - x,
        ),
    ),
    reason="parallel_axes",
    section=OF_INERTIA,
    of_centre=True,
    variants=(
        when(
            "particles",
            laws=(
                Law(
                    _of_particles(_ABOUT_POINT),
                    lambda k, x: k.second_about_point.trace() * _ONE - k.second_about_point - x,
                ),
            ),
        ),
    ),
)


def _moment_by_mass(k: Any, x: sp.Expr) -> sp.Matrix:
    """∫ |n × (x − p)|² dm less the moment, where |n × y|² = n·n y·y − (n·y)²."""
    n, second = k.direction, k.second_about_point
    return sp.Matrix([n.dot(n) * second.trace() - (n.T * second * n)[0] - x])


moment_of_inertia = Quantity(
    name="moment_of_inertia",
    symbol=formula("I_n"),
    about="moment of inertia about the line through p along n, a unit vector",
    unit="kg m^2",
    inputs=("point", "direction"),
    shape="scalar",
    definition=formula(r"\mathbf{n}^{\mathsf T}\,\mathbf{I}'_P\,\mathbf{n}"),
    source=SOURCES["Goldstein 5.3"],
    value=lambda k: k.moment_about_line(),
    laws=(Law(formula(_ABOUT_LINE), _moment_by_mass),),
    reason="form_of_tensor",
    section=OF_INERTIA,
    of_centre=True,
    variants=(when("particles", laws=(Law(_of_particles(_ABOUT_LINE), _moment_by_mass),)),),
)

radii_of_gyration = Quantity(
    name="radii_of_gyration",
    symbol=formula(r"\left(k_x, k_y, k_z\right)"),
    about="radii of gyration about the axes through the centre of mass",
    unit="m",
    shape="vector",
    value=lambda k: k.radii,
    laws=(
        Law(
            formula("M k_j^2 = I'_{jj}"),
            lambda k, x: k.body.mass * x.applyfunc(lambda radius: radius**2) - k.diagonal,
        ),
    ),
    reason="root_of_moment",
    section=OF_INERTIA,
    of_centre=True,
)

principal_moments = Quantity(
    name="principal_moments",
    symbol=formula(r"\left(I_1, I_2, I_3\right)"),
    about="principal moments of inertia",
    unit="kg m^2",
    shape="vector",
    source=SOURCES["Landau 32"],
    value=lambda k: k.principal and k.principal.moments,
    laws=(
        Law(
            formula(r"\det(\mathbf{I}' - I_k\mathbf{1}) = 0"),
            # the axes, if there are any, prove it
            lambda k, x: (
                sp.Matrix([k.volume(k.body.inertia - m * _ONE) for m in x])
                if k.principal.axes is None
                else None
            ),
        ),
    ),
    without="no closed form was found, which a general tensor has not",
    words=lambda k: k.principal.because,
    section=OF_INERTIA,
    is_result=True,
)

principal_axes = Quantity(
    name="principal_axes",
    symbol=formula(r"\mathbf{E}"),
    about="principal axes as columns, right-handed, body components",
    source=SOURCES["Landau 32"],
    value=lambda k: k.principal and k.principal.axes,
    laws=(
        Law(
            formula(r"\mathbf{I}'\,\mathbf{E} = \mathbf{E}\,\operatorname{diag}(I_1, I_2, I_3)"),
            lambda k, x: k.body.inertia * x - x * sp.diag(*k.principal.moments),
        ),
        Law(
            formula(r"\mathbf{E}^{\mathsf T}\mathbf{E} = \mathbf{1},\ \det\mathbf{E} = 1"),
            lambda k, x: (x.T * x - _ONE).col_join(sp.Matrix([[k.volume(x) - 1, 0, 0]])),
        ),
    ),
    without="no closed form was found, or none that is short enough for use",
    reason="eigenvectors",
    section=OF_INERTIA,
)

inertia_ellipsoid = Quantity(
    name="inertia_ellipsoid",
    symbol=formula(r"\left(a_1, a_2, a_3\right)"),
    about="semi-axes of the inertia ellipsoid, along the principal axes",
    unit="(kg m^2)^(-1/2)",
    shape="vector",
    value=lambda k: k.semi_axes,
    laws=(
        Law(
            formula(r"a_k^2\,I_k = 1"),
            lambda k, x: sp.Matrix(
                [a**2 * m - 1 for a, m in zip(x, k.principal.moments, strict=True)]
            ),
        ),
    ),
    without="no principal moments were found, or one of them is 0",
    reason="ellipsoid",
    section=OF_INERTIA,
)

inertia_tensor_space = Quantity(
    name="inertia_tensor_space",
    symbol=INERTIA_SPACE,
    about="inertia tensor about the centre of mass, space components",
    unit="kg m^2",
    inputs=("q",),
    definition=formula(r"\mathbf{R}\,\mathbf{I}'\,\mathbf{R}^{\mathsf T}"),
    source=SOURCES["Goldstein 5.2"],
    value=lambda k: k.inertia_space,
    laws=(
        Law(
            formula(r"\mathbf{I}' = \mathbf{R}^{\mathsf T}\,\mathbf{I}\,\mathbf{R}"),
            lambda k, x: k.rotation.T @ (x @ k.rotation) - k.inertia,
        ),
        Law(
            formula(r"\operatorname{tr} \mathbf{I} = \operatorname{tr} \mathbf{I}'"),
            lambda k, x: k.scalar(k.trace(x - k.inertia)),
        ),
    ),
    reason="tensor_rotated",
    section=OF_INERTIA,
    is_result=True,
    variants=(when("fixed_point", about="inertia tensor about the fixed point, space components"),),
)

INERTIA_QUANTITIES = by_name(globals())
BODY_ALONE = "body"  # asks for all that a body has without a rotation
OF_BODY_ALONE = INERTIA_QUANTITIES.keys() - {"inertia_tensor_space"}  # which depends on q
