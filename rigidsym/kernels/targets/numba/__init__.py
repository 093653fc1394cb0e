"""Python modules that Numba compiles."""

from rigidsym.kernels.targets import Target

TARGET = Target(
    about="NAME_numba.py: a Python module that Numba compiles",
    ending="_numba.py",
    package="numba",
)
