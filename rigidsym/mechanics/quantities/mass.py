"""The quantities of a mass distribution: a new one is an entry here and in `mass.derive`."""

from __future__ import annotations

from rigidsym.mechanics.claims import fill, transpose_of
from rigidsym.mechanics.derivation import Markup
from rigidsym.mechanics.quantities.kinematics import ROTATION
from rigidsym.mechanics.quantities.table import read_table
from rigidsym.models.rotation import Citation

STEINER = Citation(
    text="L. D. Landau and E. M. Lifshitz, Mechanics, 3rd edition (1976), section 32",
    equation="32.12",
)
MASS = Markup("M", "M")
INERTIA = Markup(r"\mathbf{I}'", "I′")
INERTIA_SPACE = Markup(r"\mathbf{I}", "I")
CENTRE = Markup(r"\mathbf{c}", "c")
POINT = Markup(r"\mathbf{p}", "p")
DIRECTION = Markup(r"\mathbf{n}", "n")
PLACE = Markup(r"\mathbf{x}'", "x′")
ORIGIN_TENSOR = Markup(r"\mathbf{I}'_O", "I′_O")
POINT_TENSOR = Markup(r"\mathbf{I}'_P", "I′_P")
MOMENT = Markup("I_n", "I_n")
RADII = Markup(r"\left(k_x, k_y, k_z\right)", "(k_x, k_y, k_z)")
AXES = Markup(r"\mathbf{E}", "E")
MOMENTS = Markup(r"\left(I_1, I_2, I_3\right)", "(I₁, I₂, I₃)")
SEMI_AXES = Markup(r"\left(a_1, a_2, a_3\right)", "(a₁, a₂, a₃)")
TOTAL_MASS = Markup(r"\int dm", "∫ dm")
MASS_FIRST = Markup(r"\frac{1}{M}\int \mathbf{x}'\,dm", "∫ x′ dm / M")
TENSOR_INTEGRAL = Markup(
    r"\int \left(|\mathbf{x}'-\mathbf{c}|^2\,\mathbf{1} - (\mathbf{x}'-\mathbf{c})"
    r"(\mathbf{x}'-\mathbf{c})^{\mathsf T}\right) dm",
    "∫ (|x′ − c|² 1 − (x′ − c)(x′ − c)ᵀ) dm",
)


def moved(mass: Markup, by: str, text: str) -> Markup:
    """M (|d|² 1 − d dᵀ)."""
    latex, plain = (by, text) if " " not in text else (f"({by})", f"({text})")
    return Markup(
        rf"{mass.latex}\left(|{by}|^2\,\mathbf{{1}} - {latex}{latex}^{{\mathsf T}}\right)",
        f"{mass.text} (|{text}|² 1 − {plain}{'' if ' ' in text else ' '}{plain}ᵀ)",
    )


_STEINER = fill("{0} + {1}", "{0} + {1}", INERTIA, moved(MASS, r"\mathbf{p}-\mathbf{c}", "p − c"))
_FORM = fill(r"{1}\,{0}\,{2}", "{1} {0} {2}", POINT_TENSOR, transpose_of(DIRECTION), DIRECTION)
_TURNED = fill(r"{0}\,{1}\,{2}", "{0} {1} {2}", ROTATION, INERTIA, transpose_of(ROTATION))

INERTIA_QUANTITIES = read_table(
    """
    mass                  scalar  kg               -                1.1
        mass
    centre_of_mass        vector  m                -                1.1 (1)
        centre of mass, in the axes of the description
    inertia_tensor        matrix  kg m^2           -                2.2 (4)
        inertia tensor about the centre of mass, body components
    inertia_tensor_point  matrix  kg m^2           point            Steiner
        inertia tensor about a point p, body components
    moment_of_inertia     scalar  kg m^2           point direction  2.2
        moment of inertia about the line through p along n, a unit vector
    radii_of_gyration     vector  m                -                -
        radii of gyration about the axes through the centre of mass
    principal_moments     vector  kg m^2           -                2.3 (10)
        principal moments of inertia
    principal_axes        matrix  -                -                2.3
        principal axes, one a column, right-handed, body components
    inertia_ellipsoid     vector  (kg m^2)^(-1/2)  -                -
        semi-axes of the inertia ellipsoid, along the principal axes
    inertia_tensor_space  matrix  kg m^2           q                2.1 (9)
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
    {"Steiner": STEINER},
)

# Claims.

SYMMETRIC = fill("{0} = {1}", "{0} = {1}", INERTIA, transpose_of(INERTIA))
CENTRED = Markup(r"\int (\mathbf{x}'-\mathbf{c})\,dm = \mathbf{0}", "∫ (x′ − c) dm = 0")
ABOUT_ORIGIN = fill(
    "{0} = {1} + {2}",
    "{0} = {1} + {2}",
    ORIGIN_TENSOR,
    INERTIA,
    moved(MASS, r"\mathbf{c}", "c"),
)
OF_PARTS = Markup(
    r"\mathbf{I}' = \sum_k \left(\mathbf{R}_k\mathbf{I}'_k\mathbf{R}_k^{\mathsf T} + "
    r"m_k(|\mathbf{d}_k|^2\,\mathbf{1} - \mathbf{d}_k\mathbf{d}_k^{\mathsf T})\right)",
    "I′ = Σ (Rₖ I′ₖ Rₖᵀ + mₖ (|dₖ|² 1 − dₖ dₖᵀ))",
)
OF_POINT = Markup(
    r"\mathbf{I}'_P = \int \left(|\mathbf{x}'-\mathbf{p}|^2\,\mathbf{1} - (\mathbf{x}'-\mathbf{p})"
    r"(\mathbf{x}'-\mathbf{p})^{\mathsf T}\right) dm",
    "I′_P = ∫ (|x′ − p|² 1 − (x′ − p)(x′ − p)ᵀ) dm",
)
OF_LINE = Markup(
    r"I_n = \int |\mathbf{n}\times(\mathbf{x}'-\mathbf{p})|^2\,dm",
    "I_n = ∫ |n × (x′ − p)|² dm",
)
OF_RADII = Markup(r"M k_j^2 = I'_{jj}", "M kⱼ² = I′ⱼⱼ")
BACK = fill(
    r"{0} = {1}\,{2}\,{3}",
    "{0} = {1} {2} {3}",
    INERTIA,
    transpose_of(ROTATION),
    INERTIA_SPACE,
    ROTATION,
)
TRACE = fill(
    r"\operatorname{{tr}} {0} = \operatorname{{tr}} {1}", "tr {0} = tr {1}", INERTIA_SPACE, INERTIA
)
DIAGONAL = Markup(
    r"\mathbf{I}'\,\mathbf{E} = \mathbf{E}\,\operatorname{diag}(I_1, I_2, I_3)",
    "I′ E = E diag(I₁, I₂, I₃)",
)
ORTHOGONAL_AXES = Markup(
    r"\mathbf{E}^{\mathsf T}\mathbf{E} = \mathbf{1},\ \det\mathbf{E} = 1", "Eᵀ E = 1, det E = 1"
)
CHARACTERISTIC = Markup(r"\det(\mathbf{I}' - I_k\mathbf{1}) = 0", "det(I′ − Iₖ 1) = 0")
ELLIPSOID = Markup(r"a_k^2\,I_k = 1", "aₖ² Iₖ = 1")
