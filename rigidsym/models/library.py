"""The rotations by name: other parametrisations, and the Euler angles of well-known texts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

from rigidsym.models import parametrisations
from rigidsym.models.rotation import SOURCES, Citation, RotationModel, lecture


class Entry(NamedTuple):
    """One parametrisation: how it is built, and R written out."""

    build: Callable[..., RotationModel]  # names of the coordinates, passive
    product: str
    has_scalar: bool = False  # whether its scalar may stand last


class Preset(NamedTuple):
    """The Euler angles, or another rotation, of one text."""

    rotation: str  # a sequence, turns, or the name of a parametrisation
    about: str
    source: Citation
    names: tuple[str, ...] = ()
    passive: bool = False
    z_down: bool = False  # whether its z-axis points to the ground


PARAMETRISATIONS: Mapping[str, Entry] = {
    "quaternion": Entry(
        parametrisations.Quaternion,
        "((w² − v·v) 1 + 2 v vᵀ + 2 w C(v))/(w² + v·v)",
        has_scalar=True,
    ),
    "unit_quaternion": Entry(
        parametrisations.UnitQuaternion,
        "(w² − v·v) 1 + 2 v vᵀ + 2 w C(v), w² + v·v = 1",
        has_scalar=True,
    ),
    "axis_angle": Entry(parametrisations.AxisAngle, "1 + sin φ C(e) + (1 − cos φ) C(e)², e·e = 1"),
    "rotation_vector": Entry(
        parametrisations.RotationVector, "exp C(v) = 1 + sin n/n C(v) + (1 − cos n)/n² C(v)²"
    ),
    "gibbs_vector": Entry(parametrisations.GibbsVector, "1 + 2/(1 + g·g) (C(g) + C(g)²)"),
    "modified_rodrigues": Entry(
        parametrisations.ModifiedRodrigues, "1 + (8 C(s)² + 4 (1 − s·s) C(s))/(1 + s·s)²"
    ),
    "cayley_klein": Entry(
        parametrisations.CayleyKlein, "the unit quaternion (a, d, c, b), α = a + i b, β = c + i d"
    ),
    "direction_cosines": Entry(
        parametrisations.DirectionCosines, "its nine entries, with R Rᵀ = 1 and det R = 1"
    ),
}

PRESETS: Mapping[str, Preset] = {
    "lecture_angles": Preset(
        "ZXZ", "the Euler angles of the lecture", lecture("17", "section 3.2")
    ),
    "goldstein": Preset(
        "ZXZ",
        "Goldstein's Euler angles, his matrix A from space to body axes",
        SOURCES["Goldstein 4.4 (4.46)"],
        passive=True,
    ),
    "landau_lifshitz": Preset(
        "ZXZ",
        "the Euler angles of Landau and Lifshitz",
        SOURCES["Landau 35"],
    ),
    "aerospace": Preset(
        "ZYX",
        "yaw, pitch, roll; from the reference frame to the axes of the aircraft",
        Citation(
            "B. Stevens, F. Lewis, Aircraft Control and Simulation (2003)", section="section 1.3"
        ),
        ("psi", "theta", "phi"),
        passive=True,
        z_down=True,
    ),
    "wertz": Preset(
        "ZXZ",
        "3-1-3 of spacecraft attitude, the direction cosine matrix",
        Citation(
            "J. Wertz (ed.), Spacecraft Attitude Determination and Control (1978), appendix E"
        ),
        passive=True,
    ),
    "rpy": Preset(
        "xyz",
        "roll, pitch, yaw about fixed axes, as in robotics",
        Citation("J. Craig, Introduction to Robotics (2005)", section="section 2.8"),
        ("roll", "pitch", "yaw"),
    ),
    "davenport": Preset(
        "z(phi) x(theta) [0,b,c](psi)",
        "Davenport's three turns, the second axis at right angles to the others",
        Citation("P. Davenport, Rotations about nonorthogonal axes, AIAA Journal 11 (1973)"),
    ),
    "bunge": Preset(
        "ZXZ",
        "Bunge's angles of texture analysis, from the sample to the crystal",
        Citation("H.-J. Bunge, Texture Analysis in Materials Science (1982)"),
        ("phi_1", "Phi", "phi_2"),
        passive=True,
    ),
}
