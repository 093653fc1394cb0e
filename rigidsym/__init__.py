"""Exact, proved derivations of rigid-body rotation, and the kernels and notes printed from them.

    import rigidsym as rs

    motion = rs.derive(rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")))
    motion.angular_velocity_body        # SymPy matrix, (3, 1)
    motion.kernels().load()             # a NumPy module
    motion.note().latex()               # a LaTeX document

Names are loaded on first use, so that `rigidsym --help` imports neither SymPy nor NumPy.
"""

import importlib as _importlib
import typing as _typing

from rigidsym.version import __version__ as __version__

_NAMES = {
    "data.mass.point_masses": "inertia_of",
    "data.mass.principal_axes": "principal_axes_of",
    "errors": "NotARotation RigidsymError",
    "mechanics.derivation": "Derivation",
    "mechanics.mass.bodies": "body_of solid",
    "models.body": "RigidBody general_inertia principal_moments",
    "models.chain": "chain",
    "models.distribution": "Composite Part Particle Particles",
    "models.euler_angles": "EULER_SEQUENCES EulerAngles",
    "models.matrices": "DirectionCosines given",
    "models.quaternions": "AxisAngle CayleyKlein Quaternion UnitQuaternion",
    "models.rotation": "Citation RotationModel Turn",
    "models.rotation_text": "rotation_from",
    "models.vectors": "GibbsVector ModifiedRodrigues RotationVector",
    "motion": "Motion derive",
    "tools.identify.identification": "identify",
    "tools.identify.report": "Identification",
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = sorted([*_HOMES, "__version__", "kernels"])

if _typing.TYPE_CHECKING:
    from rigidsym.data.mass.point_masses import inertia_of as inertia_of
    from rigidsym.data.mass.principal_axes import principal_axes_of as principal_axes_of
    from rigidsym.errors import NotARotation as NotARotation, RigidsymError as RigidsymError
    from rigidsym.mechanics.derivation import Derivation as Derivation
    from rigidsym.mechanics.mass.bodies import body_of as body_of, solid as solid
    from rigidsym.models.body import (
        RigidBody as RigidBody,
        general_inertia as general_inertia,
        principal_moments as principal_moments,
    )
    from rigidsym.models.chain import chain as chain
    from rigidsym.models.distribution import (
        Composite as Composite,
        Part as Part,
        Particle as Particle,
        Particles as Particles,
    )
    from rigidsym.models.euler_angles import (
        EULER_SEQUENCES as EULER_SEQUENCES,
        EulerAngles as EulerAngles,
    )
    from rigidsym.models.matrices import DirectionCosines as DirectionCosines, given as given
    from rigidsym.models.quaternions import (
        AxisAngle as AxisAngle,
        CayleyKlein as CayleyKlein,
        Quaternion as Quaternion,
        UnitQuaternion as UnitQuaternion,
    )
    from rigidsym.models.rotation import (
        Citation as Citation,
        RotationModel as RotationModel,
        Turn as Turn,
    )
    from rigidsym.models.rotation_text import rotation_from as rotation_from
    from rigidsym.models.vectors import (
        GibbsVector as GibbsVector,
        ModifiedRodrigues as ModifiedRodrigues,
        RotationVector as RotationVector,
    )
    from rigidsym.motion import Motion as Motion, derive as derive, kernels as kernels
    from rigidsym.tools.identify.identification import identify as identify
    from rigidsym.tools.identify.report import Identification as Identification


def __getattr__(name: str) -> _typing.Any:
    if name == "kernels":  # the room, which is callable
        return _importlib.import_module("rigidsym.kernels")
    if name not in _HOMES:
        raise AttributeError(f"module 'rigidsym' has no attribute {name!r}")
    return getattr(_importlib.import_module(f"rigidsym.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return __all__
