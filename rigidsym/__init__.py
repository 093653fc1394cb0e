"""Exact, proved derivations of rigid-body rotation, and the kernels and notes printed from them.

    import rigidsym as rs

    motion = rs.derive(rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")))
    motion.angular_velocity_body        # SymPy matrix, (3, 1)
    motion.kernels().load()             # a NumPy module
    motion.note().latex()               # a LaTeX document

`__init__.pyi` lists the names and their modules; each is loaded on first use, so that
`rigidsym --help` imports neither SymPy nor NumPy.
"""

import importlib as _importlib
import typing as _typing

import lazy_loader as _lazy_loader

from rigidsym.version import __version__ as __version__

_loaded, __dir__, __all__ = _lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> _typing.Any:
    if name == "kernels":  # the room, which is callable
        return _importlib.import_module("rigidsym.kernels")
    if name not in __all__:
        raise AttributeError(f"module 'rigidsym' has no attribute {name!r}")
    return _loaded(name)
