"""C99, and a Python module compiled from it."""

from rigidsym.kernels.targets import Target

TARGET = Target(
    about="NAME.h, NAME.c: C99; rigidsym build compiles the Python module NAME_c.py",
    ending=".c",
    stands_alone=False,
    programs=("cc", "gcc", "clang"),
    options={
        "precision": ("both", "double", "float"),
        "arrays": (True, False),
        "libm": (False, True),
    },
)
