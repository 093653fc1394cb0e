from rigidsym.data.mass.point_masses import inertia_of as inertia_of
from rigidsym.data.mass.properties import principal_axes_of as principal_axes_of
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
from rigidsym.models.matrices import given as given
from rigidsym.models.parametrisations import (
    AxisAngle as AxisAngle,
    CayleyKlein as CayleyKlein,
    DirectionCosines as DirectionCosines,
    GibbsVector as GibbsVector,
    ModifiedRodrigues as ModifiedRodrigues,
    Quaternion as Quaternion,
    RotationVector as RotationVector,
    UnitQuaternion as UnitQuaternion,
)
from rigidsym.models.rotation import (
    Citation as Citation,
    RotationModel as RotationModel,
    Turn as Turn,
)
from rigidsym.models.rotation_text import rotation_from as rotation_from
from rigidsym.motion import Motion as Motion, derive as derive, kernels as kernels
from rigidsym.tools.compare.comparison import checked as checked, compare as compare
from rigidsym.tools.compare.matching import Comparison as Comparison
from rigidsym.tools.identify.identification import identify as identify
from rigidsym.tools.identify.report import Identification as Identification
from rigidsym.version import __version__ as __version__
