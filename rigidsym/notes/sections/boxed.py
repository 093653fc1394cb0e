"""What a reader looks up: these equations stand in boxes; steps and auxiliary ones do not."""

from __future__ import annotations

_NAMES = """
rotation_matrix
angular_velocity_space rates_from_angular_velocity_space angular_acceleration_space
angular_velocity_body rates_from_angular_velocity_body angular_acceleration_body

mass centre_of_mass inertia_tensor inertia_tensor_space principal_moments
rotational_energy kinetic_energy
angular_momentum_rotation_body angular_momentum_rotation angular_momentum

energy_splits inertia_of_particles angular_velocity_turns inertia_turns
energy_in_principal_axes momentum_splits momentum_of_rotation angular_velocity_of_the_rotation

lagrangian accelerations angular_acceleration_from_torque
"""
RESULTS = frozenset(_NAMES.split())  # names of equations
