"""Length of form: `sympy.count_ops` of every quantity, beside the shortest of SymPy's own forms.

Both sides are counted alike: the sum over all entries, over the same functions of time and the
same symbols for a given angular velocity.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, astuple, dataclass

from benchmarks import sympy_forms
from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from benchmarks.sympy_forms import FACTORED, SIMPLIFIED, Survey, operations
from rigidsym.models.parametrisations import EULER_SEQUENCES, EulerAngles
from rigidsym.motion import derive

MOST_VELOCITY = 36
SYMBOLS = {
    "rotation_matrix": "R",
    "rotation_rate": "dR/dt",
    "spin_matrix": "dR/dt·Rᵀ",
    "angular_velocity_space": "Ω",
    "angular_velocity_body": "Ω′",
    "rate_matrix_space": "W",
    "inverse_rate_matrix_space": "W⁻¹",
    "rates_from_angular_velocity_space": "W⁻¹Ω",
    "rate_matrix_body": "W′",
    "inverse_rate_matrix_body": "W′⁻¹",
    "rates_from_angular_velocity_body": "W′⁻¹Ω′",
    "angular_acceleration_space": "dΩ/dt",
    "angular_acceleration_body": "dΩ′/dt",
}
VELOCITIES = ("angular_velocity_space", "angular_velocity_body")


@dataclass(frozen=True, slots=True)
class Comparison:
    """One quantity of one convention, in operations."""

    convention: str
    quantity: str
    ours: int
    sympy_raw: int
    sympy_best: int  # of what SymPy gives and its simplifiers make of it
    sympy_factored: int  # factored, collected forms too
    sympy_mixed: int  # each entry in whichever of all those forms is shortest for it
    best_form: str

    @property
    def is_longer(self) -> bool:
        return self.ours > self.sympy_best


def run(settings: Settings) -> Report:
    """The table over all conventions for which a survey of SymPy's forms is kept."""
    if settings.fresh:
        refresh(EULER_SEQUENCES)
    surveys = sympy_forms.load()
    return report([c for s in EULER_SEQUENCES if s in surveys for c in compare(s, surveys[s])])


def refresh(sequences: Iterable[str]) -> None:
    """Survey SymPy's forms anew, and keep each convention as soon as it is done."""
    surveys: dict[str, dict[str, Survey]] = {}
    for sequence in sequences:
        progress(f"SymPy's forms of {sequence}; this takes minutes")
        surveys[sequence] = sympy_forms.survey(sequence, SIMPLIFIED, FACTORED)
        sympy_forms.save(surveys)
    progress()


def compare(sequence: str, surveys: Mapping[str, Survey]) -> list[Comparison]:
    """Our quantities of one convention against SymPy's; raises where the two differ in value."""
    motion = derive(EulerAngles(sequence))
    found = []
    for quantity, theirs in surveys.items():
        expression = motion.step(quantity).expression
        if not sympy_forms.agree(sympy_forms.values(expression), theirs.values):
            raise ArithmeticError(f"{sequence} {quantity}: ours and SymPy's differ in value")
        found.append(
            Comparison(
                convention=sequence,
                quantity=quantity,
                ours=operations(expression),
                sympy_raw=theirs.raw,
                sympy_best=theirs.best.operations,
                sympy_factored=theirs.factored.operations,
                sympy_mixed=theirs.mixed,
                best_form=f"{theirs.best.source}; {theirs.best.manner}",
            )
        )
    return found


def report(comparisons: Sequence[Comparison]) -> Report:
    """The table, quantity by quantity; the data have every convention."""
    return Report(
        title="Form: operations by sympy.count_ops, summed over the entries",
        tables=(_by_quantity(comparisons),),
        figures=_figures(comparisons),
        notes=_notes(comparisons),
        data=tuple(asdict(comparison) for comparison in comparisons),
    )


def _by_quantity(comparisons: Sequence[Comparison]) -> Table:
    heads = ["quantity", "ours", "SymPy: raw", "best", "factored", "entry by entry"]
    heads += ["ours > best", "> factored", "the best form, most often"]
    rows: list[tuple[Cell, ...]] = []
    for quantity, symbol in SYMBOLS.items():
        chosen = [c for c in comparisons if c.quantity == quantity]
        if chosen:
            counts = zip(*(astuple(c)[2:-1] for c in chosen), strict=True)
            longer = sum(c.is_longer for c in chosen)
            longer_than_factored = sum(c.ours > c.sympy_factored for c in chosen)
            (form, _), *_ = Counter(c.best_form for c in chosen).most_common(1)
            rows.append((symbol, *map(_range, counts), longer, longer_than_factored, form))
    return Table(
        "By quantity, least to most over the conventions", (*map(Column, heads),), tuple(rows)
    )


def _range(values: Iterable[int]) -> str:
    found = sorted(values)
    return str(found[0]) if found[0] == found[-1] else f"{found[0]} to {found[-1]}"


def _figures(comparisons: Sequence[Comparison]) -> tuple[Figure, ...]:
    velocities = [c.ours for c in comparisons if c.quantity in VELOCITIES]
    longer = sum(c.is_longer for c in comparisons)
    pairs = len(EULER_SEQUENCES) * len(SYMBOLS)
    is_complete = len(comparisons) == pairs
    return (
        Figure(
            "Ω and Ω′, both frames, all conventions",
            f"at most {MOST_VELOCITY} operations",
            f"{_range(velocities)} operations" if velocities else "not surveyed",
            is_complete and max(velocities) <= MOST_VELOCITY,
        ),
        Figure(
            "every quantity against the best of SymPy's own forms",
            "never longer",
            f"{longer} of {len(comparisons)} longer, {pairs - len(comparisons)} not surveyed",
            is_complete and not longer,
        ),
    )


def _notes(comparisons: Sequence[Comparison]) -> tuple[str, ...]:
    kept = sympy_forms.cache_path().name
    if not comparisons:
        return (f"No survey of SymPy's forms is kept ({kept}): `benchmarks/run.py form --fresh`.",)
    return (
        f"SymPy's forms are kept in {kept}; --fresh surveys them anew, in minutes.",
        f"best: {'; '.join(SIMPLIFIED)}.",
        f"factored: those and {'; '.join(FACTORED)}.",
        "entry by entry: each entry in whichever of all these forms is shortest for it.",
    )
