"""The lecture's equations 1 to 16 as it states them, and a reader of them.

A block is one statement: its number, its name, its section; how it follows, with formulas between
dollar signs; the sides of the equation, one a line behind `=`; and the claims to be proved, each
behind its name. `^T` is the transpose. What is `summands` shows the matrix of the generic particle.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from rigidsym.formula.reader import formula, sentence
from rigidsym.mechanics.derivation import Statement
from rigidsym.models.rotation import lecture

_ITEM = re.compile(r"\n    (?=(?:=|\w+:) )(\S+) ")  # "=" or the name of a claim

_EQUATIONS = r"""
# The centre of mass and the kinetic energy
1  centre_of_mass  1.1
    A rigid body consists of particles with masses $m_i$ at positions $\mathbf{r}_i$; its total
    mass is $\sum_i m_i = M$. The mean of the positions, weighted by the masses, is the centre of
    mass
    = \mathbf{r}_C
    = \frac{1}{M}\sum_i m_i\,\mathbf{r}_i
    no_moment: \sum_i m_i(\mathbf{r}_i - \mathbf{r}_C) = \mathbf{0}
    no_momentum: \sum_i m_i(\dot{\mathbf{r}}_i - \dot{\mathbf{r}}_C) = \mathbf{0}

-  energy_expanded  1.1
    Let $\mathbf{x}_i$ be the vector from the centre of mass to a particle, so that
    $\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i$. The kinetic energy of the body is
    = E_K = \frac{1}{2}\sum_i m_i|\dot{\mathbf{r}}_i|^2
    = \frac{1}{2}\sum_i m_i|\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i|^2
    = \frac{1}{2}\sum_i m_i\bigl(|\dot{\mathbf{r}}_C|^2 +
      2\dot{\mathbf{x}}_i\cdot\dot{\mathbf{r}}_C + |\dot{\mathbf{x}}_i|^2\bigr)
    = \frac{1}{2}M|\dot{\mathbf{r}}_C|^2 + \dot{\mathbf{r}}_C\cdot\sum_i m_i\,\dot{\mathbf{x}}_i +
      \frac{1}{2}\sum_i m_i|\dot{\mathbf{x}}_i|^2
    squares: |\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i|^2 = |\dot{\mathbf{r}}_C|^2 +
      2\dot{\mathbf{x}}_i\cdot\dot{\mathbf{r}}_C + |\dot{\mathbf{x}}_i|^2
    mass_outside: \sum_i m_i|\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i|^2 = M|\dot{\mathbf{r}}_C|^2 +
      2\dot{\mathbf{r}}_C\cdot\sum_i m_i\,\dot{\mathbf{x}}_i + \sum_i m_i|\dot{\mathbf{x}}_i|^2

2  energy_splits  1.1
    By (1) $\sum_i m_i\,\mathbf{x}_i = \mathbf{0}$ at all times, so that
    $\sum_i m_i\,\dot{\mathbf{x}}_i = \mathbf{0}$ and the cross term vanishes. The energy splits
    into the energy of the total mass moving with the centre of mass and the energy of the motion
    about it,
    = E_K
    = E_C + E_R
    = \frac{1}{2}M|\dot{\mathbf{r}}_C|^2 + \frac{1}{2}\sum_i m_i|\dot{\mathbf{x}}_i|^2
    no_mixed_energy: \sum_i m_i\,\dot{\mathbf{x}}_i\cdot\dot{\mathbf{r}}_C = 0
    energy_splits: \frac{1}{2}\sum_i m_i|\dot{\mathbf{r}}_i|^2 = E_C + E_R

# The inertia tensor
3  velocity_of_particles  1.2
    The distances between the particles do not change, so that by Euler's theorem the motion about
    the centre of mass is a rotation, $\mathbf{x}_i = \mathbf{R}\,\mathbf{x}'_i$ with constant
    $\mathbf{x}'_i$. Differentiating $\mathbf{R}\mathbf{R}^T = \mathbf{1}$ shows that
    $\frac{d\mathbf{R}}{dt}\mathbf{R}^T$ is skew. Every skew matrix is the cross product with a
    vector; here it is the angular velocity $\boldsymbol{\Omega}$, and
    = \dot{\mathbf{x}}_i
    = \boldsymbol{\Omega}\times\mathbf{x}_i
    skew: \frac{d\mathbf{R}}{dt}\mathbf{R}^T + \mathbf{R}\frac{d\mathbf{R}^T}{dt} = \mathbf{0}
    turning: \frac{d\mathbf{R}}{dt}\mathbf{x}'_i =
      \boldsymbol{\Omega}\times\mathbf{R}\mathbf{x}'_i

-  energy_as_a_form  1.2
    With $\boldsymbol{\Omega} = \sum_j \Omega_j\mathbf{e}_j$ in any orthonormal basis, the energy
    of the rotation is a quadratic form in the components of $\boldsymbol{\Omega}$,
    = E_R = \frac{1}{2}\sum_i m_i(\boldsymbol{\Omega}\times\mathbf{x}_i)\cdot
      (\boldsymbol{\Omega}\times\mathbf{x}_i)
    = \frac{1}{2}\sum_i m_i\bigl(\sum_j\Omega_j\mathbf{e}_j\times\mathbf{x}_i\bigr)\cdot
      \bigl(\sum_k\Omega_k\mathbf{e}_k\times\mathbf{x}_i\bigr)
    = \frac{1}{2}\sum_{j,k}\Omega_j\Omega_k
      \sum_i m_i(\mathbf{e}_j\times\mathbf{x}_i)\cdot(\mathbf{e}_k\times\mathbf{x}_i)
    = \frac{1}{2}\boldsymbol{\Omega}^T\mathbf{I}\,\boldsymbol{\Omega}
    in_the_basis: \boldsymbol{\Omega}\times\mathbf{x}_i =
      \sum_j\Omega_j\mathbf{e}_j\times\mathbf{x}_i
    coefficients: |\boldsymbol{\Omega}\times\mathbf{x}_i|^2 = \sum_{j,k}\Omega_j\Omega_k
      (\mathbf{e}_j\times\mathbf{x}_i)\cdot(\mathbf{e}_k\times\mathbf{x}_i)

4  inertia_of_particles  1.2
    The coefficients form the inertia tensor. It depends on the mass distribution only through its
    second moments, which is remarkable: moments of higher order might have mattered too.
    = I_{jk}
    = \sum_i m_i(\mathbf{e}_j\times\mathbf{x}_i)\cdot(\mathbf{e}_k\times\mathbf{x}_i)
    energy_is_a_form: \frac{1}{2}\sum_i m_i|\boldsymbol{\Omega}\times\mathbf{x}_i|^2 =
      \frac{1}{2}\boldsymbol{\Omega}^T\mathbf{I}\,\boldsymbol{\Omega}
    symmetric: \mathbf{I}^T = \mathbf{I}

# Another basis
5  components_in_another_basis  2.1
    A rotation $\mathbf{R}$ takes the basis to another,
    $\mathbf{e}'_j = \mathbf{R}\,\mathbf{e}_j$. The components of $\boldsymbol{\Omega}$ in it are
    the scalar products with the new basis vectors,
    = \Omega'_j
    = \boldsymbol{\Omega}\cdot\mathbf{e}'_j
    = \boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j
    whole_vector: \sum_j(\boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j)\mathbf{R}\,\mathbf{e}_j =
      \boldsymbol{\Omega}

-  products_of_turned_vectors  2.1
    Rotations preserve scalar products, $\mathbf{u}\cdot\mathbf{v} =
    \mathbf{R}\mathbf{u}\cdot\mathbf{R}\mathbf{v}$; moved from one factor to the other, a rotation
    becomes its inverse,
    = \mathbf{R}^{-1}\mathbf{u}\cdot\mathbf{v}
    = \mathbf{u}\cdot\mathbf{R}\mathbf{v}
    keeps_products: \mathbf{u}\cdot\mathbf{v} = \mathbf{R}\mathbf{u}\cdot\mathbf{R}\mathbf{v}
    goes_over: \mathbf{R}^{-1}\mathbf{u}\cdot\mathbf{v} = \mathbf{u}\cdot\mathbf{R}\mathbf{v}

6  rotation_goes_over  2.1
    Applied to (5), this gives
    = \Omega'_j
    = \mathbf{R}^{-1}\boldsymbol{\Omega}\cdot\mathbf{e}_j
    components: \boldsymbol{\Omega}\cdot\mathbf{R}\,\mathbf{e}_j =
      \mathbf{R}^{-1}\boldsymbol{\Omega}\cdot\mathbf{e}_j

7  angular_velocity_turns  2.1
    In one line, for all three components,
    = \boldsymbol{\Omega}' = \mathbf{R}^{-1}\boldsymbol{\Omega} \quad\Leftrightarrow\quad
      \boldsymbol{\Omega}
    = \mathbf{R}\,\boldsymbol{\Omega}'
    inverse: \mathbf{R}^{-1} = \mathbf{R}^T
    and_back: \mathbf{R}(\mathbf{R}^{-1}\boldsymbol{\Omega}) = \boldsymbol{\Omega}

8  energy_in_another_basis  2.1
    The energy does not depend on the choice of basis; by (7)
    = E_R
    = \frac{1}{2}\boldsymbol{\Omega}^T\mathbf{I}\,\boldsymbol{\Omega}
    = \frac{1}{2}\boldsymbol{\Omega}'^T\mathbf{R}^T\mathbf{I}\,\mathbf{R}\,\boldsymbol{\Omega}'
    same_energy: (\mathbf{R}\boldsymbol{\Omega}')^T\mathbf{I}\,\mathbf{R}\boldsymbol{\Omega}' =
      \boldsymbol{\Omega}'^T\mathbf{R}^T\mathbf{I}\,\mathbf{R}\,\boldsymbol{\Omega}'

9  inertia_turns  2.1
    The matrix in the middle is therefore the inertia tensor in the new basis. With the
    components $\mathbf{x}'_i = \mathbf{R}^{-1}\mathbf{x}_i$ of the positions in that basis, (4)
    gives the same:
    = \mathbf{I}'
    = \mathbf{R}^T\mathbf{I}\,\mathbf{R}
    tensor_turns: \mathbf{R}^T\,\mathbf{I}(\mathbf{R}\mathbf{x}'_i)\,\mathbf{R} =
      \mathbf{I}(\mathbf{x}'_i)

# Moments of inertia
-  entries_of_inertia  2.2  summands
    With $\mathbf{x}_i = (a_i, b_i, c_i)$ and the identity for the scalar product of two cross
    products, (4) becomes
    = \mathbf{I}
    lagrange: (\mathbf{u}\times\mathbf{v})\cdot(\mathbf{w}\times\boldsymbol{\Omega}) =
      (\mathbf{u}\cdot\mathbf{w})(\mathbf{v}\cdot\boldsymbol{\Omega}) -
      (\mathbf{u}\cdot\boldsymbol{\Omega})(\mathbf{v}\cdot\mathbf{w})
    entries: \mathbf{I} = \sum_i m_i\bigl((\mathbf{x}_i\cdot\mathbf{x}_i)\mathbf{1} -
      \mathbf{x}_i\mathbf{x}_i^T\bigr)

-  moment_about_a_line  2.2
    The moment of inertia about a line is the sum of the masses times the squares of their distances
    $d^{\perp}_i$ from it. For the line through the centre of mass along a unit vector
    $\mathbf{e}$ it follows from the tensor; for a basis vector it is a diagonal entry. The other
    entries are called the products of inertia.
    = I
    = \sum_i m_i(d^{\perp}_i)^2
    = \mathbf{e}^T\mathbf{I}\,\mathbf{e}
    about_a_line: \sum_i m_i|\mathbf{x}_i - (\mathbf{x}_i\cdot\mathbf{e})\mathbf{e}|^2 =
      \mathbf{e}^T\mathbf{I}\,\mathbf{e}

# Principal axes
10  energy_in_principal_axes  2.3
    The tensor is real and symmetric, and so there is a rotation that makes it diagonal; this
    theorem of linear algebra is used here, and not proved. The new axes are the principal axes of
    the body, and the diagonal entries are the principal moments of inertia. With the components of
    $\boldsymbol{\Omega}$ along these axes,
    = E_R
    = \frac{1}{2}\bigl[I'_{11}\Omega_1^2 + I'_{22}\Omega_2^2 + I'_{33}\Omega_3^2\bigr]
    stays_symmetric: (\mathbf{R}^T\mathbf{I}\,\mathbf{R})^T = \mathbf{R}^T\mathbf{I}\,\mathbf{R}
    energy_in_principal_axes: \boldsymbol{\Omega}'^T\mathbf{I}'\,\boldsymbol{\Omega}' = \sum_k
      I'_{kk}\Omega_k^2

# The angular momentum
-  momentum_expanded  3.1
    The angular momentum of the body is the sum of those of its particles. With
    $\mathbf{r}_i = \mathbf{r}_C + \mathbf{x}_i$,
    = \mathbf{L} = \sum_i\mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i)
    = \sum_i m_i(\mathbf{r}_C + \mathbf{x}_i)\times(\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i)
    = \mathbf{r}_C\times(M\dot{\mathbf{r}}_C) +
      \mathbf{r}_C\times\sum_i m_i\,\dot{\mathbf{x}}_i +
      \sum_i m_i\,\mathbf{x}_i\times\dot{\mathbf{r}}_C +
      \sum_i\mathbf{x}_i\times(m_i\dot{\mathbf{x}}_i)
    four_products: (\mathbf{r}_C + \mathbf{x}_i)\times(\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i) =
      \mathbf{r}_C\times\dot{\mathbf{r}}_C + \mathbf{r}_C\times\dot{\mathbf{x}}_i +
      \mathbf{x}_i\times\dot{\mathbf{r}}_C + \mathbf{x}_i\times\dot{\mathbf{x}}_i
    centre_outside: \sum_i m_i\,\mathbf{r}_C\times(\dot{\mathbf{r}}_C + \dot{\mathbf{x}}_i) =
      \mathbf{r}_C\times(M\dot{\mathbf{r}}_C) + \mathbf{r}_C\times\sum_i m_i\,\dot{\mathbf{x}}_i

11  momentum_splits  3.1
    The cross terms vanish again, and the angular momentum has two parts,
    = \mathbf{L}
    = \mathbf{L}_C + \mathbf{L}_R
    no_mixed_momentum: \sum_i m_i(\mathbf{r}_C\times\dot{\mathbf{x}}_i +
      \mathbf{x}_i\times\dot{\mathbf{r}}_C) = \mathbf{0}

12  parts_of_the_momentum  3.1
    The first belongs to the motion of the centre of mass, the second to the rotation:
    = \mathbf{L}_C = \mathbf{r}_C\times(M\dot{\mathbf{r}}_C), \qquad \mathbf{L}_R
    = \sum_i \mathbf{x}_i\times(m_i\dot{\mathbf{x}}_i)
    momentum_splits: \sum_i \mathbf{r}_i\times(m_i\dot{\mathbf{r}}_i) = \mathbf{L}_C +
      \mathbf{L}_R

-  momentum_by_the_tensor  3.1
    By (3) the second part is linear in the angular velocity, with the tensor of (4):
    = \mathbf{L}_R = \sum_i m_i\,\mathbf{x}_i\times(\boldsymbol{\Omega}\times\mathbf{x}_i)
    = \sum_i m_i\bigl(|\mathbf{x}_i|^2\boldsymbol{\Omega} -
      (\mathbf{x}_i\cdot\boldsymbol{\Omega})\mathbf{x}_i\bigr), \qquad L_{R,j}
    = \sum_k I_{jk}\Omega_k
    double_product: \mathbf{x}_i\times(\boldsymbol{\Omega}\times\mathbf{x}_i) =
      |\mathbf{x}_i|^2\boldsymbol{\Omega} - (\mathbf{x}_i\cdot\boldsymbol{\Omega})\mathbf{x}_i

13  momentum_of_rotation  3.1
    In other words,
    = \mathbf{L}_R
    = \mathbf{I}\,\boldsymbol{\Omega}
    momentum_is_linear: \sum_i m_i\,\mathbf{x}_i\times(\boldsymbol{\Omega}\times\mathbf{x}_i) =
      \mathbf{I}\,\boldsymbol{\Omega}
    twice_the_energy: \mathbf{L}_R\cdot\boldsymbol{\Omega} = \sum_i m_i|\dot{\mathbf{x}}_i|^2 =
      2E_R

14  momentum_in_principal_axes  3.1
    In the principal-axis frame the components are simply
    = L_{R,1} = I_{11}\Omega_1, \qquad L_{R,2} = I_{22}\Omega_2, \qquad L_{R,3}
    = I_{33}\Omega_3
    components_of_momentum: (\mathbf{I}\,\boldsymbol{\Omega})_k = I_{kk}\Omega_k

# The angular velocity of a rotation
15  velocity_by_the_rotation  3.2
    Let coordinates $\mathbf{q}(t)$ describe the orientation relative to a reference orientation
    in which the principal axes coincide with the basis,
    $\mathbf{x}_i = \mathbf{R}(\mathbf{q}(t))\,\mathbf{x}'_i$. Then
    = \dot{\mathbf{x}}_i
    = \frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i
    = \frac{d\mathbf{R}}{dt}\mathbf{R}^T\,\mathbf{x}_i
    velocity: \frac{d\mathbf{R}}{dt}\,\mathbf{x}'_i =
      \frac{d\mathbf{R}}{dt}\mathbf{R}^T\,\mathbf{R}\,\mathbf{x}'_i
    operator: \mathbf{C}(\mathbf{u})\,\mathbf{v} = \mathbf{u}\times\mathbf{v}

16  angular_velocity_of_the_rotation  3.2
    Comparison with (3) shows that $\frac{d\mathbf{R}}{dt}\mathbf{R}^T$ is the matrix
    $\mathbf{C}(\boldsymbol{\Omega})$ of the operator $\boldsymbol{\Omega}\times$. So
    $\boldsymbol{\Omega} = \mathbf{C}^{-1}\bigl(\frac{d\mathbf{R}}{dt}\mathbf{R}^T\bigr)$, where
    $\mathbf{C}^{-1}$ takes the vector from the entries below the diagonal; its components are
    along the axes of space. Along the axes of the body, by (7),
    = \boldsymbol{\Omega}'
    = \mathbf{R}^T\,\mathbf{C}^{-1}\left(\frac{d\mathbf{R}}{dt}\mathbf{R}^T\right)
    spin: \frac{d\mathbf{R}}{dt}\mathbf{R}^T = \mathbf{C}(\boldsymbol{\Omega})
    body_spin: \mathbf{R}^T\frac{d\mathbf{R}}{dt} = \mathbf{C}(\boldsymbol{\Omega}')
"""


def _read(text: str) -> Iterator[Statement]:
    section = ""
    for block in text.strip().split("\n\n"):
        heading, _, rest = block.partition("\n")
        if heading.startswith("# "):
            section = heading[2:]
            heading, _, rest = rest.partition("\n")
        yield _statement(section, heading, "\n" + rest)


def _statement(section: str, heading: str, text: str) -> Statement:
    number, name, place, *more = heading.split()
    words, *items = _ITEM.split(text)
    pairs = [
        (mark, formula(_plain(item))) for mark, item in zip(items[::2], items[1::2], strict=True)
    ]
    return Statement(
        name=name,
        number=None if number == "-" else int(number),
        section=section,
        because=sentence(_plain(words)),
        sides=tuple(side for mark, side in pairs if mark == "="),
        claims=tuple((mark[:-1], claim) for mark, claim in pairs if mark != "="),
        source=lecture("" if number == "-" else number, f"section {place}"),
        shows_summands="summands" in more,
    )


def _plain(text: str) -> str:
    """On one line, with the transpose as `formula` reads it."""
    return " ".join(text.split()).replace("^T", r"^{\mathsf T}")


STATEMENTS = tuple(_read(_EQUATIONS))
