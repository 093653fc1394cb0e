"""What is computed of each chunk: whole in itself, so that it can be sent to another machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from types import ModuleType

import numpy as np

from rigidsym.data.chunk import Table
from rigidsym.motion import KernelModule


@dataclass(frozen=True, kw_only=True, slots=True)
class Input:
    """One argument of a function: columns of each chunk, or numbers that stay the same."""

    columns: tuple[int, ...]  # of the chunk; empty if the numbers are given
    given: tuple[float, ...] = ()
    factors: tuple[float, ...] = ()  # to the units of the functions
    shape: tuple[int, ...] = (-1,)  # of the argument of one row

    def of(self, table: Table) -> Table:
        """The argument of each row, (rows, *shape), in the units of the functions."""
        if not self.columns:
            return np.array(self.given, table.dtype).reshape(self.shape)
        values = table[:, self.columns[0] : self.columns[-1] + 1]  # they were read in this order
        if any(factor != 1 for factor in self.factors):
            values = values * np.array(self.factors).astype(table.dtype)
        return values.reshape(len(table), *self.shape)


@dataclass(frozen=True, slots=True)
class ResultColumn:
    """One column of a result."""

    name: str
    unit: str = ""
    in_degrees: bool = False

    def __str__(self) -> str:
        unit = self.unit.replace("rad", "deg", 1) if self.in_degrees else self.unit
        return f"{self.name} [{unit}]" if unit else self.name


@dataclass(frozen=True, kw_only=True, slots=True)
class Work:
    """Callables of a generated module on rows of numbers."""

    kernels: KernelModule
    calls: tuple[tuple[str, tuple[str, ...]], ...]  # functions, with the names of their arrays
    outputs: tuple[ResultColumn, ...]
    inputs: Mapping[str, Input] = field(default_factory=dict)  # by the names of the arrays
    threads: int = 1

    def of(self, table: Table) -> Table:
        """The results, (rows, outputs), of float32 if the rows are."""
        kernels = self.kernels
        module = _loaded(kernels.name, kernels.target, tuple(kernels.files.items()))
        found = []
        for function, names in self.calls:
            arguments = [self.inputs[name].of(table) for name in names]
            values = np.asarray(getattr(module, function)(*arguments, threads=self.threads))
            has_rows = any(self.inputs[name].columns for name in names)
            rows = values.reshape(len(table) if has_rows else 1, -1)
            found.append(np.broadcast_to(rows, (len(table), rows.shape[1])))
        result: Table = np.concatenate(found, axis=1)
        if any(output.in_degrees for output in self.outputs):
            degrees = [180 / np.pi if output.in_degrees else 1 for output in self.outputs]
            result = result * np.array(degrees).astype(table.dtype)
        return result


@lru_cache(maxsize=4)
def _loaded(name: str, target: str, files: tuple[tuple[str, str], ...]) -> ModuleType:
    return KernelModule(name=name, target=target, files=dict(files)).load()
