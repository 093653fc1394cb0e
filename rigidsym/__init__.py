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
import pathlib as _pathlib
import re as _re
import typing as _typing

from rigidsym.version import __version__ as __version__

_STUB = _pathlib.Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_IMPORTS = _re.findall(r"^from (\S+) import (?:\(([^)]*)\)|(.*))$", _STUB, _re.MULTILINE)
_HOMES = {
    name.split()[0]: module
    for module, *names in _IMPORTS
    for name in "".join(names).strip(" ,\n").split(",")
}
__all__ = sorted(_HOMES)


def __getattr__(name: str) -> _typing.Any:
    if name == "kernels":  # the room, which is callable
        return _importlib.import_module("rigidsym.kernels")
    if name not in _HOMES:
        raise AttributeError(f"module 'rigidsym' has no attribute {name!r}")
    return getattr(_importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return __all__
