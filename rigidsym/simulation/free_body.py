"""The free rigid body in closed form: Ω′ in Jacobi elliptic functions, R with Legendre's Π.

L. Landau, E. Lifshitz, Mechanics (1976), section 37. The polhode encircles one axis c, that of the
greatest or of the least moment; about L this axis precesses at

    L (2E − C Ω_c²)/(L² − C² Ω_c²) = L/C + L (2E C − L²)/(C (L² − C² Ω_c²)).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rigidsym.data.mass import principal_axes_of

Array = NDArray[np.float64]
_ROUNDING = 1e-15  # relative: by which L and Ω may differ in direction and count as parallel


def free_motion(inertia: Array, omega: Array, rotation: Array, t: Array) -> tuple[Array, Array]:
    """Ω′ and R at the times t, (n, 3) and (n, 3, 3), from their values at t = 0.

    `inertia` is the tensor about the fixed point in the axes of the body, (3, 3).
    """
    principal = principal_axes_of(inertia)
    moments, axes = principal.moments, principal.axes
    start = axes.T @ omega
    momentum = moments * start
    square, twice = momentum @ momentum, momentum @ start  # L², 2E
    if square == 0:
        return np.zeros((len(t), 3)), np.repeat(rotation[None], len(t), axis=0)
    # L² = 2E B is the separatrix. For L² > 2E B the polhode encircles the axis of the greatest
    # moment, for L² < 2E B that of the least; b is always the intermediate axis.
    a, b, c = (0, 1, 2) if square >= twice * moments[1] else (2, 1, 0)
    # If L ∥ Ω, Ω′ is constant, and the formulas below divide zero by zero or have an infinite
    # phase. The only motions of a spherical body are of this kind, so that A = C never reaches
    # them.
    if np.linalg.norm(np.cross(momentum, start)) <= _ROUNDING * twice:  # a principal axis
        return np.repeat(omega[None], len(t), axis=0), rotation @ _turned(t, omega)
    (in_a, in_b, in_c), precession = _in_principal_axes(moments, start, (a, b, c), t)
    along = np.empty((len(t), 3))
    along[:, a], along[:, b], along[:, c] = in_a, in_b, in_c
    # R(t) = R(0) P F(0)ᵀ R_z(ψ) F(t) Pᵀ. The columns of P are the principal axes. F(t) takes
    # principal components to a frame with z along L and c in the half-plane x > 0; it precesses by
    # ψ about L.
    frames = _frames(moments * along / np.sqrt(square), c)
    turned = _turned(precession, np.array([0.0, 0.0, 1.0])) @ frames
    whole = rotation @ axes @ _frames(momentum[None] / np.sqrt(square), c)[0].T @ turned @ axes.T
    return along @ axes.T, whole


def _in_principal_axes(
    moments: Array, start: Array, places: tuple[int, int, int], t: Array
) -> tuple[tuple[Array, Array, Array], Array]:
    """Ω′ along a, b and c, and the angle by which c has precessed about L."""
    from scipy.special import ellipj, ellipkinc

    a, b, c = places
    A, B, C = moments[[a, b, c]]
    # the combinations of E and L, from the components themselves so that no digits cancel
    of_c = A * (A - C) * start[a] ** 2 + B * (B - C) * start[b] ** 2  # L² − 2E C
    of_a = B * (B - A) * start[b] ** 2 + C * (C - A) * start[c] ** 2  # L² − 2E A
    size_a = np.sqrt(of_c / (A * (A - C)))
    size_b = np.sqrt(of_c / (B * (B - C)))
    size_c = np.sqrt(of_a / (C * (C - A)))
    # Ω_c = ±size_c dn keeps its sign. For both orders of a, b, c, B dΩ_b/dt = |C − A| Ω_c Ω_a, and
    # with Ω_a = size_a cn this gives Ω_b = ±size_b sn with the same sign.
    sign = np.copysign(1.0, start[c])
    # The elliptic functions take u = F(first | m) + rate t; `first` is the amplitude at t = 0.
    # Rounding may lift the parameter m above 1, its value on the separatrix.
    rate = np.sqrt((C - B) * of_a / (A * B * C))
    m = min((B - A) * of_c / ((B - C) * of_a), 1.0)
    first = np.arctan2(sign * start[b] / size_b, start[a] / size_a)
    sn, cn, dn, amplitude = ellipj(ellipkinc(first, m) + rate * t, m)
    # C² Ω_c² = C² size_c² (1 − m sn²), so that the integral of 1/(L² − C² Ω_c²) over the time is
    # Π(n; am u | m)/(rate · across), with n = −C² size_c² m/across.
    momentum = np.sqrt(sum((moments * start) ** 2))
    across = A * A * size_a**2  # L² − C² Ω_c² where sn = 0
    n = -(C * C * size_c**2 * m) / across
    turned = (_third_kind(n, amplitude, m) - _third_kind(n, np.array([first]), m)) / rate
    precession = momentum / C * t - momentum * of_c / (C * across) * turned
    return (size_a * cn, sign * size_b * sn, sign * size_c * dn), precession


def _third_kind(n: float, amplitude: Array, m: float) -> Array:
    """Legendre's Π(n; φ | m), by Carlson's integrals; φ of any size, n < 0."""
    # Π(n; φ + kπ | m) = Π(n; φ | m) + 2k Π(n; π/2 | m). The complete integral is infinite at m = 1,
    # but the amplitude then stays below π/2 in size, and k = 0.
    turns = np.round(amplitude / np.pi)
    near = amplitude - turns * np.pi
    return _near(n, near, m) + 2 * turns * (_near(n, np.array([np.pi / 2]), m) if any(turns) else 0)


def _near(n: float, amplitude: Array, m: float) -> Array:
    from scipy.special import elliprf, elliprj

    # Π = s R_F(c², 1 − m s², 1) + n/3 s³ R_J(c², 1 − m s², 1, 1 − n s²) for |φ| ≤ π/2. With n < 0,
    # all arguments are positive, and there is no principal value to take.
    s, c = np.sin(amplitude), np.cos(amplitude)
    x, y = c * c, 1 - m * s * s
    return np.asarray(s * elliprf(x, y, 1.0) + n / 3 * s**3 * elliprj(x, y, 1.0, 1 - n * s * s))


def _frames(momentum: Array, c: int) -> Array:
    """Rows x, y, z of frames with z along the momentum and the axis c in the half-plane x > 0."""
    y = np.cross(momentum, np.eye(3)[c])
    y /= np.linalg.norm(y, axis=1)[:, None]
    return np.stack([np.cross(y, momentum), y, momentum], axis=1)


def _turned(angles: Array, axis: Array) -> Array:
    """Rotations by multiples of a vector, (n, 3, 3)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(np.outer(angles, axis)).as_matrix())
