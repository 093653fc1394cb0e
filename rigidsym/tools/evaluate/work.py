"""What is computed of each piece: whole in itself, so that it can be sent to another machine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from types import ModuleType

import numpy as np

from rigidsym.data.chunk import Table
from rigidsym.kernels.module import KernelModule
from rigidsym.tools.evaluate.inputs import Inputs
from rigidsym.tools.evaluate.outputs import Column, in_units


@dataclass(frozen=True, kw_only=True, slots=True)
class Work:
    """Functions of a generated module on rows of numbers."""

    kernels: KernelModule
    calls: tuple[tuple[str, tuple[str, ...]], ...]  # functions, with the names of their arrays
    inputs: Inputs
    columns: tuple[Column, ...]  # of the result
    threads: int = 1

    def of(self, table: Table) -> Table:
        """The results, (rows, columns), of float32 where the rows are."""
        kernels = self.kernels
        module = _loaded(kernels.name, kernels.target, tuple(kernels.files.items()))
        found = []
        for function, names in self.calls:
            arguments = [self.inputs.arguments[name].of(table) for name in names]
            values = np.asarray(getattr(module, function)(*arguments, threads=self.threads))
            has_rows = any(self.inputs.arguments[name].columns for name in names)
            rows = values.reshape(len(table) if has_rows else 1, -1)
            found.append(np.broadcast_to(rows, (len(table), rows.shape[1])))
        return in_units(self.columns, np.concatenate(found, axis=1))


@lru_cache(maxsize=4)
def _loaded(name: str, target: str, files: tuple[tuple[str, str], ...]) -> ModuleType:
    return KernelModule(name=name, target=target, files=dict(files)).load()
