"""Python modules for JAX."""

from rigidsym.kernels.targets import Target

TARGET = Target(
    about="NAME_jax.py: a Python module for JAX: jit, vmap, grad; no unwrap",
    ending="_jax.py",
    package="jax",
)
