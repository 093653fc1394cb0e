"""The quantities of a mass distribution: a new one is an entry here and in `mass.derive`."""

from __future__ import annotations

from rigidsym.formula.reader import formula
from rigidsym.formula.tree import Bracket, Formula, transpose_of
from rigidsym.mechanics.quantities.kinematics import ROTATION
from rigidsym.mechanics.quantities.table import read_table

MASS = formula("M")
INERTIA = formula(r"\mathbf{I}'")
INERTIA_SPACE = formula(r"\mathbf{I}")
CENTRE = formula(r"\mathbf{c}")
POINT = formula(r"\mathbf{p}")
DIRECTION = formula(r"\mathbf{n}")
PLACE = formula(r"\mathbf{x}'")
ORIGIN_TENSOR = formula(r"\mathbf{I}'_O")
POINT_TENSOR = formula(r"\mathbf{I}'_P")
MOMENT = formula("I_n")
RADII = formula(r"\left(k_x, k_y, k_z\right)")
AXES = formula(r"\mathbf{E}")
MOMENTS = formula(r"\left(I_1, I_2, I_3\right)")
SEMI_AXES = formula(r"\left(a_1, a_2, a_3\right)")
_INTEGRALS = (
    r"\int\,dm",
    r"\frac{1}{M}\int \mathbf{x}'\,dm",
    r"\int \left(|\mathbf{x}'-\mathbf{c}|^2\,\mathbf{1} "
    r"- (\mathbf{x}'-\mathbf{c})(\mathbf{x}'-\mathbf{c})^{\mathsf T}\right)\,dm",
    r"\int (\mathbf{x}'-\mathbf{c})\,dm = \mathbf{0}",
    r"\mathbf{I}'_P = \int \left(|\mathbf{x}'-\mathbf{p}|^2\,\mathbf{1} "
    r"- (\mathbf{x}'-\mathbf{p})(\mathbf{x}'-\mathbf{p})^{\mathsf T}\right)\,dm",
    r"I_n = \int |\mathbf{n}\times(\mathbf{x}'-\mathbf{p})|^2\,dm",
)
TOTAL_MASS, MASS_FIRST, TENSOR_INTEGRAL, CENTRED, OF_POINT, OF_LINE = map(formula, _INTEGRALS)


def summed(integral: Formula) -> Formula:
    """One of these integrals over the mass as a sum over particles: Σ mᵢ xᵢ′ for ∫ x′ dm."""
    typed = next(typed for typed in _INTEGRALS if formula(typed) == integral)
    whole = typed.replace(r"\int", r"\sum_i m_i\,").replace(r"\,dm", "")
    return formula(whole.replace(r"\mathbf{x}'", r"\mathbf{x}'_i"))


# I′ + M (|d|² 1 − d dᵀ), the theorem of parallel axes
STEINER = r"#1 + #2\,(|#3|^2\,\mathbf{1} - #4 #4^{\mathsf T})"
_DISTANCE = formula(r"\mathbf{p}-\mathbf{c}")
_STEINER = formula(STEINER, INERTIA, MASS, _DISTANCE, Bracket(_DISTANCE))
_FORM = formula(r"#2\,#1\,#3", POINT_TENSOR, transpose_of(DIRECTION), DIRECTION)
_TURNED = formula(r"#1\,#2\,#3", ROTATION, INERTIA, transpose_of(ROTATION))

INERTIA_QUANTITIES = read_table(
    """
    mass                  scalar  kg               -                -
        mass
    centre_of_mass        vector  m                -                Landau 8
        centre of mass, in the axes of the description
    inertia_tensor        matrix  kg m^2           -                Landau 32
        inertia tensor about the centre of mass, body components
    inertia_tensor_point  matrix  kg m^2           point            Landau 32 (32.12)
        inertia tensor about a point p, body components
    moment_of_inertia     scalar  kg m^2           point direction  Goldstein 5.3
        moment of inertia about the line through p along n, a unit vector
    radii_of_gyration     vector  m                -                -
        radii of gyration about the axes through the centre of mass
    principal_moments     vector  kg m^2           -                Landau 32
        principal moments of inertia
    principal_axes        matrix  -                -                Landau 32
        principal axes as columns, right-handed, body components
    inertia_ellipsoid     vector  (kg m^2)^(-1/2)  -                -
        semi-axes of the inertia ellipsoid, along the principal axes
    inertia_tensor_space  matrix  kg m^2           q                Goldstein 5.2
        inertia tensor about the centre of mass, space components
    """,
    {
        "mass": (MASS, TOTAL_MASS),
        "centre_of_mass": (CENTRE, MASS_FIRST),
        "inertia_tensor": (INERTIA,),
        "inertia_tensor_point": (POINT_TENSOR, _STEINER),
        "moment_of_inertia": (MOMENT, _FORM),
        "radii_of_gyration": (RADII,),
        "principal_moments": (MOMENTS,),
        "principal_axes": (AXES,),
        "inertia_ellipsoid": (SEMI_AXES,),
        "inertia_tensor_space": (INERTIA_SPACE, _TURNED),
    },
)
BODY_ALONE = "body"  # asks for all that a body has without a rotation
OF_BODY_ALONE = INERTIA_QUANTITIES.keys() - {"inertia_tensor_space"}  # which depends on q

# Claims.

SYMMETRIC = formula("#1 = #2", INERTIA, transpose_of(INERTIA))
ABOUT_ORIGIN = formula(f"#5 = {STEINER}", INERTIA, MASS, CENTRE, CENTRE, ORIGIN_TENSOR)
OF_PARTS = formula(
    r"\mathbf{I}' = \sum_k \left(\mathbf{R}_k\mathbf{I}'_k\mathbf{R}_k^{\mathsf T} "
    r"+ m_k(|\mathbf{d}_k|^2\,\mathbf{1} - \mathbf{d}_k\mathbf{d}_k^{\mathsf T})"
    r"\right)"
)
OF_RADII = formula("M k_j^2 = I'_{jj}")
BACK = formula(r"#1 = #2\,#3\,#4", INERTIA, transpose_of(ROTATION), INERTIA_SPACE, ROTATION)
TRACE = formula(r"\operatorname{tr} #1 = \operatorname{tr} #2", INERTIA_SPACE, INERTIA)
DIAGONAL = formula(r"\mathbf{I}'\,\mathbf{E} = \mathbf{E}\,\operatorname{diag}(I_1, I_2, I_3)")
ORTHOGONAL_AXES = formula(r"\mathbf{E}^{\mathsf T}\mathbf{E} = \mathbf{1},\ \det\mathbf{E} = 1")
CHARACTERISTIC = formula(r"\det(\mathbf{I}' - I_k\mathbf{1}) = 0")
ELLIPSOID = formula(r"a_k^2\,I_k = 1")
