"""ES modules without dependencies."""

from rigidsym.kernels.targets import Target

TARGET = Target(
    about="NAME.mjs: an ES module without dependencies, and its types in NAME.d.mts; no unwrap",
    ending=".mjs",
    programs=("node",),
    has_single=False,
)
