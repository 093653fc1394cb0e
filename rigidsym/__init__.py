"""Exact, proved derivations of rigid-body rotation, and the kernels and notes printed from them.

    import rigidsym as rs

    motion = rs.derive(rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")))
    motion.angular_velocity_body        # SymPy matrix, (3, 1)
    motion.kernels().load()             # a NumPy module
    motion.note().latex()               # a LaTeX document

Names are loaded on first use, so that `rigidsym --help` imports neither SymPy nor NumPy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rigidsym.version import __version__

_HOMES = {
    "derive": "rigidsym.motion",
    "identify": "rigidsym.tools.identify.identify",
    "inertia_of": "rigidsym.data.mass.inertia",
    "principal_axes_of": "rigidsym.data.mass.principal_axes",
    "RigidBody": "rigidsym.models.body",
    "principal_moments": "rigidsym.models.body",
    "general_inertia": "rigidsym.models.body",
    "solid": "rigidsym.mechanics.mass.bodies",
    "body_of": "rigidsym.mechanics.mass.bodies",
    "Particle": "rigidsym.models.distribution",
    "Particles": "rigidsym.models.distribution",
    "Composite": "rigidsym.models.distribution",
    "Part": "rigidsym.models.distribution",
    "Identification": "rigidsym.tools.identify.identify",
    "Motion": "rigidsym.motion",
    "EulerAngles": "rigidsym.models.euler_angles",
    "EULER_SEQUENCES": "rigidsym.models.euler_angles",
    "RotationModel": "rigidsym.models.rotation",
    "Turn": "rigidsym.models.rotation",
    "chain": "rigidsym.models.chain",
    "Quaternion": "rigidsym.models.quaternions",
    "UnitQuaternion": "rigidsym.models.quaternions",
    "CayleyKlein": "rigidsym.models.quaternions",
    "AxisAngle": "rigidsym.models.quaternions",
    "RotationVector": "rigidsym.models.vectors",
    "GibbsVector": "rigidsym.models.vectors",
    "ModifiedRodrigues": "rigidsym.models.vectors",
    "DirectionCosines": "rigidsym.models.matrices",
    "given": "rigidsym.models.matrices",
    "rotation_from": "rigidsym.models.rotation_text",
    "Citation": "rigidsym.models.rotation",
    "Derivation": "rigidsym.mechanics.derivation",
    "RigidsymError": "rigidsym.errors",
    "NotARotation": "rigidsym.errors",
}

__all__ = [
    "EULER_SEQUENCES",
    "AxisAngle",
    "CayleyKlein",
    "Citation",
    "Composite",
    "Derivation",
    "DirectionCosines",
    "EulerAngles",
    "GibbsVector",
    "Identification",
    "ModifiedRodrigues",
    "Motion",
    "NotARotation",
    "Part",
    "Particle",
    "Particles",
    "Quaternion",
    "RigidBody",
    "RigidsymError",
    "RotationModel",
    "RotationVector",
    "Turn",
    "UnitQuaternion",
    "__version__",
    "body_of",
    "chain",
    "derive",
    "general_inertia",
    "given",
    "identify",
    "inertia_of",
    "principal_axes_of",
    "principal_moments",
    "rotation_from",
    "solid",
]

if TYPE_CHECKING:
    from rigidsym.data.mass.inertia import inertia_of
    from rigidsym.data.mass.principal_axes import principal_axes_of
    from rigidsym.errors import NotARotation, RigidsymError
    from rigidsym.mechanics.derivation import Derivation
    from rigidsym.mechanics.mass.bodies import body_of, solid
    from rigidsym.models.body import RigidBody, general_inertia, principal_moments
    from rigidsym.models.chain import chain
    from rigidsym.models.distribution import Composite, Part, Particle, Particles
    from rigidsym.models.euler_angles import EULER_SEQUENCES, EulerAngles
    from rigidsym.models.matrices import DirectionCosines, given
    from rigidsym.models.quaternions import AxisAngle, CayleyKlein, Quaternion, UnitQuaternion
    from rigidsym.models.rotation import Citation, RotationModel, Turn
    from rigidsym.models.rotation_text import rotation_from
    from rigidsym.models.vectors import GibbsVector, ModifiedRodrigues, RotationVector
    from rigidsym.motion import Motion, derive
    from rigidsym.tools.identify.identify import Identification, identify


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'rigidsym' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
