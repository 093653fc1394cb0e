"""Python modules that depend only on NumPy."""

from rigidsym.kernels.targets import Target

TARGET = Target(about="NAME.py: a Python module that depends only on NumPy", ending=".py")
