"""Bounds on rounding as the kernels state them, as Gappa proves them, and measured.

Each kernel becomes a Gappa script: its operations as they are written, rounded in double or in
single precision, beside the same operations on real numbers. The hypotheses are those of the
generated modules: sines and cosines of at most one and within 1.1 eps, functions c_k within their
own error, exact inputs. Gappa (Daumas and Melquiond, ACM TOMS 37(1), 2010) bounds every entry.
`rigidBody1` and `rigidBody2` of FPBench stand beside the bounds of FPTaylor (Solovyev, Baranowski,
Briggs, Jacobsen, Rakamarić and Gopalakrishnan, ACM TOPLAS 41(1), 2018).
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from fractions import Fraction
from functools import reduce

import mpmath as mp
import numpy as np
import sympy as sp

from benchmarks.measure import Settings, progress
from benchmarks.report import Column, Figure, Report, Table
from rigidsym.kernels.ir import (
    Call,
    Expression,
    Kernel,
    KernelArgument,
    Name,
    Negative,
    Number,
    Product,
    Sum,
)
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.rounding import (
    SINE,
    Bounded,
    entire_bounds,
    largest_error,
    numbers_and_angles,
    rounding,
)
from rigidsym.models.library import PARAMETRISATIONS, rotation_from
from rigidsym.models.parametrisations import EULER_SEQUENCES
from rigidsym.motion import Motion, derive

BITS = {64: 52, 32: 23}  # of a float, in all: eps is two to minus this
CHAINS = ("z(phi) [1,2,2](theta)", "z(2*phi-psi) x(theta)", "z(phi) x(theta/2) z(psi)")
# By FPTaylor: benchmarks/real2float/results.txt, config-b, in github.com/soarlab/FPTaylor (efbbc83)
PUBLISHED = {"rigidBody1": 2.95e-13, "rigidBody2": 3.61e-11}
RANGE = 15.0  # of their inputs, which are rounded
_SCALES = {str(2**k) for k in range(8)} | {float(0.5**k).hex() for k in range(8)}  # exact factors
_AND = " /\\ "


class Script:
    """A kernel for Gappa: v_x is the computed value of x, and e_x the exact one."""

    def __init__(
        self, kernel: Kernel, bits: int, inputs: Mapping[str, Bounded], angles: Collection[str]
    ) -> None:
        self.eps = 0.5 ** BITS[bits]
        self.lines = [f"@rnd = float<ieee_{bits}, ne>;"]
        self.given: list[str] = []
        self.hints: list[str] = []
        self._angles = {*angles, *kernel.components} - inputs.keys()  # exact, and of any size
        for name, bound in inputs.items():
            self.lines.append(f"v_{name} = rnd(r_{name});")
            self.lines.append(f"e_{name} = {'r' if bound.error else 'v'}_{name};")
            self._at_most(f"r_{name}", bound.size)
        for assignment in kernel.assignments:
            if assignment.name not in angles:
                self._assign(assignment.name, assignment.value)
        outputs = dict.fromkeys(o.operand if isinstance(o, Negative) else o for o in kernel.outputs)
        names = {f"out{k}": out for k, out in enumerate(outputs) if not isinstance(out, Number)}
        for name, value in names.items():
            self._assign(name, value)
        goals = [f"|v_{name} - e_{name}| in ?" for name in names]
        claim = f"{{ {_AND.join(self.given)} -> {_AND.join(goals)} }}"
        self.text = "\n".join([*self.lines, claim, *self.hints])

    def _at_most(self, text: str, bound: float) -> None:
        self.given.append(f"|{text}| <= {bound.hex()}")

    def _assign(self, name: str, value: Expression) -> None:
        if isinstance(value, Call) and value.function != "abs":
            self._call(name, value)
        else:
            self.lines += [f"{form}_{name} = {self._text(value, form)};" for form in "ve"]

    def _call(self, name: str, call: Call) -> None:
        """A float near t_x, the exact function of the computed argument; a mean slope s_x leads
        to e_x, the exact function of the exact argument."""
        argument, order = call.argument.text, call.order
        size, slope, own = (1.0, 1.0, SINE) if order is None else entire_bounds(order)
        self.lines.append(f"v_{name} = rnd(r_{name});")
        if argument in self._angles:
            self.lines.append(f"e_{name} = t_{name};")
        else:
            root = "" if order is None else f" + v_{argument} * d_{name}"  # the rounded n
            moved = f"s_{name} * ((v_{argument} - e_{argument}){root})"
            self.lines.append(f"e_{name} = t_{name} - {moved};")
            self.hints.append(f"v_{name} - e_{name} -> (v_{name} - t_{name}) + {moved};")
            self._at_most(f"s_{name}", slope)
            if root:
                self._at_most(f"d_{name}", self.eps)
        for form in "ve":
            self._at_most(f"{form}_{name}", size)
        self._at_most(f"v_{name} - t_{name}", own * size * self.eps)

    def _text(self, expression: Expression, form: str) -> str:
        """From left to right; the computed form rounds after every operation."""

        def joined(one: str, sign: str, two: str) -> str:
            is_exact = form == "e" or (sign != "+" and not _SCALES.isdisjoint((one, two)))
            return f"({one} {sign} {two})" if is_exact else f"rnd({one} {sign} {two})"

        def chained(parts: Iterable[Expression], sign: str) -> str:
            return reduce(
                lambda one, two: joined(one, sign, two), (self._text(p, form) for p in parts)
            )

        match expression:
            case Name(text):
                return f"{form}_{text}"
            case Number(value):
                return self._number(value, form)
            case Negative(operand):
                return f"(-{self._text(operand, form)})"
            case Call("abs", argument):
                return f"{form}_{argument.text}"  # whose error is no smaller
            case Sum(terms):
                return chained(terms, "+")
            case Product(factors, divisors):
                above = chained(factors, "*")
                return joined(above, "/", chained(divisors, "*")) if divisors else above
        raise TypeError(f"{expression} has no form for Gappa")

    def _number(self, value: Fraction | float, form: str) -> str:
        if isinstance(value, Fraction):
            if Fraction(float(np.float32(float(value)))) == value:
                return str(value) if value.denominator == 1 else float(value).hex()
            ratio = f"({value.numerator} / {value.denominator})"
            return f"rnd{ratio}" if form == "v" else ratio
        name = f"number{abs(hash(value))}"  # an irrational number near a double
        self._at_most(f"{name} - {value.hex()}", abs(value) * 2.0**-53)
        return f"rnd({value.hex()})" if form == "v" else name


def proved(script: str) -> list[float]:
    """The bounds that Gappa proves, one for each goal; raises RuntimeError where it fails."""
    done = subprocess.run(["gappa"], input=script, capture_output=True, text=True, check=False)
    found = re.findall(r"\| in \[0, (\d+)(?:b(-?\d+))?", done.stdout + done.stderr)
    if done.returncode or len(found) != script.count(" in ?"):
        raise RuntimeError(f"Gappa proves {len(found)} goals only: {done.stderr}\n{script}")
    return [float(int(whole) * Fraction(2) ** int(power or 0)) for whole, power in found]


def gappa_bound(kernel: Kernel, bits: int = 64) -> float:
    """In eps, of the largest entry, under the hypotheses of `rounding`."""
    plain, angles = numbers_and_angles(kernel)
    inputs = dict.fromkeys(sorted(plain), Bounded(1.0, 0.0))
    return max(proved(Script(kernel, bits, inputs, angles).text)) * 2.0 ** BITS[bits]


def rigid_body(name: str) -> Kernel:
    """A benchmark of FPBench, after Darulova and Kuncak (POPL 2014), from left to right."""
    a, b, c = map(Name, ("x1", "x2", "x3"))
    two, three = (Number(Fraction(n)) for n in (2, 3))

    def less(*factors: Expression) -> Negative:
        return Negative(Product(factors))

    square = Product((three, c, c))
    total = {
        "rigidBody1": Sum((less(a, b), less(two, b, c), Negative(a), Negative(c))),
        "rigidBody2": Sum(
            (Product((two, a, b, c)), square, less(b, a, b, c), square, Negative(b)),
        ),
    }[name]
    x = KernelArgument(
        name="x", components=("x1", "x2", "x3"), units=("",) * 3, about="", shape=(3,)
    )
    return Kernel(name=name, arguments=(x,), assignments=(), outputs=(total,), shape=())


def peers() -> Iterator[tuple[str, float, float, float]]:
    """Of each: the analysis of `rounding`, Gappa's bound and FPTaylor's, all absolute."""
    for name, published in PUBLISHED.items():
        kernel = rigid_body(name)
        inputs = dict.fromkeys(kernel.components, Bounded.rounded(RANGE))
        eps = 0.5 ** BITS[64]
        stated = largest_error(kernel, inputs) * eps
        yield name, stated, max(proved(Script(kernel, 64, inputs, ()).text)), published


def bounded_kernels(motion: Motion) -> Iterator[tuple[Kernel, float]]:
    """The kernels that state a bound above zero, with that bound in eps."""
    for kernel in lower(motion).kernels:
        bound = rounding(kernel)
        if bound is not None and bound.error:
            yield kernel, bound.error


def measured(motion: Motion, kernel: Kernel, samples: int) -> float:
    """The largest error of the NumPy kernel in eps, at random points against 50 digits."""
    random = np.random.default_rng(6)
    plain, _ = numbers_and_angles(kernel)
    given = [
        random.uniform(-1, 1, (samples, len(a.components)))
        * (1.0 if plain.intersection(a.components) else 1e4)
        for a in kernel.arguments
    ]
    step = next((step for step in motion.steps if step.quantity.name == kernel.name), None)
    if step is None:  # the margin
        return 0.0
    symbols = [s for name in step.quantity.inputs for s in motion.argument(name).symbols]
    entries = sp.flatten(motion.spelled(step.expression))
    with mp.workdps(50):
        exact = sp.lambdify(symbols, entries, "mpmath")
        found = getattr(motion.kernels("numpy").load(), kernel.name)(*given)
        rows = zip(found.reshape(samples, -1).tolist(), np.hstack(given).tolist(), strict=True)
        errors = (
            abs(mp.mpf(value) - true)
            for values, point in rows
            for value, true in zip(values, exact(*map(mp.mpf, point)), strict=True)
        )
        return float(max(errors)) * 2.0 ** BITS[64]


@dataclass(frozen=True, slots=True)
class Row:
    """What is known of one kernel, in eps."""

    rotation: str
    kernel: str
    stated: float
    double: float  # Gappa's bound
    single: float
    measured: float

    @property
    def is_proved(self) -> bool:
        return self.measured <= max(self.double, self.single) <= self.stated


def run(settings: Settings) -> Report:
    """All kernels that state a bound, of all rotations."""
    rows: list[Row] = []
    for text in (*EULER_SEQUENCES, *PARAMETRISATIONS, *CHAINS):
        motion = derive(rotation_from(text))
        for kernel, stated in bounded_kernels(motion):
            progress(f"{text}: {kernel.name}")
            double, single = (gappa_bound(kernel, bits) for bits in BITS)
            error = measured(motion, kernel, settings.samples)
            rows.append(Row(text, kernel.name, stated, double, single, error))
    progress()
    return report(rows, list(peers()))


def report(rows: Sequence[Row], others: Sequence[tuple[str, float, float, float]]) -> Report:
    columns = (
        Column("rotation"),
        Column("kernel"),
        Column("stated", ".1f"),
        Column("Gappa, double", ".2f"),
        Column("Gappa, single", ".2f"),
        Column("measured", ".2f"),
    )
    covered = sum(row.is_proved for row in rows)
    loose = max(row.stated - max(row.double, row.single) for row in rows)
    heads = ("this analysis", "Gappa", "FPTaylor, published")
    return Report(
        title="Bounds on rounding: stated by the kernels, proved by Gappa, measured",
        tables=(
            Table("In eps, of any entry", columns, tuple(map(astuple, rows))),
            Table(
                "FPBench, absolute, for rounded inputs in [-15, 15]",
                (Column("benchmark"), *(Column(head, ".2e") for head in heads)),
                tuple(others),
            ),
        ),
        figures=(
            Figure(
                "kernels whose stated bound Gappa proves, above what is measured",
                "all",
                f"{covered} of {len(rows)}; {loose:.2f} eps at most above Gappa's",
                covered == len(rows),
            ),
            Figure(
                "bounds of FPBench's rigid bodies",
                "within 1 % of FPTaylor's",
                ", ".join(f"{name} {stated:.3g}" for name, stated, *_ in others),
                all(stated <= 1.01 * published for _, stated, _, published in others),
            ),
        ),
    )
