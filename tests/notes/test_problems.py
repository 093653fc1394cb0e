"""Problem sheets: the same in every run, and with answers that witnesses of their own confirm."""

from __future__ import annotations

import re
from random import Random

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from helpers.command import call
from rigidsym.commands import problems as command
from rigidsym.formula.reader import text_of
from rigidsym.notes import problems
from rigidsym.notes.document import Equation, Paragraph, Section
from rigidsym.notes.formats import render
from rigidsym.notes.formats.pdf import Typeset
from rigidsym.notes.problems import Problem, numeral, problem_of, problems_of, sheets_of


def asked(problem: Problem) -> str:
    return " ".join(text_of(b.text) for b in problem.question.blocks if isinstance(b, Paragraph))


def numbers(text: str) -> list[float]:
    return [float(n.replace("−", "-")) for n in re.findall(r"[−-]?\d+(?:\.\d+)?", text)]


def test_a_variant_is_the_same_sheet_every_time_and_another_has_other_numbers():
    first, again, other = (render(sheets_of("all", count=6, variant=k)[1], "md") for k in (3, 3, 4))
    assert first == again != other


def test_no_two_problems_have_one_question_and_another_kind_follows_the_last(monkeypatch):
    def few(rng: Random) -> dict[str, int]:
        return {"number": rng.randrange(2)}

    def many(rng: Random) -> dict[str, int]:
        return {"number": rng.randrange(10**6)}

    def drawn(kind, rng: Random) -> Problem:
        facts = kind(rng)
        return Problem(Section(kind.__name__, (str(facts),)), Section("", ()), facts)

    monkeypatch.setattr(problems, "problem_of", drawn)
    made = problems_of((few, many), 9, "seed")
    assert len({problem.question for problem in made}) == 9
    assert 1 <= [problem.question.title for problem in made].count("few") <= 2


def test_the_command_lists_the_problems_and_typesets_sheet_and_solutions(monkeypatch, tmp_path):
    monkeypatch.setattr(command, "typeset", lambda tex: Typeset(tex.encode(), ()))
    words = ("problems", "bodies", "--number", "1", "--out", ".")
    listed = call(*words, cwd=tmp_path).stdout.splitlines()
    quiet = call(*words, "--quiet", cwd=tmp_path).stdout.splitlines()
    assert [listed[0].split()[0], *quiet] == ["1", *listed[1:]]
    assert all((tmp_path / line).is_file() for line in quiet)
    call(*words, "--pdf", "--author", "Ada", "--course", "Tops", cwd=tmp_path)
    for name in ("problems_bodies_1", "problems_bodies_1_solutions"):
        tex = (tmp_path / "problems_bodies_1" / f"{name}.tex").read_bytes()
        assert b"Ada" in tex
        assert b"Tops" in tex
        assert (tmp_path / "problems_bodies_1" / f"{name}.pdf").read_bytes() == tex


def test_only_the_solutions_hold_answers():
    sheet, solutions = sheets_of("all", count=6, variant=1)
    for ending in ("tex", "html", "md"):
        assert "Answer" not in render(sheet, ending)
        assert render(solutions, ending).count("Answer") == 6


@pytest.mark.parametrize("seed", range(3))
def test_the_angular_velocity_is_that_of_a_witness(seed):
    problem = problem_of(problems.angular_velocity, Random(seed))
    text = asked(problem)
    sequence = re.search(r"by the ([XYZ]{3})", text)[1]
    angles, rates = np.reshape(numbers(text.split("angles")[1].split("Find")[0]), (2, 3))
    step = 1e-6
    before, after = (
        Rotation.from_euler(sequence, angles + s * np.degrees(rates), degrees=True)
        for s in (-step, step)
    )
    turned = after * before.inv() if "of space" in text else before.inv() * after
    np.testing.assert_allclose(problem.facts["values"], turned.as_rotvec() / (2 * step), atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_the_matrix_in_question_is_that_of_the_answer(seed):
    problem = problem_of(problems.which_convention, Random(seed))
    (matrix,) = (b.matrix for b in problem.question.blocks if isinstance(b, Equation))
    q = problem.facts["derivation"].argument("q").symbols
    point = dict(zip(q, (0.3, 0.5, -0.7), strict=True))
    expected = Rotation.from_euler(problem.facts["sequence"], list(point.values())).as_matrix()
    np.testing.assert_allclose(np.array(matrix.xreplace(point), float), expected, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_the_determinant_near_gimbal_lock_is_the_volume_of_the_three_axes(seed):
    problem = problem_of(problems.gimbal_lock, Random(seed))
    sequence = re.search(r"by the ([XYZ]{3})", asked(problem))[1]
    theta = numbers(asked(problem))[-1]
    unit = dict(zip("XYZ", np.eye(3), strict=True))
    turned = Rotation.from_euler(sequence[1], theta, degrees=True)
    axes = [unit[sequence[0]], unit[sequence[1]], turned.apply(unit[sequence[2]])]
    determinant, growth = problem.facts["values"]
    assert abs(determinant - abs(np.linalg.det(axes))) < 1e-12
    assert abs(growth * determinant - 1) < 1e-12
    assert determinant < np.sin(np.radians(16))


@pytest.mark.parametrize("seed", range(3))
def test_the_moment_beside_the_centre_is_that_of_the_textbooks(seed):
    problem = problem_of(problems.parallel_axis, Random(seed))
    radius, *_, mass, distance = numbers(asked(problem))
    factors = {"cylinder": 1 / 2, "cone": 3 / 10, "sphere": 2 / 5}  # of a hemisphere too
    factor = next(factor for name, factor in factors.items() if name in asked(problem))
    own = factor * mass * radius**2
    np.testing.assert_allclose(problem.facts["values"], [own, own + mass * distance**2], rtol=1e-12)


def test_answers_are_the_values_with_their_units():
    (problem,) = problems_of((problems.parallel_axis,), 1, "bodies 1")
    *_, answer = problem.solution.blocks
    own, whole = (numeral(value).text for value in problem.facts["values"])
    assert text_of(answer.text) == f"Answer: I₃ = {own} kg\u00a0m² and I = {whole} kg\u00a0m²."


def test_energy_momentum_and_the_angle_between_momentum_and_angular_velocity():
    facts = problems.rotational_energy(Random(0))
    omega, momentum = np.array(facts["omega"]), np.array(facts["moments"]) * facts["omega"]
    energy, size, angle = facts["values"]
    assert energy == np.sum(facts["moments"] * omega**2) / 2
    cross = np.linalg.norm(np.cross(omega, momentum))
    np.testing.assert_allclose(np.tan(np.radians(angle)), cross / (2 * energy))
    np.testing.assert_allclose(size**2, np.sum(momentum**2))
