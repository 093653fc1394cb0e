"""The section of a note that says what was claimed, and what became of each claim."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidsym.mechanics.derivation import Proof
from rigidsym.notes.document import (
    Block,
    Equation,
    EquationReference,
    Paragraph,
    Strong,
    Table,
    Text,
)
from rigidsym.notes.entries import RESIDUAL, indexed
from rigidsym.notes.prose import proofs_in_words

Claim = tuple[str, Proof]  # the label of an equation, and what was claimed there
_ROWS = 34  # of a table on one page


def claims_in_a_table(claims: Sequence[Claim]) -> Iterator[Block]:
    """Each claim with the label of its equation; below, what is left over of those unproved."""
    unproved = [proof for _, proof in claims if not proof.is_exact]
    yield Paragraph(proofs_in_words(is_proved=not unproved))
    for place, part in enumerate(_pages(claims)):
        yield Table(
            caption="What was claimed, and what became of it" + (", continued" if place else ""),
            head=(("Equation",), ("Claim",), ("Status",)),
            rows=tuple(
                ((EquationReference(label),), (proof.claim,), _status(proof))
                for label, proof in part
            ),
        )
    for proof in unproved:
        yield from _left_over(proof)


def _pages(claims: Sequence[Claim]) -> Iterator[list[Claim]]:
    """The claims in parts that a page has room for; a fraction makes a row twice as high."""
    part: list[Claim] = []
    room = _ROWS
    for claim in claims:
        height = 2 if r"\frac" in claim[1].claim.latex else 1
        if part and height > room:
            yield part
            part, room = [], _ROWS
        part.append(claim)
        room -= height
    yield part


def _status(proof: Proof) -> Text:
    return ("exact",) if proof.is_exact else (Strong("unproved"),)


def _left_over(proof: Proof) -> Iterator[Block]:
    """What remains of a claim that could not be decided."""
    yield Paragraph((Strong("Unproved:"), " ", proof.claim, ". What is left over is"))
    if proof.residual is not None:
        yield Equation(
            sides=(RESIDUAL,),
            matrix=proof.residual,
            entries=indexed(RESIDUAL, proof.residual.shape),
        )
