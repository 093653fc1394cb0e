"""What a reader looks up: these equations stand in boxes; steps and auxiliary ones do not."""

from __future__ import annotations

_OF_ROTATIONS = {
    "rotation_matrix",
    *(
        f"{name}_{frame}"
        for name in ("angular_velocity", "rates_from_angular_velocity", "angular_acceleration")
        for frame in ("space", "body")
    ),
}
_OF_BODIES = {
    "mass",
    "centre_of_mass",
    "inertia_tensor",
    "inertia_tensor_space",
    "principal_moments",
    "rotational_energy",
    "kinetic_energy",
    "angular_momentum_rotation_body",
    "angular_momentum_rotation",
    "angular_momentum",
}
_OF_THE_THEORY = {
    "energy_splits",
    "inertia_of_particles",
    "angular_velocity_turns",
    "inertia_turns",
    "energy_in_principal_axes",
    "momentum_splits",
    "momentum_of_rotation",
    "angular_velocity_of_the_rotation",
}
_OF_MOTION = {"lagrangian", "accelerations", "angular_acceleration_from_torque"}
RESULTS = frozenset(
    _OF_ROTATIONS | _OF_BODIES | _OF_THE_THEORY | _OF_MOTION
)  # names of their equations
