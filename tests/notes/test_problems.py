"""Exercise sheets: reproducible, and with answers that witnesses of their own confirm."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path
from random import Random
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from rigidsym.commands import problems
from rigidsym.commands.cli import commands
from rigidsym.formula.reader import text_of
from rigidsym.notes.document.document import Equation, Paragraph
from rigidsym.notes.formats import FORMATS
from rigidsym.notes.formats.pdf import Typeset
from rigidsym.notes.problems import body_problems as bodies, euler_problems as euler
from rigidsym.notes.problems.exercise import Asked, Exercise, Sheet, numeral, sheet_of
from rigidsym.notes.problems.subjects import SUBJECTS


def sheet(variant: int, count: int = 7) -> Sheet:
    return sheet_of("all", SUBJECTS, count=count, variant=variant)


def asked(problem: Exercise) -> str:
    return " ".join(text_of(b.text) for b in problem.question if isinstance(b, Paragraph))


def numbers(text: str) -> list[float]:
    return [float(n.replace("−", "-")) for n in re.findall(r"[−-]?\d+(?:\.\d+)?", text)]


def test_a_variant_is_the_same_sheet_every_time_and_another_has_other_numbers():
    first, again, other = sheet(3), sheet(3), sheet(4)
    assert first.moodle == again.moodle != other.moodle
    render = FORMATS["tex"].render
    assert render(first.document(solved=True)) == render(again.document(solved=True))


@pytest.mark.parametrize("variant", [3, 6])
def test_no_two_problems_of_a_sheet_have_one_question_or_the_same_answers(variant):
    made = sheet_of("euler", SUBJECTS, count=8, variant=variant).problems
    for one, other in combinations(made, 2):
        assert one.question != other.question
        assert one.answer != other.answer or one.answers[0].choices != other.answers[0].choices


def test_where_a_kind_has_no_more_questions_the_next_one_follows():
    def few(rng: Random) -> Exercise:
        return drawn("few", rng.randrange(2))

    def many(rng: Random) -> Exercise:
        return drawn("many", rng.randrange(10**6))

    def drawn(title: str, number: int) -> Exercise:
        asked = (Paragraph((f"{title} {number}",)),)
        return Exercise(
            title=title,
            question=asked,
            solution=asked,
            answers=(Asked(choices=(f"{title} {number}",)),),
        )

    made = sheet_of("x", {"x": ("X", (few, many))}, count=9, variant=1)
    assert len({problem.question for problem in made.problems}) == 9
    assert 1 <= [problem.title for problem in made.problems].count("few") <= 2


def test_the_convention_is_asked_of_the_candidates_that_are_compared():
    problem = euler.identify(Random(1))
    (compared,) = (text_of(block.text) for block in problem.solution)
    candidates = sorted(problem.answers[0].choices)
    assert re.findall("[XYZ]{3}", asked(problem)) == candidates
    assert re.findall("[XYZ]{3}", compared) == candidates


def test_the_command_typesets_sheet_and_solutions_with_author_and_course(monkeypatch, tmp_path):
    monkeypatch.setattr(problems, "typeset", lambda tex: Typeset(tex.encode(), ()))
    options = ["--number", "1", "--pdf", "--author", "Ada", "--course", "Tops", "--out", tmp_path]
    done = CliRunner().invoke(commands, ["problems", "bodies", *map(str, options)])
    assert done.exit_code == 0, done.output
    for name in ("problems_bodies_1", "problems_bodies_1_solutions"):
        folder = tmp_path / "problems_bodies_1"
        tex = (folder / f"{name}.tex").read_bytes()
        assert b"Ada" in tex
        assert b"Tops" in tex
        assert (folder / f"{name}.pdf").read_bytes() == tex


def test_the_command_lists_the_problems_unless_it_is_quiet(tmp_path):
    options = ["problems", "bodies", "--number", "1", "--out", str(tmp_path)]
    listed = CliRunner().invoke(commands, options).output.splitlines()
    quiet = CliRunner().invoke(commands, [*options, "--quiet"]).output.splitlines()
    assert [line.split()[0] for line in listed[:-4]] == ["1"]
    assert quiet == listed[-4:]
    assert all(Path(line).is_file() for line in quiet)


def test_only_the_solutions_hold_answers():
    made = sheet(1)
    for ending in ("tex", "html", "md"):
        assert "Answer" not in FORMATS[ending].render(made.document(solved=False))
        assert FORMATS[ending].render(made.document(solved=True)).count("Answer") == 7


@pytest.mark.parametrize("seed", range(3))
def test_the_angular_velocity_is_that_of_a_witness(seed):
    problem = euler.angular_velocity(Random(seed))
    text = asked(problem)
    sequence = re.search(r"by the ([XYZ]{3})", text)[1]
    angles, rates = np.reshape(numbers(text.split("angles")[1].split("Find")[0]), (2, 3))
    step = 1e-6
    at = [
        Rotation.from_euler(sequence, angles + s * np.degrees(rates), degrees=True)
        for s in (-step, step)
    ]
    turned = at[1] * at[0].inv() if "of space" in text else at[0].inv() * at[1]
    expected = turned.as_rotvec() / (2 * step)
    np.testing.assert_allclose([a.value for a in problem.answers], expected, atol=1e-6)


@pytest.mark.parametrize("variant", [1, 2, 5])
def test_every_letter_of_a_solution_is_named_in_its_question(variant):
    """But for indices, axes, and letters of the parts of the block"""
    letters = "[A-Za-zα-ωΩ]"

    def used(blocks):
        text = " ".join(text_of(b.text) for b in blocks if isinstance(b, Paragraph))
        shown = [s.text for b in blocks if isinstance(b, Equation) for s in b.sides]
        formulas = [f.text for b in blocks if isinstance(b, Paragraph)
                    for f in b.text if not isinstance(f, str)]  # fmt: skip
        words = " ".join([*shown, *formulas])
        return set(re.findall(rf"(?<!{letters}){letters}(?!{letters})", words)), text

    for problem in sheet(variant).problems:
        answers = {
            a.symbol.text[0] for a in problem.answers if a.symbol and "|" not in a.symbol.text
        }
        asked_for, _ = used(problem.question)
        found, said = used(problem.solution)
        parts = set("mJ") if "block" in said else set()
        assert (found | answers) - asked_for - parts <= set("Rkxyzπ"), problem.title


@pytest.mark.parametrize("seed", range(3))
def test_the_convention_is_the_only_one_that_fits(seed):
    problem = euler.identify(Random(seed))
    angles = numbers(asked(problem))[:3]
    (equation,) = (b for b in problem.question if isinstance(b, Equation))
    shown = [[float(e.text.replace("−", "-")) for e in line] for line in equation.sides[1].rows]
    for place, sequence in enumerate(problem.answers[0].choices):
        found = Rotation.from_euler(sequence, angles, degrees=True).as_matrix()
        assert np.allclose(found, shown, atol=6e-4) is (place == 0)


@pytest.mark.parametrize("seed", range(5))
def test_the_determinant_near_gimbal_lock_is_the_volume_of_the_three_axes(seed):
    problem = euler.gimbal_lock(Random(seed))
    sequence = re.search(r"rates of the ([XYZ]{3})", asked(problem))[1]
    theta = numbers(asked(problem))[-1]
    unit = dict(zip("XYZ", np.eye(3), strict=True))
    turned = Rotation.from_euler(sequence[1], theta, degrees=True)
    axes = [unit[sequence[0]], unit[sequence[1]], turned.apply(unit[sequence[2]])]
    determinant, growth = (answer.value for answer in problem.answers)
    assert abs(determinant - abs(np.linalg.det(axes))) < 1e-12
    assert abs(growth * determinant - 1) < 1e-12
    assert determinant < np.sin(np.radians(16))


@pytest.mark.parametrize("seed", range(5))
def test_the_moment_beside_the_centre_is_that_of_the_textbooks(seed):
    problem = bodies.parallel_axis(Random(seed))
    radius, *_, mass, distance = numbers(asked(problem))
    factors = {"cylinder": 1 / 2, "cone": 3 / 10, "sphere": 2 / 5}  # of a hemisphere too
    factor = next(factor for name, factor in factors.items() if name in asked(problem))
    own = factor * mass * radius**2
    moments = [answer.value for answer in problem.answers]
    np.testing.assert_allclose(moments, [own, own + mass * distance**2], rtol=1e-12)


def test_the_block_with_a_hole_has_the_moments_of_many_points():
    problem = bodies.drilled_block(Random(2))
    a, b, c, density, radius, aside = numbers(asked(problem).replace("m³", ""))[:6]
    count = 60
    x, y, z = (side * ((np.arange(count) + 0.5) / count - 0.5) for side in (a, b, c))
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), -1).reshape(-1, 3)
    points = points[np.hypot(points[:, 0] - aside, points[:, 1]) > radius]
    mass = density * a * b * c / count**3 * len(points)
    found = {answer.symbol.text: answer.value for answer in problem.answers}
    assert abs(found["M"] / mass - 1) < 5e-3
    centred = points - points.mean(axis=0)
    tensor = mass * (np.eye(3) * (centred**2).sum() - centred.T @ centred) / len(points)
    np.testing.assert_allclose([found["I₁"], found["I₂"], found["I₃"]], np.diag(tensor), rtol=1e-2)


def test_the_quiz_is_well_formed_and_embeds_every_answer():
    made = sheet(2)
    questions = ElementTree.fromstring(made.moodle).findall("question")
    assert len(questions) == len(made.problems)
    for question, problem in zip(questions, made.problems, strict=True):
        text = question.findtext("questiontext/text")
        assert len(re.findall(r"\{1:(?:NUMERICAL|MULTICHOICE_S):=", text)) == len(problem.answers)


@pytest.mark.parametrize(
    ("value", "shown"), [(18.275, "18.28"), (-0.0012345, "−0.001235"), (2.0, "2"), (5475.5, "5476")]
)
def test_half_of_the_last_digit_is_rounded_up(value, shown):
    assert numeral(value).text == shown
