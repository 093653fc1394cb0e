"""The benchmarks run, on sizes that take no time, and say what they found. No clock is judged."""

from __future__ import annotations

import json

import numpy as np
import pytest

from benchmarks import (
    accuracy,
    cold_start,
    derivation,
    form,
    kernels,
    rosetta,
    run,
    sympy_forms,
)
from benchmarks.measure import Settings, Spread, interleaved, peak_memory, ratios, run_process
from benchmarks.report import Column, Figure, Report, Table, summary

pytestmark = pytest.mark.campaign

AS_IT_COMES = {"as it comes": sympy_forms.SIMPLIFIED["as it comes"]}


# measure


def test_actions_take_turns_and_the_warm_up_is_left_out():
    order: list[str] = []
    actions = {name: lambda n=name: order.append(n) or len(order) for name in "ab"}
    assert interleaved(actions, 2, warm_up=1) == {"a": [3, 5], "b": [4, 6]}
    assert order == list("ababab")


def test_ratios_are_taken_pair_by_pair():
    assert ratios([2.0, 9.0, 4.0], [1.0, 3.0, 4.0]) == Spread(1.0, 2.0, 3.0)


def test_peak_memory_counts_what_an_array_takes():
    size = 1_000_000
    assert size <= peak_memory(lambda: np.ones(size, np.int8)) < 1.1 * size


def test_a_process_that_fails_is_not_timed_silently():
    with pytest.raises(RuntimeError, match="failed"):
        run_process([*cold_start.rigidsym_command(), "no such command"])


# report


def test_numbers_stand_right_and_words_left():
    columns = (Column("what"), Column("ms", ".1f"))
    table = Table("Title", columns, (("a", 1.25), ("longer", 123.0)))
    assert list(table.lines()) == [
        "Title",
        "  what       ms",
        "  a         1.2",
        "  longer  123.0",
    ]


@pytest.mark.parametrize(
    "sides", [(kernels.PEER, "c"), (kernels.PEER, kernels.HEYOKA, "c", "numba")]
)
def test_the_documented_sizes_have_a_column_for_every_side(sides):
    turns = {side: [8.41625e-3, 9e-3, 0.5] for side in sides}
    table = kernels.documented("R", {10: turns, 10_000: turns})
    head, _, row = table.markdown().splitlines()
    assert head.count("|") == row.count("|") == len(sides) + 2
    assert row == "| 10,000 |" + " 8,420 |" * len(sides)


def test_the_summary_marks_what_is_not_met():
    figures = (Figure("one", "at most 2", "1", True), Figure("two", "at most 2", "3", False))
    text = summary({"name": Report("Title", (), figures)})
    assert text.splitlines() == [
        "1 of 2 figures met",
        "  met      one: 1 (to reach: at most 2)",
        "  NOT MET  two: 3 (to reach: at most 2)",
    ]


# derivation


@pytest.mark.parametrize("work", derivation.WORK)
def test_each_work_is_timed_convention_by_convention(work):
    totals = derivation.in_this_process(work, ["ZXZ", "zyx"])
    assert 0 < totals[0] < totals[1]


def test_both_sides_derive_the_same_velocities():
    ours, theirs = derivation.velocities("ZXZ"), derivation.sympy_velocities("ZXZ")
    for one, other in zip(ours, theirs, strict=True):
        assert (one - other).expand().is_zero_matrix


def test_derivation_judges_the_middle_of_the_repeats():
    totals = {
        derivation.EVERYTHING: [[0.1] * 24, [0.1] * 24, [9.0] * 24],
        derivation.VELOCITIES: [[0.05] * 24] * 3,
        derivation.SYMPY: [[12.0] * 24] * 3,
    }
    report = derivation.report(totals)
    assert [figure.met for figure in report.figures] == [True, True, True]
    assert "24 conventions" in report.text()


# form


@pytest.fixture(scope="module")
def surveyed():
    return sympy_forms.survey("ZXZ", AS_IT_COMES, {})


def test_a_survey_has_every_quantity(surveyed):
    assert set(surveyed) == set(form.SYMBOLS)


def test_surveys_are_kept_and_read_back(surveyed, tmp_path, monkeypatch):
    monkeypatch.setattr(sympy_forms, "RESULTS", tmp_path / "results")
    sympy_forms.save({"ZXZ": surveyed})
    assert sympy_forms.load() == {"ZXZ": surveyed}


def test_the_form_table_counts_both_sides(surveyed):
    found = form.compare("ZXZ", surveyed)
    report = form.report(found)
    assert {c.quantity for c in found} == set(form.SYMBOLS)
    assert all(c.ours > 0 and c.sympy_best <= c.sympy_raw for c in found)
    assert len(report.data) == len(found)
    assert "dR/dt·Rᵀ" in report.text()
    assert not any(figure.met for figure in report.figures)  # one convention is not all


def test_forms_of_different_value_are_refused(surveyed):
    swapped = {"angular_velocity_space": surveyed["angular_velocity_body"]}
    with pytest.raises(ArithmeticError, match="differ in value"):
        form.compare("ZXZ", swapped)


# cold start


def test_cold_start_compares_with_the_import_of_sympy():
    seconds = {name: [0.1, 0.1] for name in cold_start.commands("out")}
    report = cold_start.report(seconds)
    assert [figure.met for figure in report.figures] == [True, True]
    assert 'python -c "import sympy"' in report.text()


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
    assert len(several.tables) == 3 * len(kernels.QUANTITIES)
    assert several.documented.rows
    assert all(list(table.lines()) for table in several.tables)


@pytest.mark.usefixtures("two_targets")
def test_a_side_that_differs_is_refused(monkeypatch):
    monkeypatch.setattr(kernels.modules()["numpy"], "rotation_matrix", lambda *_, **__: np.eye(3))
    with pytest.raises((ArithmeticError, ValueError), match=r"rotation_matrix|reshape"):
        kernels.sides("rotation_matrix", 20, "rows", is_filled=True)


def test_a_table_goes_between_its_marks(tmp_path):
    path = tmp_path / "measured.md"
    path.write_text("a\n<!-- kernels: begin -->\nold\n<!-- kernels: end -->\nb\n", "utf-8")
    table = Table("Title", (Column("what"), Column("ns", ".1f")), (("x", 1.0), ("y", None)))
    run.write_table(path, "kernels", table.markdown())
    assert path.read_text("utf-8") == (
        "a\n<!-- kernels: begin -->\n| what | ns |\n| --- | --- |\n| x | 1.0 |\n| y |  |\n"
        "<!-- kernels: end -->\nb\n"
    )
    with pytest.raises(ValueError, match="no lines <!-- accuracy: begin -->"):
        run.write_table(path, "accuracy", "")


# accuracy


def test_the_witness_knows_a_turn_about_one_axis():
    found = accuracy.exact("ZXZ", [0.5, 0.0, 0.25], [2.0, 0.0, 1.0])
    R = np.array(found["rotation_matrix"], float).reshape(3, 3)
    assert np.allclose(R[:2, 0], [np.cos(0.75), np.sin(0.75)])
    assert np.allclose(np.array(found["angular_velocity_space"], float), [0, 0, 3])
    assert np.allclose(np.array(found["angular_velocity_body"], float), [0, 0, 3])


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


@pytest.mark.parametrize("wrong", [["speed"], ["--repeats", "0"], ["--size", "many"]])
def test_wrong_arguments_are_usage_errors(wrong, capsys):
    with pytest.raises(SystemExit) as exit_:
        run.main(wrong)
    assert exit_.value.code == 2
    assert "error: argument" in capsys.readouterr().err


# rosetta


def rows_of(package):
    return [rosetta.row(call)[2:] for call in rosetta.CALLS if call.package == package]


def test_installed_packages_are_identified():
    kernels = 'rs.kernels("xyz"), q = (a, b, c)'
    angles, _, quaternion, of_quaternion, of_vector = rows_of("scipy")
    words = "xyz extrinsic, active, radians, columns (a, b, c)"
    assert angles == (words, "Rz(c) Ry(b) Rx(a)", kernels, "R")
    assert quaternion == (
        f"{words}, scalar last",
        "Rz(c) Ry(b) Rx(a)",
        kernels,
        "q[..., [1, 2, 3, 0]]",
    )
    assert of_quaternion == (
        "quaternion, scalar last, active",
        "R(q)",
        'rs.kernels("unit_quaternion")',
        "R",
    )
    assert of_vector == ("vector, active", "exp C(v)", 'rs.kernels("rotation_vector")', "R")


def test_a_passive_matrix_is_the_transpose_of_ours():
    assert rows_of("sympy")[1][-1] == "Rᵀ"


def test_a_package_that_is_missing_leaves_its_row_empty():
    missing = rosetta.Call("no-such-package", "import no_such_package", "f(a)")
    assert rosetta.row(missing) == ("no-such-package", "`f(a)`", "", "", "", "")
