"""The benchmarks run, on sizes that take no time, and say what they found. No clock is judged."""

from __future__ import annotations

import json

import numpy as np
import pytest

from benchmarks import accuracy, derivation, form, kernels, run, sympy_forms
from benchmarks.measure import Settings, interleaved

pytestmark = pytest.mark.campaign

AS_IT_COMES = {"as it comes": sympy_forms.SIMPLIFIED["as it comes"]}


# measure


def test_actions_take_turns_and_the_warm_up_is_left_out():
    order: list[str] = []
    actions = {name: lambda n=name: order.append(n) or len(order) for name in "ab"}
    assert interleaved(actions, 2, warm_up=1) == {"a": [3, 5], "b": [4, 6]}
    assert order == list("ababab")


# derivation


@pytest.mark.parametrize("work", derivation.WORK)
def test_each_work_is_timed_convention_by_convention(work):
    totals = derivation.in_this_process(work, ["ZXZ", "zyx"])
    assert 0 < totals[0] < totals[1]


# form


@pytest.fixture(scope="module")
def surveyed():
    return sympy_forms.survey("ZXZ", AS_IT_COMES, {})


def test_the_form_table_counts_both_sides(surveyed):
    found = form.compare("ZXZ", surveyed)
    report = form.report(found)
    assert {c.quantity for c in found} == set(form.SYMBOLS)
    assert all(c.ours > 0 and c.sympy_best <= c.sympy_raw for c in found)
    assert len(report.data) == len(found)
    assert "dR/dt·Rᵀ" in report.text()
    assert not any(figure.met for figure in report.figures)  # one convention is not all


# kernels


@pytest.fixture
def two_targets(monkeypatch):
    """The others are compiled elsewhere often enough."""
    monkeypatch.setattr(kernels, "OURS", ("numpy", "c"))
    kernels.modules.cache_clear()
    yield
    kernels.modules.cache_clear()


@pytest.mark.usefixtures("two_targets")
def test_kernels_are_compared_on_equal_values():
    settings = Settings(repeats=2, size=400)
    report = kernels.run(settings)
    assert [table.title for table in report.tables] == ["Medians, one core", "Ratios, turn by turn"]
    assert f"R at 4e2: numpy against {kernels.PEER}" in [figure.name for figure in report.figures]
    several = kernels.sizes(Settings(repeats=1, size=3))
    assert len(several.tables) == len(kernels.SYMBOLS) * len(kernels.PLACES)
    assert several.documented.rows
    assert all(list(table.lines()) for table in several.tables)


@pytest.mark.usefixtures("two_targets")
def test_a_side_that_differs_is_refused(monkeypatch):
    monkeypatch.setattr(
        kernels.modules("rotation_matrix")["numpy"], "rotation_matrix", lambda *_, **__: np.eye(3)
    )
    with pytest.raises((ArithmeticError, ValueError), match=r"rotation_matrix|reshape"):
        kernels.sides("rotation_matrix", 20, "rows", is_filled=True)


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
