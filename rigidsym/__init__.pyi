from .data.mass import inertia_of as inertia_of, principal_axes_of as principal_axes_of
from .errors import NotARotation as NotARotation, RigidsymError as RigidsymError
from .mechanics.derivation import Derivation as Derivation
from .mechanics.mass.bodies import body_of as body_of, solid as solid
from .models.body import (
    Composite as Composite,
    Part as Part,
    Particle as Particle,
    Particles as Particles,
    RigidBody as RigidBody,
    general_inertia as general_inertia,
    principal_moments as principal_moments,
)
from .models.library import rotation_from as rotation_from
from .models.parametrisations import (
    EULER_SEQUENCES as EULER_SEQUENCES,
    EulerAngles as EulerAngles,
    chain as chain,
    given as given,
)
from .models.rotation import Citation as Citation, RotationModel as RotationModel, Turn as Turn
from .motion import Motion as Motion, derive as derive, kernels as kernels
from .tools.compare.comparison import Comparison as Comparison, compare as compare
from .tools.identify.identification import Identification as Identification, identify as identify
from .version import __version__ as __version__
