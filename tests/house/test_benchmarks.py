"""The benchmarks run, on sizes that take no time, and say what they found. No clock is judged."""

from __future__ import annotations

import json

import pytest

from benchmarks import accuracy, form, kernels, run, sympy_forms
from benchmarks.measure import Settings

pytestmark = pytest.mark.campaign

AS_IT_COMES = {"as it comes": sympy_forms.SIMPLIFIED["as it comes"]}


# measure


# derivation


# form


def test_the_form_table_counts_both_sides():
    as_it_comes = {"as it comes": sympy_forms.SIMPLIFIED["as it comes"]}
    found = form.compare("ZXZ", sympy_forms.survey("ZXZ", as_it_comes, {}))
    report = form.report(found)
    assert {c.quantity for c in found} == set(form.SYMBOLS)
    assert all(c.ours > 0 and c.sympy_best <= c.sympy_raw for c in found)
    assert len(report.data) == len(found)
    assert "dR/dt·Rᵀ" in report.text()
    assert not any(figure.met for figure in report.figures)  # one convention is not all


# kernels


def test_kernels_are_compared_on_equal_values(monkeypatch):
    monkeypatch.setattr(kernels, "OURS", ("numpy", "c"))  # the others take longer to compile
    kernels.modules.cache_clear()
    settings = Settings(repeats=2, size=400)
    report = kernels.run(settings)
    assert [table.title for table in report.tables] == ["Medians, one core", "Ratios, turn by turn"]
    assert f"R at 4e2: numpy against {kernels.PEER}" in [figure.name for figure in report.figures]
    several = kernels.sizes(Settings(repeats=1, size=3))
    assert len(several.tables) == len(kernels.SYMBOLS) * len(kernels.PLACES)
    assert several.documented.rows
    assert all(list(table.lines()) for table in several.tables)
    kernels.modules.cache_clear()


# accuracy


@pytest.mark.parametrize("sequence", ["ZXZ", "zyx"])
def test_errors_are_a_few_eps(sequence):
    found = accuracy.errors(sequence, 3)
    assert {way for way, _, _ in found} == {way.name for way in accuracy.WAYS}
    assert 0 <= max(found.values()) < 20


# run


def test_one_command_prints_and_writes(tmp_path, capsys):
    path = tmp_path / "results.json"
    assert run.main(["accuracy", "--samples", "1", "--json", str(path)]) == 0
    assert "scalar twins, float64" in capsys.readouterr().out
    written = json.loads(path.read_text(encoding="utf-8"))
    assert set(written) == {"schema", "machine", "benchmarks"}
    assert set(written["benchmarks"]) == {"accuracy"}
