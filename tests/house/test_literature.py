"""The formulas of the literature: what the page says of each is what the prover finds."""

from __future__ import annotations

import importlib
from dataclasses import replace

import pytest

from helpers.command import ROOT
from rigidsym.errors import ExpressionError

pytestmark = pytest.mark.campaign


@pytest.fixture(scope="module")
def literature():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "docs"))
        return importlib.import_module("literature")


def test_there_are_forty_formulas_of_twelve_sources(literature):
    claims = literature.claims()
    assert len(claims) >= 40
    assert len({claim.source for claim in claims}) >= 12
    assert {claim.topic for claim in claims} == {*literature.TOPICS}


def test_every_verdict_is_that_of_the_prover(literature):
    stated = {(c.source.key, c.title, c.place): c.verdict for c in literature.claims()}
    found = {
        (d.claim.source.key, d.claim.title, d.claim.place): d.verdict
        for d in literature.decisions()
    }
    assert found == stated


def test_every_repair_is_proved(literature):
    wrong = [d for d in literature.decisions() if d.verdict == "wrong"]
    assert [d.claim.title for d in wrong if not d.is_repaired] == []


def test_a_changed_sign_is_found(literature):
    claim = next(c for c in literature.claims() if c.place == "eq. (2.14)")
    changed = claim.printed.replace("C(e)*sin", "-C(e)*sin").replace("+ -", "- ")
    decision = literature.decide(replace(claim, printed=changed))
    assert decision.verdict == "wrong"
    assert not decision.is_repaired
    assert any(decision.residual)


def test_an_expression_calls_nothing_but_its_functions(literature):
    with pytest.raises(ExpressionError, match="is not a function"):
        literature.value("__import__('os')", {})
