r"""The quantities of a rotation's kinematics, one entry each.

A law is a claim, and what vanishes if it holds for the value x. A workspace k works out a rotation
with its angular velocity: over the ring of a model (`kinematics.workspace`), for a turn before or
behind any rotation, or in the names of a chain of turns (`kinematics.chain`). Entries are the same
for all of them.

R takes components in the body to components in space. The passive presentation shows A = Rᵀ, the
direction cosine matrix, in its place.
"""

from __future__ import annotations

from rigidsym.algebra.matrix import hat
from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Rate
from rigidsym.mechanics.derivation import OF_RATES, Frame, Law, Quantity, by_name, when
from rigidsym.models.rotation import SOURCES

SPACE = Frame(
    name="space",
    omega=formula(r"\boldsymbol{\Omega}"),
    matrix=formula(r"\mathbf{W}"),
    inverse=formula(r"\mathbf{W}^{-1}"),
    right_inverse=formula(r"\mathbf{W}^{+}"),
)
BODY = Frame(
    name="body",
    omega=formula(r"\boldsymbol{\Omega}'"),
    matrix=formula(r"\mathbf{W}'"),
    inverse=formula(r"\mathbf{W}'^{-1}"),
    right_inverse=formula(r"\mathbf{W}'^{+}"),
)
ROTATION = formula(r"\mathbf{R}")
COSINES = formula(r"\mathbf{A}")
SPIN = formula(r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T}")
SPIN_OF_COSINES = formula(r"\frac{d\mathbf{A}}{dt}\mathbf{A}^{\mathsf T}")
RATES = formula(r"\dot{\mathbf{q}}")
ALPHA = formula(r"\dot{\boldsymbol{\Omega}}")
ALPHA_BODY = formula(r"\dot{\boldsymbol{\Omega}}'")
# sections of the note
TURNED, ANGULAR_VELOCITY, ACCELERATION = "rotation", "angular_velocity", "angular_acceleration"
PASSIVE, CHAIN, WIDE = "passive", "chain", "wide"  # traits: see `Values.traits`

IS_SKEW = formula(r"#1 + \left(#1\right)^{\mathsf T} = \mathbf{0}", SPIN)
COSINES_ARE_SKEW = formula(r"#1 + \left(#1\right)^{\mathsf T} = \mathbf{0}", SPIN_OF_COSINES)
ORTHOGONAL = formula(r"\mathbf{R}\mathbf{R}^{\mathsf T} = \mathbf{1}")
COSINES_ARE_ORTHOGONAL = formula(r"\mathbf{A}\mathbf{A}^{\mathsf T} = \mathbf{1}")


rotation_matrix = Quantity(
    name="rotation_matrix",
    symbol=ROTATION,
    about="rotation matrix, body to space components",
    inputs=("q",),
    value=lambda k: k.shown,
    laws=(
        Law(ORTHOGONAL, lambda k, x: x.gram() - k.one),
        Law(formula(r"\det \mathbf{R} = 1"), lambda k, x: k.scalar(x.det() - 1)),
    ),
    vectors="matrix",
    reason="product_of_turns",
    section=TURNED,
    group="The rotation",
    is_result=True,
    variants=(
        when("one_turn", reason="single_turn"),
        when("given", reason="given_matrix"),
        when(
            PASSIVE,
            symbol=COSINES,
            definition=formula(r"\mathbf{R}^{\mathsf T}"),
            about="direction cosine matrix, space to body components",
            laws=(
                Law(COSINES_ARE_ORTHOGONAL, lambda k, x: x.gram() - k.one),
                Law(formula(r"\det \mathbf{A} = 1"), lambda k, x: k.scalar(x.det() - 1)),
            ),
            reason="transposed_product",
        ),
        when(PASSIVE, "given", reason="transposed_matrix"),
        when(
            CHAIN,
            reason="turn_by_turn",
            recursion=r"\mathbf{P}_{LAST}, \quad \mathbf{P}_k = \mathbf{P}_{k-1}\,\mathbf{T}_k",
        ),
        when(
            CHAIN,
            PASSIVE,
            reason="turn_by_turn_transposed",
            recursion=r"\mathbf{P}_{LAST}^{\mathsf T}, \quad "
            r"\mathbf{P}_k = \mathbf{P}_{k-1}\,\mathbf{T}_k",
        ),
    ),
)

rotation_rate = Quantity(
    name="rotation_rate",
    symbol=formula(r"\frac{d\mathbf{R}}{dt}"),
    about="time derivative of the rotation matrix",
    unit="1/s",
    inputs=("q", "q_dot"),
    value=lambda k: k.shown_rate,
    laws=(
        Law(
            formula(
                r"\frac{d\mathbf{R}}{dt}\mathbf{R}^{\mathsf T} "
                r"+ \mathbf{R}\frac{d\mathbf{R}^{\mathsf T}}{dt} = \mathbf{0}"
            ),
            lambda k, _: k.shown_spin + k.shown_spin.T,
        ),
    ),
    reason="chain_rule",
    section=ANGULAR_VELOCITY,
    variants=(
        when(
            PASSIVE,
            symbol=formula(r"\frac{d\mathbf{A}}{dt}"),
            about="time derivative of the direction cosine matrix",
            laws=(
                Law(
                    formula(
                        r"\frac{d\mathbf{A}}{dt}\mathbf{A}^{\mathsf T} "
                        r"+ \mathbf{A}\frac{d\mathbf{A}^{\mathsf T}}{dt} = \mathbf{0}"
                    ),
                    lambda k, _: k.shown_spin + k.shown_spin.T,
                ),
            ),
        ),
        when(
            CHAIN,
            also=("angular_velocity_space",),
            reason="rate_from_angular_velocity",
            recursion=r"\mathbf{C}(\boldsymbol{\Omega})\,\mathbf{R}",
        ),
        when(
            CHAIN,
            PASSIVE,
            recursion=r"\left(\mathbf{C}(\boldsymbol{\Omega})\,\mathbf{R}\right)^{\mathsf T}",
        ),
    ),
)

spin_matrix = Quantity(
    name="spin_matrix",
    symbol=SPIN,
    about="spin matrix, the operator Ω × in space components",
    unit="rad/s",
    inputs=("q", "q_dot"),
    definition=formula(r"\mathbf{C}(\boldsymbol{\Omega})"),
    source=SOURCES["Murray 2.4"],
    value=lambda k: k.shown_spin,
    laws=(Law(IS_SKEW, lambda _, x: x + x.T),),
    reason="skew_matrix",
    section=ANGULAR_VELOCITY,
    variants=(
        when(
            PASSIVE,
            symbol=SPIN_OF_COSINES,
            about="spin matrix of the direction cosines, the operator −Ω′ × in body components",
            definition=formula(r"-\mathbf{C}(\boldsymbol{\Omega}')"),
            laws=(
                Law(COSINES_ARE_SKEW, lambda _, x: x + x.T),
                Law(
                    formula(r"#1 = -\mathbf{C}(\boldsymbol{\Omega}')", SPIN_OF_COSINES),
                    lambda k, x: x + hat(k.omega_body),
                ),
            ),
            reason="skew_matrix_of_cosines",
        ),
        when(
            CHAIN,
            also=("angular_velocity_space",),
            reason="operator",
            recursion=r"\mathbf{C}(\boldsymbol{\Omega})",
        ),
        when(
            CHAIN,
            PASSIVE,
            also=(),
            reason="operator_of_cosines",
            recursion=r"-\mathbf{C}(\boldsymbol{\Omega}')",
        ),
    ),
)

angular_velocity_space = Quantity(
    name="angular_velocity_space",
    frame=SPACE,
    symbol=SPACE.omega,
    about="angular velocity, space components",
    unit="rad/s",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{C}^{-1}(#1)", SPIN),
    source=SOURCES["Murray 2.4"],
    value=lambda k: k.omega_space,
    laws=(
        Law(formula(r"#1 = \mathbf{C}(\boldsymbol{\Omega})", SPIN), lambda k, x: k.spin - hat(x)),
    ),
    vectors="vector",
    reason="entries_of_spin",
    section=ANGULAR_VELOCITY,
    group="The angular velocity",
    is_result=True,
    variants=(
        when(
            PASSIVE,
            definition=formula(r"\mathbf{C}^{-1}(\frac{d\mathbf{A}^{\mathsf T}}{dt}\,\mathbf{A})"),
            reason="entries_of_spin_of_cosines",
        ),
        when(
            CHAIN,
            reason="later_turns",
            recursion=r"\mathbf{u}_1, \quad "
            r"\mathbf{u}_k = \dot{\theta}_k\,\mathbf{n}_k + \mathbf{T}_k\,\mathbf{u}_{k+1}",
        ),
    ),
)

angular_velocity_body = Quantity(
    name="angular_velocity_body",
    frame=BODY,
    symbol=BODY.omega,
    about="angular velocity, body components",
    unit="rad/s",
    inputs=("q", "q_dot"),
    shape="vector",
    definition=formula(r"\mathbf{R}^{\mathsf T}\boldsymbol{\Omega}"),
    source=SOURCES["Murray 2.4"],
    value=lambda k: k.omega_body,
    laws=(
        Law(
            formula(r"\boldsymbol{\Omega} = \mathbf{R}\,\boldsymbol{\Omega}'"),
            lambda k, x: k.rotation @ x - k.omega_space,
        ),
    ),
    vectors="vector",
    reason="into_the_body",
    section=ANGULAR_VELOCITY,
    group="The angular velocity",
    is_result=True,
    variants=(
        when(
            PASSIVE,
            definition=formula(r"\mathbf{A}\,\boldsymbol{\Omega}"),
            reason="into_the_body_by_cosines",
        ),
        when(
            CHAIN,
            reason="earlier_turns",
            recursion=r"\mathbf{w}_{LAST}, \quad \mathbf{w}_k = \dot{\theta}_k\,\mathbf{n}_k + "
            r"\mathbf{T}_k^{\mathsf T}\,\mathbf{w}_{k-1}",
        ),
    ),
)

rate_matrix_space = Quantity(
    name="rate_matrix_space",
    frame=SPACE,
    symbol=SPACE.matrix,
    about="rate matrix to space components of the angular velocity",
    inputs=("q",),
    definition=formula(r"\frac{\partial \boldsymbol{\Omega}}{\partial \dot{\mathbf{q}}}"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.rate_matrix("space"),
    laws=(
        Law(
            formula(r"\mathbf{W}\dot{\mathbf{q}} = \boldsymbol{\Omega}"),
            lambda k, x: x @ k.argument("q_dot") - k.omega_space,
        ),
    ),
    vectors="matrix",
    reason="coefficients",
    section=OF_RATES,
    group="The rate matrices",
    variants=(
        when("by_turns", reason="axes_of_turns"),
        when("one_coordinate", reason="axis_of_turn"),
        when(CHAIN, reason="columns_are_axes"),
        when(
            CHAIN,
            "in_order",
            recursion=r"\begin{pmatrix} \mathbf{n}_1 & \mathbf{P}_1\,\mathbf{n}_2 & \ldots & "
            r"\mathbf{P}_{BEFORE}\,\mathbf{n}_{LAST} \end{pmatrix}",
        ),
    ),
)

inverse_rate_matrix_space = Quantity(
    name="inverse_rate_matrix_space",
    frame=SPACE,
    symbol=SPACE.inverse,
    about="inverse rate matrix from space components",
    inputs=("q",),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.inverse("space"),
    laws=(
        Law(
            formula(r"\mathbf{W}\mathbf{W}^{-1} = \mathbf{1}"),
            lambda k, x: k.excess("space", *x, k.one),
            is_of_inverse=True,
        ),
    ),
    vectors="matrix",
    reason="inverse",
    section=OF_RATES,
    group="Their inverses",
    variants=(
        when(
            WIDE,
            symbol=SPACE.right_inverse,
            about="right inverse of the rate matrix from space components",
            laws=(
                Law(
                    formula(r"\mathbf{W}\mathbf{W}^{+} = \mathbf{1}"),
                    lambda k, x: k.excess("space", *x, k.one),
                    is_of_inverse=True,
                ),
            ),
            reason="least_rates",
        ),
        when(WIDE, "vector", reason="constant_length"),
        when(WIDE, "bound", reason="rates_within_conditions"),
        when(
            CHAIN,
            reason="least_norm",
            recursion=r"\mathbf{W}^{\mathsf T}"
            r"\left(\mathbf{W}\,\mathbf{W}^{\mathsf T}\right)^{-1}",
        ),
    ),
)

rates_from_angular_velocity_space = Quantity(
    name="rates_from_angular_velocity_space",
    frame=SPACE,
    symbol=RATES,
    about="rates of the coordinates from space components of the angular velocity",
    unit="rad/s",
    unit_of="q_dot",
    inputs=("q", "omega_space"),
    shape="vector",
    definition=formula(r"\mathbf{W}^{-1}\boldsymbol{\Omega}"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.rates("space"),
    laws=(
        Law(
            formula(r"\mathbf{W}\,(\mathbf{W}^{-1}\boldsymbol{\Omega}) = \boldsymbol{\Omega}"),
            lambda k, x: k.excess("space", *x, k.argument("omega_space")),
            is_of_inverse=True,
        ),
    ),
    vectors="rates",
    reason="rates_from_space",
    section=OF_RATES,
    group="The rates of the coordinates",
    is_result=True,
    variants=(
        when(
            WIDE,
            definition=formula(r"\mathbf{W}^{+}\boldsymbol{\Omega}"),
            laws=(
                Law(
                    formula(
                        r"\mathbf{W}\,(\mathbf{W}^{+}\boldsymbol{\Omega}) = \boldsymbol{\Omega}"
                    ),
                    lambda k, x: k.excess("space", *x, k.argument("omega_space")),
                    is_of_inverse=True,
                ),
            ),
        ),
        when(CHAIN, recursion=r"\mathbf{W}^{-1}\,\boldsymbol{\Omega}"),
        when(CHAIN, WIDE, recursion=r"\mathbf{W}^{+}\,\boldsymbol{\Omega}"),
    ),
)

rate_matrix_body = Quantity(
    name="rate_matrix_body",
    frame=BODY,
    symbol=BODY.matrix,
    about="rate matrix to body components of the angular velocity",
    inputs=("q",),
    definition=formula(r"\frac{\partial \boldsymbol{\Omega}'}{\partial \dot{\mathbf{q}}}"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.rate_matrix("body"),
    laws=(
        Law(
            formula(r"\mathbf{W}'\dot{\mathbf{q}} = \boldsymbol{\Omega}'"),
            lambda k, x: x @ k.argument("q_dot") - k.omega_body,
        ),
    ),
    vectors="matrix",
    reason="coefficients_body",
    section=OF_RATES,
    group="The rate matrices",
    variants=(
        when("by_turns", reason="axes_of_turns_body"),
        when("one_coordinate", reason="axis_of_turn_body"),
        when(CHAIN, reason="axes_of_turns_body"),
        when(
            CHAIN,
            "in_order",
            recursion=r"\begin{pmatrix} \mathbf{B}_2^{\mathsf T}\,\mathbf{n}_1 & \ldots & "
            r"\mathbf{B}_{LAST}^{\mathsf T}\,\mathbf{n}_{BEFORE} & \mathbf{n}_{LAST} "
            r"\end{pmatrix}, \quad \mathbf{B}_k = \mathbf{T}_k\,\mathbf{B}_{k+1}",
        ),
    ),
)

inverse_rate_matrix_body = Quantity(
    name="inverse_rate_matrix_body",
    frame=BODY,
    symbol=BODY.inverse,
    about="inverse rate matrix from body components",
    inputs=("q",),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.inverse("body"),
    laws=(
        Law(
            formula(r"\mathbf{W}'\mathbf{W}'^{-1} = \mathbf{1}"),
            lambda k, x: k.excess("body", *x, k.one),
            is_of_inverse=True,
        ),
    ),
    vectors="matrix",
    reason="inverse_body",
    section=OF_RATES,
    group="Their inverses",
    variants=(
        when(
            WIDE,
            symbol=BODY.right_inverse,
            about="right inverse of the rate matrix from body components",
            laws=(
                Law(
                    formula(r"\mathbf{W}'\mathbf{W}'^{+} = \mathbf{1}"),
                    lambda k, x: k.excess("body", *x, k.one),
                    is_of_inverse=True,
                ),
            ),
            reason="right_inverse_body",
        ),
        when(
            CHAIN,
            reason="right_inverse_body",
            recursion=r"\mathbf{W}'^{\mathsf T}"
            r"\left(\mathbf{W}'\,\mathbf{W}'^{\mathsf T}\right)^{-1}",
        ),
    ),
)

rates_from_angular_velocity_body = Quantity(
    name="rates_from_angular_velocity_body",
    frame=BODY,
    symbol=RATES,
    about="rates of the coordinates from body components of the angular velocity",
    unit="rad/s",
    unit_of="q_dot",
    inputs=("q", "omega_body"),
    shape="vector",
    definition=formula(r"\mathbf{W}'^{-1}\boldsymbol{\Omega}'"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.rates("body"),
    laws=(
        Law(
            formula(r"\mathbf{W}'\,(\mathbf{W}'^{-1}\boldsymbol{\Omega}') = \boldsymbol{\Omega}'"),
            lambda k, x: k.excess("body", *x, k.argument("omega_body")),
            is_of_inverse=True,
        ),
    ),
    vectors="rates",
    reason="rates_from_body",
    section=OF_RATES,
    group="The rates of the coordinates",
    is_result=True,
    variants=(
        when(
            WIDE,
            definition=formula(r"\mathbf{W}'^{+}\boldsymbol{\Omega}'"),
            laws=(
                Law(
                    formula(
                        r"\mathbf{W}'\,(\mathbf{W}'^{+}\boldsymbol{\Omega}') = "
                        r"\boldsymbol{\Omega}'"
                    ),
                    lambda k, x: k.excess("body", *x, k.argument("omega_body")),
                    is_of_inverse=True,
                ),
            ),
        ),
        when(CHAIN, recursion=r"\mathbf{W}'^{-1}\,\boldsymbol{\Omega}'"),
        when(CHAIN, WIDE, recursion=r"\mathbf{W}'^{+}\,\boldsymbol{\Omega}'"),
    ),
)

angular_acceleration_space = Quantity(
    name="angular_acceleration_space",
    frame=SPACE,
    symbol=ALPHA,
    about="angular acceleration, space components",
    unit="rad/s^2",
    inputs=("q", "q_dot", "q_ddot"),
    shape="vector",
    definition=formula(r"\frac{d\boldsymbol{\Omega}}{dt}"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.alpha_space,
    laws=(
        Law(
            formula(r"#1 = \mathbf{C}(\dot{\boldsymbol{\Omega}})", Rate(Bracket(SPIN))),
            lambda k, x: k.spin_rate - hat(x),
        ),
    ),
    reason="derivative_of_velocity",
    section=ACCELERATION,
    group="The angular acceleration",
    is_result=True,
    variants=(
        when(
            CHAIN,
            also=("angular_velocity_space",),
            reason="derivative_of_recursion",
            recursion=r"\dot{\mathbf{u}}_1, \quad \dot{\mathbf{u}}_k = "
            r"\ddot{\theta}_k\,\mathbf{n}_k + \dot{\theta}_k\,\mathbf{n}_k\times\mathbf{u}_k + "
            r"\mathbf{T}_k\,\dot{\mathbf{u}}_{k+1}",
        ),
    ),
)

angular_acceleration_body = Quantity(
    name="angular_acceleration_body",
    frame=BODY,
    symbol=ALPHA_BODY,
    about="angular acceleration, body components",
    unit="rad/s^2",
    inputs=("q", "q_dot", "q_ddot"),
    shape="vector",
    definition=formula(r"\mathbf{R}^{\mathsf T}\frac{d\boldsymbol{\Omega}}{dt}"),
    source=SOURCES["Diebel 5"],
    value=lambda k: k.alpha_body,
    laws=(
        Law(
            formula(r"\dot{\boldsymbol{\Omega}} = \mathbf{R}\,\dot{\boldsymbol{\Omega}}'"),
            lambda k, x: k.rotation @ x - k.alpha_space,
        ),
    ),
    reason="derivative_in_body",
    section=ACCELERATION,
    group="The angular acceleration",
    is_result=True,
    variants=(
        when(
            CHAIN,
            reason="derivative_of_recursion_body",
            recursion=r"\dot{\mathbf{w}}_{LAST}, \quad \dot{\mathbf{w}}_k = "
            r"\ddot{\theta}_k\,\mathbf{n}_k - \dot{\theta}_k\,\mathbf{n}_k\times\mathbf{w}_k + "
            r"\mathbf{T}_k^{\mathsf T}\,\dot{\mathbf{w}}_{k-1}",
        ),
    ),
)

KINEMATICS = by_name(globals())
