"""The page in a real browser: alive, by mouse, by keyboard, aloud, wide and narrow."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.browser import Page, chromium
from helpers.pages import MOST_BYTES, ODD, OTHERS, carried, motion_of, note_in, odd_page, page_of
from rigidsym.kernels.lowering.lower import MARGIN

pytestmark = [pytest.mark.campaign, pytest.mark.usefixtures("chromium")]

DRAWN = ("ZXZ", "aerospace", "z(phi) x(theta) z(psi) y(delta)", "axis_angle")


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Page:
    with chromium(tmp_path_factory.mktemp("chromium")) as page:
        yield page


def opened(tab: Page, text: str, folder: Path, width: int = 1280, **features: str) -> None:
    file = folder / "page.html"
    file.write_text(text, encoding="utf-8")
    tab.open(file, width, **features)


@pytest.fixture(autouse=True)
def quiet(tab: Page):
    """No test may leave a message in the console, or a request beside the page itself."""
    yield
    assert tab.complaints == []
    assert tab.requests == []


STATE = """
Object.fromEntries([...document.querySelectorAll("[data-value]")].map((e) =>
  [e.id, Number(e.dataset.value)]))
"""
NUMBERS = """
Object.fromEntries([...document.querySelectorAll(".value, .pole, .integrals")].map((e) =>
  [e.id || "margin", [...e.querySelectorAll("data")].map((d) => Number(d.value))]))
"""
INPUT = """
for (const [key, value] of Object.entries(%s)) {
  const field = document.getElementById(key);
  field.value = String(value);
  field.dispatchEvent(new Event("input"));
}
"""


def slide(tab: Page, **values: float) -> None:
    tab.run(INPUT % json.dumps(values))


def set_all(tab: Page, values: dict[str, float]) -> None:
    slide(tab, **{f"{key}-number": value for key, value in values.items()})


def text_of(tab: Page, key: str) -> str:
    return tab.run(f"document.getElementById('{key}').innerText")


def q_of(state: dict[str, float], kind: str = "q") -> np.ndarray:
    return np.array([value for key, value in state.items() if key.startswith(f"{kind}-")])


def compare_with_numpy(tab: Page, motion: rs.Motion, page: str) -> None:
    """Everything that the page shows, at what its sliders stand at, with the NumPy kernels."""
    state, shown = tab.run(STATE), tab.run(NUMBERS)
    given = {kind: list(q_of(state, kind)) for kind in ("q", "q_dot")}
    given["parameters"] = [
        state.get(f"parameters-{k}", fixed) for k, fixed in enumerate(carried(page)["parameters"])
    ]
    kernels = motion.kernels().load()
    for name in carried(page)["values"]:
        vectors = [given[argument] for argument in motion.step(name).quantity.inputs]
        expected = getattr(kernels, name)(*vectors)
        assert np.abs(np.ravel(expected) - shown[f"{name}-value"]).max() <= 1e-12, name
    if hasattr(kernels, MARGIN):
        vectors = [given["q"], *([given["parameters"]] if given["parameters"] else [])]
        count = kernels.singularity_margin.__code__.co_argcount
        assert abs(kernels.singularity_margin(*vectors[:count]) - shown["margin"][0]) <= 1e-12


@pytest.mark.parametrize("name", ["ZXZ", "zyx", *OTHERS])
def test_numbers_agree_with_numpy_and_nothing_is_scrolled_sideways(tab, name, tmp_path):
    motion, page = motion_of(name), page_of(name)
    assert len(page.encode()) <= MOST_BYTES
    assert note_in(page) == note_in(motion.note().html())
    opened(tab, page, tmp_path)
    compare_with_numpy(tab, motion, page)
    rng = np.random.default_rng(3)
    for _ in range(3):
        values = {key: float(rng.uniform(0.1, 1)) for key in tab.run(STATE)}
        if name in ("ZXZ", "zyx"):
            values |= {f"q-{k}": float(rng.uniform(-180, 180)) for k in range(3)}
        set_all(tab, values)
        compare_with_numpy(tab, motion, page)
    for width in (320, 360, 768):
        tab.resize(width)
        assert tab.run("document.documentElement.scrollWidth") <= width


@pytest.mark.parametrize("rotation", ["unit_quaternion", "direction_cosines"])
def test_bound_coordinates_stay_a_rotation(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    rng = np.random.default_rng(5)
    for _ in range(5):
        set_all(tab, {f"q-{rng.integers(3)}": float(rng.uniform(-0.9, 0.9))})
        matrix = np.reshape(tab.run(NUMBERS)["rotation_matrix-value"], (3, 3))
        assert np.abs(matrix @ matrix.T - np.eye(3)).max() < 1e-12
        assert abs(np.linalg.det(matrix) - 1) < 1e-12
    if rotation == "unit_quaternion":  # what is moved keeps its value if others can give way
        set_all(tab, {"q-1": 0.5})
        assert abs(tab.run(STATE)["q-1"] - 0.5) < 1e-4


def test_the_keyboard_reaches_everything_and_moves_the_figure(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    focus = """(() => { const e = document.activeElement;
      return [e.id || e.dataset.show || e.tagName, getComputedStyle(e).outlineStyle]; })()"""
    reached = set()
    for _ in range(40):
        tab.press("Tab", 9)
        name, outline = tab.run(focus)
        reached.add(name)
        assert outline != "none", name
    assert reached >= {"play", "speed", "time", "turns", "q-0", "q-0-number", "rings", "SUMMARY"}
    before = tab.run("document.querySelector('#figure g').innerHTML")
    start = tab.run("document.getElementById('q-0').valueAsNumber")
    tab.run("document.getElementById('q-0').focus()")
    for _ in range(3):
        tab.press("ArrowRight", 39)
    assert tab.run("document.getElementById('q-0-number').valueAsNumber") == start + 3
    assert tab.run("document.querySelector('#figure g').innerHTML") != before


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_in_either_theme(tab, theme, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path, 360, prefers_color_scheme=theme)
    assert tab.faults() == []


def test_no_request_can_leave_a_page_and_no_title_runs(tab, tmp_path):
    opened(tab, odd_page(), tmp_path)
    assert tab.run("document.title") == ODD
    assert tab.run("document.documentElement.className") == "scripted"
    blocked = "fetch('https://example.org').then(() => 'sent', () => 'blocked')"
    assert tab.run(blocked) == "blocked"
    assert all("Content Security Policy" in text for text in tab.complaints)
    tab.events.clear()


LINES = """
(root) => [...document.querySelectorAll(`${root} polyline`)].map((line) =>
  [line.getAttribute("class"), line.getAttribute("points").split(/[ ,]/).map(Number)])
"""
LABELS = """
(root) => [...document.querySelectorAll(`${root} text`)].map((e) => e.textContent.replace(/ /g, ""))
"""


def lines(tab: Page, kind: str) -> list[np.ndarray]:
    """The lines of the live figure of one kind, as points (n, 2)."""
    drawn = tab.run(f"({LINES})('#figure')")
    return [np.reshape(points, (-1, 2)) for name, points in drawn if kind in name.split()]


@pytest.mark.parametrize("rotation", DRAWN)
def test_the_figure_begins_as_that_of_the_note(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    rates = {turn["rate_name"] for turn in carried(page_of(rotation))["scene"]["turns"]}
    live, shown = ({*tab.run(f"({LABELS})('{root}')")} for root in ("#figure", "figure svg"))
    assert live - {"Ω", *rates} == shown
    tab.click("[data-show=circles]")
    live = [(kind, points) for kind, points in tab.run(f"({LINES})('#figure')") if points]
    of_note = tab.run(f"({LINES})('figure svg')")
    kept = [line for line in of_note if line[0] not in ("turn", "guide thin")]
    assert len(kept) >= 8
    nearer = 1.2 if rotation.count("(") > 3 else 1  # the note draws many turns larger
    for kind, points in kept:
        points = np.divide(points, nearer)
        assert any(
            kind == other and len(points) == len(line) and np.allclose(points, line, atol=0.25)
            for other, line in live
        ), (kind, points)


def test_a_pole_is_shown_when_it_is_near(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.click("[data-show=rings]")
    rings = "[...document.querySelectorAll('.ring')].map((e) => e.classList.contains('locked'))"
    for theta, is_near in ((60.0, False), (2.0, True), (-179.0, True), (60.0, False)):
        set_all(tab, {"q-1": theta})
        assert ("nearly singular" in text_of(tab, "warning")) == is_near
        assert tab.run(f"{rings}.every((is_locked) => is_locked === {json.dumps(is_near)})")


@pytest.mark.parametrize("rotation", ["ZXZ", "z(phi) x(theta) z(psi) y(delta)"])
def test_the_turns_add_up_to_the_angular_velocity(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    terms, (omega,) = lines(tab, "term"), lines(tab, "omega")
    assert len(terms) == len(carried(page_of(rotation))["scene"]["turns"])
    assert [*terms[0][0]] == [*omega[0]] == [0, 0]
    assert all((one[-1] == other[0]).all() for one, other in pairwise(terms))
    np.testing.assert_allclose(terms[-1][-1], omega[-1], atol=0.2)


def test_each_letter_of_a_rate_has_its_dot(tab, tmp_path):
    opened(tab, page_of("z(2*phi-psi) x(theta) z(psi/3)"), tmp_path)
    dotted = """[...document.querySelectorAll('#figure text.term')].map((text) =>
      [...document.querySelectorAll('#figure circle.dot')].map((dot) => text.textContent[
        text.getCharNumAtPosition({ x: dot.cx.baseVal.value - 1.5, y: text.getAttribute('y') })
      ]).join(" ").trim())"""
    assert tab.run(dotted) == ["ϕ ψ", "θ", "ψ"]


def test_the_turns_are_made_one_by_one(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.click("[data-show=frames]")
    assert text_of(tab, "turn-words").count("+") == 2  # Ω as a sum
    for done, words, frames in ((0, "Turn 1 of 3", 0), (1.5, "Turn 2 of 3", 3), (2, "3 of 3", 6)):
        slide(tab, turns=done)
        assert words in text_of(tab, "turn-words")
        assert len(lines(tab, "between")) == frames
        assert lines(tab, "omega") == []
    tab.click("#one-by-one")
    tab.wait_for("document.getElementById('turns').valueAsNumber === 3")
    assert len(lines(tab, "omega")) == 1


def test_the_body_is_a_cuboid_until_it_is_hidden(tab, tmp_path):
    opened(tab, page_of("zyx"), tmp_path)
    faces = "document.querySelectorAll('#figure .face').length"
    assert tab.run(faces) == 3
    tab.click("[data-show=body]")
    assert tab.run(faces) == 0


def test_play_integrates_the_rates_and_leaves_a_trace(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    before = tab.run(STATE)
    tab.run("document.getElementById('speed').value = '4'")
    tab.click("#play")
    tab.wait_for("document.querySelectorAll('#figure .trace').length > 0")
    assert text_of(tab, "play") == "Pause"
    tab.click("#play")
    after = tab.run(STATE)
    moved = q_of(after) - q_of(before)
    assert moved[0] > 0
    shares = moved / q_of(before, "q_dot")
    np.testing.assert_allclose(shares, shares[0], rtol=1e-9)
    assert text_of(tab, "play") == "Play"
    tab.click("#reset")
    assert tab.run(STATE) == before
    assert lines(tab, "trace") == []


def test_a_page_starts_with_a_motion_and_follows_a_driven_one_in_time(tab, tmp_path):
    A, C = sp.symbols("A C")
    potential = "k*(1 + b*cos(omega*t))*cos(theta)"
    motion = rs.derive("ZXZ", body=rs.principal_moments(A, A, C), potential=potential)
    start = {"phi": -2.0, "theta": 0.5, "psi": 7.0}
    start |= {"phi_dot": 0.1, "theta_dot": 0.2, "psi_dot": 30.0}
    constants = {"A": 1.0, "C": 0.5, "k": 4.0, "b": 0.5, "omega": 6.0, "M": 1.0}
    opened(tab, motion.page(start=start | constants), tmp_path)
    before = tab.run(STATE)
    assert (before["q-1"], before["q_dot-2"]) == pytest.approx((0.5, 30.0))
    slide(tab, time=3)
    expected = motion.simulate(start, constants, 3.0, samples=3)
    np.testing.assert_allclose(q_of(tab.run(STATE), "q_dot"), expected.q_dot[-1], atol=1e-4)


def follow_link(tab: Page, url: str) -> None:
    tab.call("Page.navigate", url="about:blank")
    tab.call("Page.navigate", url=url)
    tab.wait_for("document.documentElement?.className === 'scripted'")
    tab.events.clear()


def test_a_link_holds_the_whole_state(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    set_all(tab, {"q-0": -12.5, "q-1": 75.0, "q_dot-2": 7.0})
    tab.click("[data-show=rings]")
    tab.click("[data-show=body]")
    slide(tab, azimuth=-50)
    tab.wait_for("location.hash.includes('view=-50')")
    elements = "document.querySelectorAll('#figure g *').length"
    state, count = tab.run(STATE), tab.run(elements)
    follow_link(tab, tab.run("location.href"))
    assert tab.run(STATE) == pytest.approx(state, abs=1e-7)
    assert tab.run(elements) == count


@pytest.mark.parametrize("words", ["q=1 x", "q=&view=&turns=&show=bishop", "%"])
def test_a_broken_link_breaks_nothing(tab, words, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    follow_link(tab, f"{(tmp_path / 'page.html').as_uri()}#{words}")
    assert all(np.isfinite(value) for value in tab.run(STATE).values())
