"""The functions of a module against the derivation's own expressions to 50 digits."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidsym.errors import CheckError, MissingExtra, MissingTool, RigidsymError, ToolFailed
from rigidsym.kernels.accuracy.digest import digest
from rigidsym.kernels.accuracy.exact import Exact, exact_functions
from rigidsym.kernels.accuracy.measure_ways import WaySubject, way_subjects, ways_in
from rigidsym.kernels.accuracy.points import NEAREST, Points
from rigidsym.kernels.accuracy.table import Measured, Row, rounded_up
from rigidsym.kernels.accuracy.tools import caller, tool
from rigidsym.kernels.accuracy.truth import Truth, precise
from rigidsym.kernels.conversions.conversions import in_closed_form
from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.lowering.derivatives import Asked, Derivative, derivatives_of, read_requests
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.rounding import used_plainly
from rigidsym.kernels.module import generate
from rigidsym.kernels.targets import TARGETS
from rigidsym.kernels.targets.singular import calls_of, guards_of, kinds
from rigidsym.mechanics.derivation import Derivation

POINTS = 1000
_CHUNK = 500  # points whose numbers of 50 digits are held at once

Array = NDArray[Any]
Report = Callable[[float], object]  # takes the share of the true values that is there
Missing = Callable[[str, RigidsymError], object]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Values:
    """What a function should give, (count, entries)."""

    high: Array  # the nearest doubles
    low: Array  # what they leave
    size: Array  # (count,), of the largest entry: of its terms, added up as if all were positive

    def at(self, some: Array) -> _Values:
        return _Values(high=self.high[some], low=self.low[some], size=self.size[some])


@dataclass(frozen=True, kw_only=True, slots=True)
class _Subject:
    """One function, and where it is measured."""

    kernel: Kernel
    exact: Exact
    points: Points
    truth: _Values

    @property
    def name(self) -> str:
        return self.kernel.name

    @property
    def arrays(self) -> list[Array]:
        vectors = {vector.name: vector for vector in self.exact.vectors}
        return [self.points.of(vectors[argument.name]) for argument in self.kernel.arguments]

    @property
    def is_meant(self) -> Array:
        """Which points count: near poles, where one sine or cosine alone divides or vanishes."""
        calls = {call.function for call in calls_of(self.kernel).values()}
        loses = "sqrt" in calls or not {"angle"}.issuperset(kinds(self.kernel))
        has_value = np.isfinite(self.truth.high).all(axis=1)
        return has_value & ~(self.points.is_near & loses)

    @property
    def nearest(self) -> float:
        is_near = bool(guards_of(self.kernel)) and (self.is_meant & self.points.is_near).any()
        return NEAREST if is_near else 0.0

    def errors(self, target: str, module: ModuleType) -> tuple[float, ...]:
        """In double precision, and in single where the target has it."""
        call = caller(target, getattr(module, self.name))
        arrays, everywhere = self.arrays, np.ones(self.points.count, bool)
        found = [_error(self, target, call(*arrays), everywhere)]
        if target == "numpy":  # the twin on floats is the same text for numba and c
            twin = getattr(module, f"{self.name}_scalar")
            rows = np.hstack(arrays).tolist()
            values = np.array([twin(*row) for row in rows]).reshape(len(rows), -1)
            found[0] = max(found[0], _error(self, target, values, everywhere))
        if TARGETS[target].has_single:
            is_single = self.points.is_single
            single = [array[is_single].astype(np.float32) for array in arrays]
            found.append(_error(self, target, call(*single), is_single))
        return tuple(map(rounded_up, found))

    def row(self, errors: Mapping[str, tuple[float, ...]]) -> Row:
        return Row(
            digest=digest(self.kernel),
            points=int(self.is_meant.sum()),
            reach=self.points.reach,
            nearest=self.nearest,
            function=f"{self.points.derivation.name} {self.kernel.name}",
            errors=errors,
        )


def measure(
    derivation: Derivation,
    targets: Collection[str],
    *,
    derivatives: Asked = (),
    conversions: bool = False,
    count: int = POINTS,
    known: Collection[str] = (),
    report: Report | None = None,
    missing: Missing | None = None,
) -> Measured:
    """The largest errors of all functions but those with a digest that is known.

    Where a target cannot be loaded here, raises MissingTool, MissingExtra or ToolFailed, or hands
    it to `missing` and leaves the target out. Raises CheckError for a function that gives NaN
    where it should give a number.
    """
    parts = _parts(derivation, derivatives, conversions=conversions)
    subjects: list[_Subject | WaySubject] = [
        s for part in parts for s in _subjects(*part, count, known, report)
    ]
    if conversions:
        ways = [way for way in ways_in(derivation) if way.digest not in known]
        subjects += way_subjects(derivation, ways, count)
    found: dict[str, dict[str, tuple[float, ...]]] = {s.name: {} for s in subjects}
    tools = {}
    for target in targets:
        made = generate(derivation, target, derivatives=derivatives, conversions=conversions)
        try:
            module, tools[target] = made.load(), tool(target)
        except (MissingTool, MissingExtra, ToolFailed) as error:
            if missing is None:
                raise
            missing(target, error)
            continue
        for subject in subjects:
            if hasattr(module, subject.name):  # a target may leave conversions out
                found[subject.name][target] = subject.errors(target, module)
    rows = [subject.row(found[subject.name]) for subject in subjects]
    return Measured(tools=tools, rows={row.digest: row for row in rows})


def kernels_of(
    derivation: Derivation, *, derivatives: Asked = (), conversions: bool = False
) -> Iterator[Kernel]:
    """All that are measured."""
    for part, wanted in _parts(derivation, derivatives, conversions=conversions):
        yield from lower(part, derivatives=wanted).kernels


def _parts(
    derivation: Derivation, derivatives: Asked, *, conversions: bool
) -> Iterator[tuple[Derivation, Sequence[Derivative]]]:
    """Derivations, each with points of its own, and the derivatives that are asked for."""
    yield derivation, derivatives_of(derivation, read_requests(derivatives))
    if conversions:
        from rigidsym.mechanics.conversions.conversions import conversions_of

        yield in_closed_form(derivation, conversions_of(derivation.model)), ()


def _subjects(
    derivation: Derivation,
    wanted: Sequence[Derivative],
    count: int,
    known: Collection[str],
    report: Report | None,
) -> Iterator[_Subject]:
    kernels = lower(derivation, derivatives=wanted).kernels
    functions = {function.name: function for function in exact_functions(derivation, wanted)}
    chosen = [kernel for kernel in kernels if digest(kernel) not in known]
    vectors = {v.name: v for kernel in chosen for v in functions[kernel.name].vectors}
    points = Points(
        derivation=derivation,
        vectors=tuple(vectors.values()),
        count=count,
        is_large=_takes_angles_alone(derivation, kernels),
    )
    truths = _truths([functions[kernel.name] for kernel in chosen], points, report)
    for kernel in chosen:
        exact = functions[kernel.name]
        yield _Subject(kernel=kernel, exact=exact, points=points, truth=truths[kernel.name])


def _takes_angles_alone(derivation: Derivation, kernels: Iterable[Kernel]) -> bool:
    """Whether all that is done with coordinates is to take the sine and cosine of angles."""
    for kernel in kernels:
        plain = used_plainly(kernel)
        if any(a.name == "q" and not plain.isdisjoint(a.components) for a in kernel.arguments):
            return False
    return set(derivation.model.coordinate_units) == {"rad"}


def _truths(
    functions: Collection[Exact], points: Points, report: Report | None
) -> dict[str, _Values]:
    """What each function should give, piece by piece."""
    found: dict[str, list[_Values]] = {function.name: [] for function in functions}
    for start in range(0, points.count if functions else 0, _CHUNK):
        some = slice(start, start + _CHUNK)
        truth = Truth({s: values[some] for s, values in points.values.items()}, precise())
        for function in functions:
            found[function.name].append(_values(function, truth))
        if report is not None:
            report(min(1.0, (start + _CHUNK) / points.count))
    return {name: _joined(pieces) for name, pieces in found.items()}


def _values(function: Exact, truth: Truth) -> _Values:
    exact = np.stack([truth.of(entry) for entry in function.entries], axis=-1)
    high = exact.astype(float)
    with np.errstate(invalid="ignore"):  # what has no value is no number less itself
        low = (exact - high).astype(float)
    sizes = np.array([truth.size(entry) for entry in function.terms])
    return _Values(high=high, low=low, size=sizes.max(axis=0))


def _joined(pieces: Sequence[_Values]) -> _Values:
    return _Values(
        high=np.concatenate([piece.high for piece in pieces]),
        low=np.concatenate([piece.low for piece in pieces]),
        size=np.concatenate([piece.size for piece in pieces]),
    )


def _error(subject: _Subject, target: str, values: Array, where: Array) -> float:
    """The largest at any point, in eps of the values' type and of the size of what is added."""
    is_nan = np.isnan(values).any(axis=1)
    is_meant = subject.is_meant[where]
    allowed = ~subject.points.is_plain[where] & bool(guards_of(subject.kernel))
    if (is_meant & is_nan & ~allowed).any():
        raise CheckError(
            f"{subject.points.derivation.name}: {subject.kernel.name} for {target} gives NaN "
            "where there is a value"
        )
    counts = is_meant & ~is_nan
    truth = subject.truth.at(where).at(counts)
    off = np.abs((values[counts] - truth.high) - truth.low).max(axis=1)
    relative = off / np.where(truth.size > 0, truth.size, 1.0)
    return float(relative.max(initial=0.0)) / float(np.finfo(values.dtype).eps)
