"""Derivation -> source code.

The package is callable: `rs.kernels("ZYX")` derives a rotation, prints its functions and loads
them.
"""

import importlib
import sys
import types
from typing import Any


class _CallableRoom(types.ModuleType):
    def __call__(self, *arguments: Any, **options: Any) -> types.ModuleType:
        """See `rigidsym.motion.kernels`."""
        made = importlib.import_module("rigidsym.motion").kernels(*arguments, **options)
        assert isinstance(made, types.ModuleType)
        return made


sys.modules[__name__].__class__ = _CallableRoom
