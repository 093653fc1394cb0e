"""Random chains of turns against SciPy: `python benchmarks/run.py chains --files 1000`.

Every chain is another rotation of one to six turns. rigidsym derives and proves R(q), and SciPy
composes the same rotation from the vectors of its turns, at 50 sets of random angles. For every
20th chain, Ω′ is compared with SciPy's rotations between instants. With `--resume FILE`, the whole
campaign runs in slices, after each of which FILE holds what was found.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from functools import reduce
from operator import mul
from pathlib import Path
from random import Random

import numpy as np
import sympy as sp
from scipy.spatial.transform import Rotation

from benchmarks.measure import Settings, progress
from benchmarks.report import Column, Figure, Report, Table
from rigidsym.errors import LimitReached
from rigidsym.models.rotation import TIME
from rigidsym.models.rotation_text import rotation_from
from rigidsym.motion import derive

WHOLE = 100_000
POINTS = 50  # sets of angles at which each R is compared
SLICE = 100  # chains between two writings of the file
VELOCITY_OF = 20  # one chain in so many is asked for its angular velocity
STEP = 1e-3  # seconds between the instants of a finite difference
LONGEST = 6  # turns
SECONDS = 20.0  # of one derivation
EPS = float(np.finfo(float).eps)
FAR = 64.0  # eps: sums of up to four angles of size π are rounded before their sine is taken
FAR_VELOCITY = 1e-8  # of the largest component; a difference of fourth order is less exact
DIRECTIONS = ("1,2,2", "2,-3,6", "0,3,-4", "-1,4,8", "1,1,0", "1,-1,1", "1,2,-3")
Values = Mapping[str, np.ndarray]  # by the names of coordinates and constants, (POINTS,) each
SEQUENCES = [a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if a != b != c]


@dataclass(frozen=True)
class Angle:
    """A rational combination of coordinates and constants, and a part of π."""

    terms: Mapping[str, Fraction]
    pi: Fraction = Fraction(0)

    def __str__(self) -> str:
        parts = [f"({c})*{name}" if c != 1 else name for name, c in self.terms.items()]
        return " + ".join([*parts, *([f"({self.pi})*pi"] if self.pi else [])])

    def at(self, values: Values) -> np.ndarray:
        terms = [float(c) * values[name] for name, c in self.terms.items()]
        total: np.ndarray = np.sum([*terms, np.full(POINTS, float(self.pi) * math.pi)], axis=0)
        return total


@dataclass(frozen=True)
class Chain:
    """What rigidsym reads, and the same turns as SciPy takes them."""

    text: str
    axes: tuple[tuple[float, ...], ...]
    angles: tuple[Angle, ...]
    names: tuple[str, ...] | None = None  # of the coordinates of an Euler sequence
    passive: bool = False
    extrinsic: bool = False  # about the axes of space: each turn is multiplied from the left

    def __str__(self) -> str:
        return f"{self.text} {self.names or ''}{' passive' if self.passive else ''}"

    def by_scipy(self, values: Values) -> Rotation:
        turns = [
            Rotation.from_rotvec(np.outer(angle.at(values), np.divide(axis, np.linalg.norm(axis))))
            for axis, angle in zip(self.axes, self.angles, strict=True)
        ]
        return reduce(mul, reversed(turns) if self.extrinsic else turns)


def random_chain(rng: Random) -> Chain:
    """One to six turns, one of which at least moves."""
    passive = rng.random() < 0.2
    if rng.random() < 0.1:
        return _sequence(rng, passive)
    while True:
        angles = tuple(_angle(rng, k) for k in range(rng.randint(1, LONGEST)))
        if any(not name.endswith("0") for angle in angles for name in angle.terms):
            break
    axes = [rng.choice("xyz") if rng.random() < 0.85 else rng.choice(DIRECTIONS) for _ in angles]
    labels = [axis if axis in "xyz" else f"[{axis}]" for axis in axes]
    text = " ".join(f"{label}({angle})" for label, angle in zip(labels, angles, strict=True))
    return Chain(text, tuple(map(_components, axes)), angles, passive=passive)


def _components(axis: str) -> tuple[float, ...]:
    return (
        tuple(float(axis == e) for e in "xyz")
        if axis in "xyz"
        else tuple(map(float, axis.split(",")))
    )


def _sequence(rng: Random, passive: bool) -> Chain:
    """Euler angles: small letters are turns about the axes of space."""
    sequence = rng.choice(SEQUENCES)
    names = tuple(f"{letter}_{rng.randrange(1, 1000)}" for letter in "abc")
    extrinsic = rng.random() < 0.5
    return Chain(
        sequence if extrinsic else sequence.upper(),
        tuple(map(_components, sequence)),
        tuple(Angle({name: Fraction(1)}) for name in names),
        names,
        passive,
        extrinsic,
    )


def _angle(rng: Random, place: int) -> Angle:
    """A coordinate, a sum of several, a constant, or a constant part of π."""
    kind, own = rng.random(), f"{rng.choice('abc')}_{place + 1}"
    if kind < 0.55:
        return Angle({own: Fraction(1)})
    if kind < 0.75:
        other = f"{rng.choice('abc')}_{rng.randint(1, LONGEST)}"
        part = Fraction(rng.randint(0, 5), rng.choice((1, 2, 3, 4, 6)))
        return Angle({own: _factor(rng), other: _factor(rng)}, part)
    if kind < 0.9:
        return Angle(
            {}, Fraction(rng.choice((1, 2, 3, 5, 7, -1, -5)), rng.choice((2, 3, 4, 6, 12)))
        )
    return Angle({f"{rng.choice('abc')}_{place + 1}_0": _factor(rng)})


def _factor(rng: Random) -> Fraction:
    return rng.choice((1, 1, 1, 2, -1, -1, -2, 3, Fraction(1, 2))) * Fraction(1)


@dataclass
class Findings:
    """What became of the chains so far."""

    chains: int = 0
    compared: int = 0  # R at random angles
    turns: int = 0
    velocities: int = 0
    farthest: float = 0.0  # eps
    farthest_at: str = ""
    farthest_velocity: float = 0.0
    stopped: list[str] = field(default_factory=list)  # by the limit on time
    failures: list[str] = field(default_factory=list)


def differences(chain: Chain, rng: Random, with_velocity: bool) -> tuple[float, float]:
    """The largest difference of R in eps, and that of Ω′ relative to its largest component."""
    model = rotation_from(chain.text, names=chain.names, passive=chain.passive)
    wanted = ["rotation_matrix", "angular_velocity_body"] if with_velocity else ["rotation_matrix"]
    motion = derive(model, wanted, timeout=SECONDS)
    names = sorted({name for angle in chain.angles for name in angle.terms})
    numbers = np.random.default_rng(rng.randrange(2**32))
    values = {name: numbers.uniform(-math.pi, math.pi, POINTS) for name in names}
    turned = chain.by_scipy(values)
    expected = (turned.inv() if chain.passive else turned).as_matrix()
    far = float(np.abs(evaluated(motion.rotation_matrix, values) - expected).max()) / EPS
    if not with_velocity:
        return far, 0.0
    rates = {name: numbers.uniform(-2, 2, POINTS) * (not name.endswith("0")) for name in names}
    velocity = evaluated(motion.angular_velocity_body, values, rates)[..., 0]
    stepped = by_difference(chain, values, rates)
    return far, float(np.abs(velocity - stepped).max() / max(1.0, np.abs(stepped).max()))


def by_difference(chain: Chain, values: Values, rates: Values) -> np.ndarray:
    """Ω′ in body components, (POINTS, 3), from SciPy's rotations at four instants."""
    instants = (
        chain.by_scipy({name: values[name] + k * STEP * rates[name] for name in values})
        for k in (-2, -1, 1, 2)
    )
    first, second, third, fourth = instants
    outer, inner = (first.inv() * fourth).as_rotvec(), (second.inv() * third).as_rotvec()
    velocity: np.ndarray = (8 * inner - outer) / (12 * STEP)
    return velocity


def evaluated(matrix: sp.MatrixBase, values: Values, rates: Values | None = None) -> np.ndarray:
    """A matrix of expressions in numbers, (POINTS, rows, columns).

    Each expression in it is computed once.
    """
    known: dict[sp.Basic, np.ndarray] = {}
    for name in values:
        function = sp.Function(name)(TIME)
        known |= {sp.Symbol(name): values[name], function: values[name]}
        if rates is not None:
            known[sp.Derivative(function, TIME)] = rates[name]

    def value(expression: sp.Basic) -> np.ndarray:
        if expression not in known:
            if expression.is_number and expression.is_Atom:
                known[expression] = np.full(POINTS, float(expression))
            else:
                known[expression] = _ACTIONS[expression.func](*map(value, expression.args))
        return known[expression]

    return np.array([value(entry) for entry in matrix]).T.reshape(-1, *matrix.shape)


_ACTIONS: dict[type, Callable[..., np.ndarray]] = {
    sp.Add: lambda *parts: np.sum(parts, axis=0),
    sp.Mul: lambda *parts: np.prod(parts, axis=0),
    sp.Pow: np.power,
    sp.sin: np.sin,
    sp.cos: np.cos,
}


def campaign(count: int, found: Findings | None = None) -> Findings:
    """So many chains more; the number of a chain makes it again."""
    found = found or Findings()
    for number in range(found.chains, found.chains + count):
        progress(f"chain {number + 1}")
        rng = Random(f"chain:{number}")
        chain, with_velocity = random_chain(rng), number % VELOCITY_OF == 0
        found.chains += 1
        try:
            far, off = differences(chain, rng, with_velocity)
        except LimitReached:
            found.stopped.append(f"chain:{number}: {chain}")
            continue
        except Exception as error:  # of any kind: either the chain or the package is at fault
            found.failures.append(f"chain:{number}: {chain}: {error!r}")
            continue
        found.compared += POINTS
        found.turns += len(chain.angles)
        found.velocities += with_velocity * POINTS
        if far > found.farthest:
            found.farthest, found.farthest_at = far, f"chain:{number}: {chain}"
        found.farthest_velocity = max(found.farthest_velocity, off)
        if not (far <= FAR and off <= FAR_VELOCITY):
            found.failures.append(f"chain:{number}: {chain}: R {far:.1f} eps, Ω′ {off:.1e}")
    progress()
    return found


def _resumed(file: Path) -> Findings:
    """The whole campaign, from where the file ends."""
    found = Findings(**json.loads(file.read_text("utf-8"))) if file.is_file() else Findings()
    while found.chains < WHOLE:
        campaign(SLICE, found)
        draft = file.with_name(f"{file.name}.draft")
        draft.write_text(json.dumps(asdict(found), indent=1), "utf-8")
        draft.replace(file)
    return found


def run(settings: Settings) -> Report:
    """As many chains as asked for."""
    file = settings.resume
    return report(campaign(settings.files) if file is None else _resumed(file))


def report(found: Findings) -> Report:
    distinct = len({str(random_chain(Random(f"chain:{n}"))) for n in range(found.chains)})
    stopped = len(found.stopped)
    counts = (found.chains, distinct, stopped, found.turns, found.compared, found.velocities)
    heads = ("chains", "distinct", "stopped", "turns", "R compared", "Ω′ compared")
    columns = (*map(Column, heads), Column("R, eps", ".1f"), Column("Ω′", ".1e"))
    row = (*counts, found.farthest, found.farthest_velocity)
    return Report(
        title="Random chains against SciPy",
        tables=(Table("Largest differences of R and of Ω′", columns, (row,)),),
        figures=(Figure("failures", "none", str(len(found.failures)), not found.failures),),
        notes=(f"largest at {found.farthest_at}", *found.stopped, *found.failures),
    )
