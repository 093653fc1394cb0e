"""Other ways to evaluate the same expressions over many orientations, each in its fastest layout.

A peer makes, of flat lists of symbols and expressions and a batch (N, n), a call that fills arrays
of its own, and a way to read them as (N, m). What is not installed is left out and named.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.motion import Motion

Array = NDArray[np.float64]
Call = Callable[[], Any]


@dataclass(frozen=True, slots=True)
class Side:
    """One way to compute a case: a call to be timed, and what it found last, (N, m)."""

    call: Call
    values: Callable[[], Array]


@dataclass(frozen=True, slots=True)
class Task:
    """Expressions in plain symbols, and the points at which they are wanted."""

    symbols: Sequence[sp.Symbol]
    expressions: Sequence[sp.Expr]
    points: Array  # (N, n)
    euler: str = ""  # the sequence, where the expressions are the matrix of Euler angles

    @property
    def columns(self) -> list[Array]:
        return [np.ascontiguousarray(column) for column in self.points.T]

    @property
    def rows(self) -> Array:
        """Room for the result, a row a component."""
        return np.empty((len(self.expressions), len(self.points)))


def in_plain_symbols(motion: Motion, name: str) -> tuple[list[sp.Symbol], list[sp.Expr]]:
    """The inputs of a quantity as symbols, and its entries in them, written out.

    The peers know nothing of functions of time and of named intermediate quantities.
    """
    step = motion.step(name)
    entries = list(step.expression)
    for known in reversed(motion.definitions):
        entries = [entry.xreplace({known.symbol: known.expression}) for entry in entries]
    arguments = [motion.argument(vector) for vector in step.quantity.inputs]
    plain = {s: sp.Symbol(n) for a in arguments for s, n in zip(a.symbols, a.names, strict=True)}
    return list(plain.values()), [entry.xreplace(plain) for entry in entries]


def _apart(function: Callable[..., Sequence[Any]], columns: Sequence[Any], size: int) -> Side:
    """A function of component arrays that gives component arrays."""

    def values() -> Array:
        return np.stack([np.broadcast_to(np.asarray(v), (size,)) for v in function(*columns)], -1)

    return Side(lambda: function(*columns), values)


def lambdify(task: Task) -> Side:
    function = sp.lambdify(task.symbols, list(task.expressions), modules="numpy")
    return _apart(function, task.columns, len(task.points))


def lambdify_cse(task: Task) -> Side:
    function = sp.lambdify(task.symbols, list(task.expressions), modules="numpy", cse=True)
    return _apart(function, task.columns, len(task.points))


def numexpr(task: Task) -> Side:
    import numexpr as ne

    ne.set_num_threads(1)
    given = dict(zip(map(str, task.symbols), task.columns, strict=True))
    texts, rows = list(map(str, task.expressions)), task.rows

    def call() -> None:
        for text, row in zip(texts, rows, strict=True):
            ne.evaluate(text, local_dict=given, global_dict={}, out=row)

    return Side(call, lambda: rows.T)


def symengine(task: Task) -> Side:
    import symengine as se

    function = se.Lambdify(list(task.symbols), list(task.expressions), cse=True)
    found = np.empty((len(task.points), len(task.expressions)))
    return Side(lambda: function(task.points, out=found), lambda: found)


def jax(task: Task) -> Side:
    function = sp.lambdify(task.symbols, list(task.expressions), modules="jax", cse=True)
    return jitted(function, task.columns)


def jitted(function: Callable[..., Any], given: Sequence[Array]) -> Side:
    """A function compiled by JAX in double precision; it gives an array, or a list of entries."""
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false")
    library: Any = import_module("jax")
    library.config.update("jax_enable_x64", True)
    compiled = library.jit(function)
    arrays = [library.numpy.asarray(array) for array in given]
    size = len(given[0])

    def values() -> Array:
        found = compiled(*arrays)
        if not isinstance(found, list):
            return np.asarray(found).reshape(size, -1)
        return np.stack([np.broadcast_to(np.asarray(entry), (size,)) for entry in found], -1)

    return Side(lambda: library.block_until_ready(compiled(*arrays)), values)


def heyoka(task: Task) -> Side:
    import heyoka as hy

    variables = hy.make_vars(*map(str, task.symbols))
    function = hy.cfunc(
        [hy.from_sympy(expression) for expression in task.expressions],
        variables if isinstance(variables, list) else [variables],
    )
    given, rows = np.array(task.columns), task.rows
    return Side(lambda: function(given, outputs=rows), lambda: rows.T)


def casadi(task: Task) -> Side:
    import casadi as ca

    names = [ca.SX.sym(str(symbol)) for symbol in task.symbols]
    entries = sp.lambdify(task.symbols, list(task.expressions), modules=ca.__dict__, cse=True)
    one = ca.Function("one", [ca.vertcat(*names)], [ca.vertcat(*entries(*names))])
    many = one.map(len(task.points))
    given = ca.DM(np.array(task.columns))
    return Side(lambda: many(given), lambda: np.array(many(given)).T)


def scipy(task: Task) -> Side:
    from scipy.spatial.transform import Rotation

    def call() -> Array:
        found: Array = Rotation.from_euler(task.euler, task.points).as_matrix()
        return found

    return Side(call, lambda: call().reshape(len(task.points), -1))


@dataclass(frozen=True, slots=True)
class Peer:
    """A library and how it is called."""

    package: str
    make: Callable[[Task], Side]

    @property
    def is_there(self) -> bool:
        return find_spec(self.package) is not None


PEERS: dict[str, Peer] = {
    "lambdify": Peer("sympy", lambdify),
    "lambdify, cse": Peer("sympy", lambdify_cse),
    "numexpr": Peer("numexpr", numexpr),
    "symengine Lambdify, cse": Peer("symengine", symengine),
    "JAX jit": Peer("jax", jax),
    "heyoka cfunc": Peer("heyoka", heyoka),
    "CasADi map": Peer("casadi", casadi),
    "SciPy from_euler": Peer("scipy", scipy),
}
