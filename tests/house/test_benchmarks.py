"""The benchmarks run, on sizes that take no time, and say what they measure. No clock is judged."""

from __future__ import annotations

import json

import pytest

from benchmarks import accuracy, form, run, sympy_forms
from benchmarks.kernels import PEER

pytestmark = pytest.mark.campaign

SMALL = ("accuracy", "kernels", "sizes")


def test_one_command_prints_and_writes(tmp_path, capsys):
    path = tmp_path / "results.json"
    options = ("--samples", "1", "--repeats", "1", "--size", "400", "--json", str(path))
    assert run.main([*SMALL, *options]) == 0
    written = json.loads(path.read_text(encoding="utf-8"))
    assert set(written) == {"schema", "machine", "benchmarks"}
    assert set(written["benchmarks"]) == {*SMALL}
    printed = capsys.readouterr().out
    assert "scalar twins, float64" in printed
    assert f"R at 4e2: numpy against {PEER}" in printed


def test_errors_are_a_few_eps():
    found = accuracy.errors("ZXZ", 3)
    assert {way for way, _, _ in found} == {way.name for way in accuracy.WAYS}
    assert 0 <= max(found.values()) < 20


def test_the_form_table_counts_both_sides():
    as_it_comes = {"as it comes": sympy_forms.SIMPLIFIED["as it comes"]}
    found = form.compare("ZXZ", sympy_forms.survey("ZXZ", as_it_comes, {}))
    assert {c.quantity for c in found} == set(form.SYMBOLS)
    assert all(c.ours > 0 and c.sympy_best <= c.sympy_raw for c in found)
    assert not any(figure.met for figure in form.report(found).figures)  # one is not all
