"""Length of energies and momenta: `sympy.count_ops` beside `RigidBody`'s after `simplify`.

24 conventions, and bodies with three, two and one principal moment. What SymPy gives is kept in a
file; `--fresh` surveys it anew, in a quarter of an hour.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from benchmarks import sympy_energy
from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table
from benchmarks.sympy_energy import BODIES, MOMENTS
from benchmarks.sympy_forms import agree, operations, values
from rigidsym.models.body import principal_moments
from rigidsym.models.euler_angles import EULER_SEQUENCES, EulerAngles
from rigidsym.motion import derive

SYMBOLS = {
    "rotational_energy": "E_R",
    "angular_momentum_rotation_body": "L′_R",
    "angular_momentum_rotation": "L_R",
}


@dataclass(frozen=True, slots=True)
class Comparison:
    """One quantity of one body in one convention, in operations."""

    convention: str
    body: str
    quantity: str
    ours: int
    raw: int
    simplified: int  # after `simplify`
    best: int  # of SymPy's forms, `simplify` among them


def run(settings: Settings) -> Report:
    """The table over all conventions and bodies of which a survey is kept."""
    if settings.fresh:
        refresh()
    surveys = sympy_energy.load()
    found = [
        comparison
        for sequence in EULER_SEQUENCES
        for body in BODIES
        if body in surveys.get(sequence, {})
        for comparison in compare(sequence, body, surveys[sequence][body])
    ]
    return report(found)


def refresh() -> None:
    """Survey SymPy's forms anew, and keep each convention as soon as it is done."""
    surveys: dict[str, dict[str, dict[str, sympy_energy.Survey]]] = {}
    for sequence in EULER_SEQUENCES:
        progress(f"SymPy's energies of {sequence}; this takes minutes")
        surveys[sequence] = {body: sympy_energy.survey(sequence, body) for body in BODIES}
        sympy_energy.save(surveys)
    progress()


def compare(sequence: str, body: str, surveys: dict[str, sympy_energy.Survey]) -> list[Comparison]:
    """Our quantities against SymPy's; raises where the two differ in value."""
    motion = derive(EulerAngles(sequence), list(SYMBOLS), body=principal_moments(*BODIES[body]))
    found = []
    for quantity, theirs in surveys.items():
        expression = motion.step(quantity).expression
        if not agree(values(expression.xreplace(MOMENTS)), theirs.values):
            raise ArithmeticError(f"{sequence} {body} {quantity}: the two differ in value")
        counts = (operations(expression), theirs.raw, theirs.simplified, theirs.best.operations)
        found.append(Comparison(sequence, body, quantity, *counts))
    return found


def report(comparisons: Sequence[Comparison]) -> Report:
    """The tables, by body and quantity and by convention."""
    pairs = len(EULER_SEQUENCES) * len(BODIES) * len(SYMBOLS)
    longer = sum(c.ours > min(c.simplified, c.best) for c in comparisons)
    return Report(
        title="Energy and momentum: operations by sympy.count_ops",
        tables=(_by_quantity(comparisons), _by_convention(comparisons)),
        figures=(
            Figure(
                "E_R and L_R against SymPy's RigidBody after simplify",
                "never longer",
                f"{longer} of {len(comparisons)} longer, {pairs - len(comparisons)} not surveyed",
                len(comparisons) == pairs and not longer,
            ),
        ),
        notes=(f"SymPy's forms are kept in {sympy_energy.cache_path().name}.",),
        data=tuple(asdict(comparison) for comparison in comparisons),
    )


def _by_quantity(comparisons: Sequence[Comparison]) -> Table:
    columns = ("body", "quantity", "ours", "SymPy: raw", "after simplify", "best", "ours > best")
    rows: list[tuple[Cell, ...]] = []
    for body in BODIES:
        for quantity, symbol in SYMBOLS.items():
            chosen = [c for c in comparisons if (c.body, c.quantity) == (body, quantity)]
            if chosen:
                ranges = (
                    _range([getattr(c, kind) for c in chosen])
                    for kind in ("ours", "raw", "simplified", "best")
                )
                longer = sum(c.ours > min(c.simplified, c.best) for c in chosen)
                rows.append((body, symbol, *ranges, longer))
    heading = "By body and quantity, least to most over the conventions"
    return Table(heading, tuple(map(Column, columns)), tuple(rows))


def _range(found: Sequence[int]) -> str:
    least, most = min(found), max(found)
    return str(least) if least == most else f"{least} to {most}"


def _by_convention(comparisons: Sequence[Comparison]) -> Table:
    heads = [(body, quantity) for body in BODIES for quantity in SYMBOLS]
    cells = {(c.convention, c.body, c.quantity): f"{c.ours}/{c.simplified}" for c in comparisons}
    conventions = tuple(dict.fromkeys(c.convention for c in comparisons))
    rows = tuple((s, *(cells.get((s, *head)) for head in heads)) for s in conventions)
    names = (Column(f"{body[:3]}. {SYMBOLS[quantity]}") for body, quantity in heads)
    return Table("By convention, ours/after simplify", (Column("convention"), *names), rows)
