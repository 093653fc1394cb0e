r"""The quantities of a rotation's kinematics, one entry each.

A law is a claim, and what vanishes if it holds for the value x. A workspace k works out a rotation
with its angular velocity: over the ring of a model (`kinematics.workspace`), for a turn before or
behind any rotation, or in the names of a chain of turns (`kinematics.chain`). Entries are the same
for all of them.

R takes components in the body to components in space. The passive presentation shows A = Rᵀ, the
direction cosine matrix, in its place.
"""

from __future__ import annotations

from typing import Any

from rigidsym.algebra.matrix import hat
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Formula, Rate
from rigidsym.mechanics.derivation import OF_RATES, Frame, Law, Quantity, by_name, law, when
from rigidsym.models.rotation import SOURCES

SPACE, BODY = (
    Frame(name, p, *map(formula, (rf"\Om{p}", rf"\W{p}", rf"\W{p}^{{-1}}", rf"\W{p}^{{+}}")))
    for name, p in (("space", ""), ("body", "'"))
)
ROTATION, COSINES, RATES = map(formula, (r"\R", r"\A", r"\dot\q"))
SPIN, SPIN_OF_COSINES = (formula(rf"\frac{{d\{m}}}{{dt}}\{m}^T") for m in "RA")
TENSOR, VECTORS = ("rows", "columns"), ("rows",)  # with `axes` that turn: P x Pᵀ and P x
PASSIVE, CHAIN, WIDE = "passive", "chain", "wide"  # traits: see `traits_of`

# The matrix that is shown, R or A, with its derivative


def _of_matrix(m: str) -> dict[str, Any]:
    is_orthogonal = law(rf"\{m}\{m}^T = \1", lambda k, x: x @ x.T - k.one)
    is_proper = law(rf"\det \{m} = 1", lambda k, x: k.scalar(x.det() - 1))
    return {"symbol": formula(rf"\{m}"), "laws": (is_orthogonal, is_proper), "axes": TENSOR}


def _of_derivative(m: str) -> dict[str, Any]:
    """R Rᵀ is constant."""
    claim = r"\frac{d\R}{dt}\R^T + \R\frac{d\R^T}{dt} = \0".replace("R", m)
    keeps_length = law(claim, lambda k, _: k.shown_spin + k.shown_spin.T)
    return {"symbol": formula(rf"\frac{{d\{m}}}{{dt}}"), "laws": (keeps_length,), "axes": TENSOR}


def _of_spin(symbol: Formula, value: str) -> dict[str, Any]:
    is_skew = law(r"#1 + \left(#1\right)^T = \0", lambda _, x: x + x.T, symbol)
    return {"symbol": symbol, "definition": formula(value), "laws": (is_skew,), "axes": TENSOR}


rotation_matrix = Quantity(
    **_of_matrix("R"),
    inputs=("q",),
    value=lambda k: k.rotation,
    vectors="rotation",
    reason="product_of_turns",
    section="rotation",
    is_result=True,
    variants=(
        when("one_turn", reason="single_turn"),
        when("given", reason="given_matrix"),
        when(
            PASSIVE,
            **_of_matrix("A"),
            value=lambda k: k.rotation.T,
            definition=formula(r"\R^T"),
            meaning="direction_cosines",
            reason="transposed_product",
        ),
        when(PASSIVE, "given", reason="transposed_matrix"),
        when(CHAIN, reason="turn_by_turn", recursion=r"\P_{LAST}, \quad \P_k = \P_{k-1}\,\T_k"),
        when(
            *(CHAIN, PASSIVE),
            reason="turn_by_turn_transposed",
            recursion=r"\P_{LAST}^T, \quad \P_k = \P_{k-1}\,\T_k",
        ),
    ),
)

_SPINNING: dict[str, Any] = {"inputs": ("q", "q_dot"), "section": "angular_velocity"}

rotation_rate = Quantity(
    **_SPINNING,
    **_of_derivative("R"),
    unit="1/s",
    value=lambda k: k.rotation_rate,
    reason="chain_rule",
    variants=(
        when(
            PASSIVE,
            **_of_derivative("A"),
            value=lambda k: k.rotation_rate.T,
            meaning="rate_of_direction_cosines",
        ),
        when(
            CHAIN,
            also=("angular_velocity_space",),
            reason="rate_from_angular_velocity",
            recursion=r"\C(\Om)\,\R",
        ),
        when(CHAIN, PASSIVE, recursion=r"\left(\C(\Om)\,\R\right)^T"),
    ),
)

_COSINES = _of_spin(SPIN_OF_COSINES, r"-\C(\Om')")
_COSINES["laws"] += (law(r"#1 = -\C(\Om')", lambda k, x: x + hat(k.omega_body), SPIN_OF_COSINES),)
spin_matrix = Quantity(
    **_SPINNING,
    **_of_spin(SPIN, r"\C(\Om)"),
    unit="rad/s",
    source=SOURCES["Murray 2.4"],
    value=lambda k: k.shown_spin,
    reason="skew_matrix",
    variants=(
        when(
            PASSIVE,
            **_COSINES,
            meaning="spin_of_direction_cosines",
            reason="skew_matrix_of_cosines",
        ),
        when(CHAIN, also=("angular_velocity_space",), reason="operator", recursion=r"\C(\Om)"),
        when(CHAIN, PASSIVE, also=(), reason="operator_of_cosines", recursion=r"-\C(\Om')"),
    ),
)

_VELOCITY = {**_SPINNING, "unit": "rad/s", "shape": "vector", "vectors": "velocity"}
_VELOCITY |= {"axes": VECTORS, "source": SOURCES["Murray 2.4"], "is_result": True}

angular_velocity_space = Quantity(
    **_VELOCITY,
    frame=SPACE,
    symbol=SPACE.omega,
    definition=formula(r"\C^{-1}(#1)", SPIN),
    value=lambda k: k.omega_space,
    laws=(law(r"#1 = \C(\Om)", lambda k, x: k.spin - hat(x), SPIN),),
    reason="entries_of_spin",
    variants=(
        when(
            PASSIVE,
            definition=formula(r"\C^{-1}(\frac{d\A^T}{dt}\,\A)"),
            reason="entries_of_spin_of_cosines",
        ),
        when(
            CHAIN,
            reason="later_turns",
            recursion=r"\u_1, \quad \u_k = \dot{\theta}_k\,\n_k + \T_k\,\u_{k+1}",
        ),
    ),
)

angular_velocity_body = Quantity(
    **_VELOCITY,
    frame=BODY,
    symbol=BODY.omega,
    definition=formula(r"\R^T\Om"),
    value=lambda k: k.omega_body,
    laws=(law(r"\Om = \R\,\Om'", lambda k, x: k.rotation @ x - k.omega_space),),
    reason="into_the_body",
    variants=(
        when(PASSIVE, definition=formula(r"\A\,\Om"), reason="into_the_body_by_cosines"),
        when(
            CHAIN,
            reason="earlier_turns",
            recursion=r"\w_{LAST}, \quad \w_k = \dot{\theta}_k\,\n_k + \T_k^T\,\w_{k-1}",
        ),
    ),
)

# The rates of the coordinates: in both frames the same, apart from reasons

_OF_RATES: dict[str, Any] = {"source": SOURCES["Diebel 5"], "section": OF_RATES}
_OF_CHAIN = when(CHAIN, without="too_many_turns")


def _rate_matrix(frame: Frame, *, of_chain: str, columns: str) -> Quantity:
    """W; `columns` are the axes of the turns of a chain."""
    name, symbols = frame.name, (frame.matrix, frame.omega)
    claim = formula(r"#1\dot\q = #2", *symbols)
    return Quantity(
        **_OF_RATES,
        frame=frame,
        symbol=frame.matrix,
        inputs=("q",),
        definition=formula(r"\frac{\partial #2}{\partial\dot\q}", *symbols),
        value=lambda k: k.rate_matrix(name),
        laws=(Law(claim, lambda k, x: x @ k.argument("q_dot") - k.omega(name)),),
        axes=VECTORS,
        vectors="rate_matrix",
        reason=f"coefficients_{name}",
        variants=(
            when("by_turns", reason=f"axes_of_turns_{name}"),
            when("one_coordinate", reason=f"axis_of_turn_{name}"),
            when(CHAIN, reason=of_chain),
            when(CHAIN, "in_order", recursion=columns),
        ),
    )


def _inverse_rate_matrix(frame: Frame, **reasons: str) -> Quantity:
    """W⁻¹, or W⁺ where there are more coordinates than dimensions."""
    name = frame.name

    def by(inverse: Formula) -> dict[str, Any]:
        claim = formula(r"#1 #2 = \1", frame.matrix, inverse)
        laws = (Law(claim, lambda k, x: k.excess(name, *x, k.one)),)
        return {"symbol": inverse, "laws": laws}

    return Quantity(
        **_OF_RATES,
        **by(frame.inverse),
        frame=frame,
        inputs=("q",),
        value=lambda k: k.inverse(name),
        axes=("columns",),
        vectors="inverse",
        reason=f"inverse_{name}",
        without="no_inverse",
        variants=(
            _OF_CHAIN,
            when(WIDE, **by(frame.right_inverse), meaning=f"right_inverse_{name}"),
            *(when(WIDE, trait, reason=reason) for trait, reason in reasons.items()),
        ),
    )


def _rates(frame: Frame) -> Quantity:
    """q̇ = W⁻¹ Ω, or W⁺ Ω."""
    name, omega = frame.name, frame.omega

    def by(inverse: Formula) -> dict[str, Any]:
        claim = formula(r"#1\,(#2 #3) = #3", frame.matrix, inverse, omega)
        laws = (Law(claim, lambda k, x: k.excess(name, *x, k.argument(f"omega_{name}"))),)
        return {"definition": formula("#1 #2", inverse, omega), "laws": laws}

    return Quantity(
        **_OF_RATES,
        **by(frame.inverse),
        frame=frame,
        symbol=RATES,
        unit="rad/s",
        unit_of="q_dot",
        inputs=("q", f"omega_{name}"),
        shape="vector",
        value=lambda k: k.rates(name),
        axes=(),  # numbers: only the components of Ω turn, which they are functions of
        vectors="rates",
        reason=f"rates_from_{name}",
        is_result=True,
        without="no_inverse",
        variants=(_OF_CHAIN, when(WIDE, **by(frame.right_inverse))),
    )


rate_matrix_space = _rate_matrix(
    SPACE,
    of_chain="columns_are_axes",
    columns=r"\begin{pmatrix} \n_1 & \P_1\,\n_2 & \ldots & \P_{BEFORE}\,\n_{LAST} \end{pmatrix}",
)
inverse_rate_matrix_space = _inverse_rate_matrix(
    SPACE, wide="least_rates", vector="constant_length", bound="rates_within_conditions"
)
rates_from_angular_velocity_space = _rates(SPACE)
rate_matrix_body = _rate_matrix(
    BODY,
    of_chain="axes_of_turns_body",
    columns=r"\begin{pmatrix} \B_2^T\,\n_1 & \ldots & \B_{LAST}^T\,\n_{BEFORE} & \n_{LAST} "
    r"\end{pmatrix}, \quad \B_k = \T_k\,\B_{k+1}",
)
inverse_rate_matrix_body = _inverse_rate_matrix(BODY, wide="right_inverse_body")
rates_from_angular_velocity_body = _rates(BODY)

_ACCELERATION: dict[str, Any] = {"unit": "rad/s^2", "inputs": ("q", "q_dot", "q_ddot")}
_ACCELERATION |= {"shape": "vector", "axes": VECTORS, "section": "angular_acceleration"}
_ACCELERATION |= {"source": SOURCES["Diebel 5"], "is_result": True}

angular_acceleration_space = Quantity(
    **_ACCELERATION,
    frame=SPACE,
    symbol=formula(r"\dot\Om"),
    definition=formula(r"\frac{d\Om}{dt}"),
    value=lambda k: k.alpha_space,
    laws=(law(r"#1 = \C(\dot\Om)", lambda k, x: k.spin_rate - hat(x), Rate(Bracket(SPIN))),),
    reason="derivative_of_velocity",
    variants=(
        when(
            CHAIN,
            also=("angular_velocity_space",),
            reason="derivative_of_recursion",
            recursion=r"\dot\u_1, \quad \dot\u_k = \ddot{\theta}_k\,\n_k + "
            r"\dot{\theta}_k\,\n_k\times\u_k + \T_k\,\dot\u_{k+1}",
        ),
    ),
)

angular_acceleration_body = Quantity(
    **_ACCELERATION,
    frame=BODY,
    symbol=formula(r"\dot\Om'"),
    definition=formula(r"\R^T\frac{d\Om}{dt}"),
    value=lambda k: k.alpha_body,
    laws=(law(r"\dot\Om = \R\,\dot\Om'", lambda k, x: k.rotation @ x - k.alpha_space),),
    reason="derivative_in_body",
    variants=(
        when(
            CHAIN,
            reason="derivative_of_recursion_body",
            recursion=r"\dot\w_{LAST}, \quad \dot\w_k = \ddot{\theta}_k\,\n_k - "
            r"\dot{\theta}_k\,\n_k\times\w_k + \T_k^T\,\dot\w_{k-1}",
        ),
    ),
)

KINEMATICS = by_name(globals())
