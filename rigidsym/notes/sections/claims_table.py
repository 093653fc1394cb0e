"""The section of a note that says what was claimed, and what became of each claim."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rigidsym.mechanics.derivation import Proof
from rigidsym.notes.document.document import (
    Equation,
    EquationReference,
    NoteBlock,
    NoteTable,
    Paragraph,
    Strong,
    Text,
)
from rigidsym.notes.formula.derivation_letters import RESIDUAL
from rigidsym.notes.prose.prose import proofs_in_words

EXACT: Text = ("exact",)
Claim = tuple[str, Proof]  # the label of an equation, and what was claimed there


def claims_in_a_table(claims: Sequence[Claim]) -> Iterator[NoteBlock]:
    """Each claim with the label of its equation; below, what is left over of those unproved."""
    unproved = [proof for _, proof in claims if proof.status != "exact"]
    yield Paragraph(proofs_in_words(is_proved=not unproved))
    yield NoteTable(
        caption="Identities verified",
        head=(("Eq.",), ("Identity",), ("Status",)),
        rows=tuple(
            ((EquationReference(label),), (proof.claim,), _status(proof)) for label, proof in claims
        ),
    )
    for proof in unproved:
        yield from _left_over(proof)


def _status(proof: Proof) -> Text:
    return EXACT if proof.status == "exact" else (Strong(proof.status),)


def _left_over(proof: Proof) -> Iterator[NoteBlock]:
    """What remains of a claim that could not be decided."""
    yield Paragraph((Strong("Unproved:"), " ", proof.claim, ". The difference of its two sides is"))
    if proof.residual is not None:
        yield Equation(sides=(RESIDUAL,), matrix=proof.residual)
