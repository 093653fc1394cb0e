"""The page in a real browser: alive, by mouse, by keyboard, aloud, wide and narrow."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

import rigidsym as rs
from helpers.browser import axe_source
from helpers.devtools import Page, chromium
from helpers.elements import ODD
from helpers.pages import OTHERS, carried, main_of, motion_of, note_in, odd_page, page_of
from rigidsym.kernels.lowering.lower import MARGIN
from rigidsym.motion import derive
from rigidsym.page.functions import SHOWN
from rigidsym.page.print_page import MOST_BYTES
from rigidsym.pipeline import motion_of as motion_of_spec, output_of, read_file, read_spec

pytestmark = [pytest.mark.campaign, pytest.mark.usefixtures("chromium")]

DRAWN = ("ZXZ", "YZY", "xyz", "z(phi) x(theta) z(psi) y(delta)", "axis_angle")
LIVE = ("ZXZ", "zyx", *OTHERS)

# --- a real browser ---


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Page:
    with chromium(tmp_path_factory.mktemp("chromium")) as page:
        yield page


def opened(tab: Page, text: str, folder: Path, width: int = 1280, **features: str) -> Page:
    file = folder / "page.html"
    file.write_text(text, encoding="utf-8")
    tab.open(file, width, **features)
    return tab


@pytest.fixture(autouse=True)
def quiet(request: pytest.FixtureRequest):
    """No test may leave a message in the console, or a request beside the page itself."""
    yield
    if "tab" in request.fixturenames:
        tab = request.getfixturevalue("tab")
        assert tab.complaints == []
        assert tab.requests == []


SET_ALL = """
(values) => {
  for (const [key, value] of Object.entries(values)) {
    const field = document.getElementById(`${key}-number`);
    field.value = String(value);
    field.dispatchEvent(new Event("input"));
  }
}
"""
STATE = """
Object.fromEntries([...document.querySelectorAll("[data-value]")].map((e) =>
  [e.id, Number(e.dataset.value)]))
"""
NUMBERS = """
Object.fromEntries([...document.querySelectorAll(".value, .pole")].map((e) =>
  [e.id || "margin", [...e.querySelectorAll("data")].map((d) => Number(d.value))]))
"""


def compare_with_numpy(tab: Page, motion: rs.Motion) -> None:
    """Everything that the page shows, at what its sliders stand at, with the NumPy kernels."""
    state, shown = tab.run(STATE), tab.run(NUMBERS)
    given: dict[str, list[float]] = {"q": [], "q_dot": [], "parameters": []}
    for key, value in state.items():
        given[key.split("-")[0]].append(value)
    if "parameters" in {argument.name for argument in motion.arguments}:
        whole = len(motion.argument("parameters").symbols)
        # moments turn nothing, and have no sliders
        given["parameters"] += [1.0] * (whole - len(given["parameters"]))
    kernels = motion.kernels().load()
    for name in SHOWN:
        vectors = [given[argument] for argument in motion.step(name).quantity.inputs]
        expected = getattr(kernels, name)(*vectors)
        assert np.abs(np.ravel(expected) - shown[f"{name}-value"]).max() <= 1e-12, name
    if hasattr(kernels, MARGIN):
        vectors = [given["q"], *([given["parameters"]] if given["parameters"] else [])]
        count = kernels.singularity_margin.__code__.co_argcount
        assert abs(kernels.singularity_margin(*vectors[:count]) - shown["margin"][0]) <= 1e-12


@pytest.mark.parametrize("rotation", OTHERS)
def test_a_page_of_any_rotation_is_of_bounded_size_and_holds_the_whole_note(rotation):
    page, note = page_of(rotation), motion_of(rotation).note()
    assert len(page.encode()) <= MOST_BYTES
    assert note_in(page) == main_of(note.html())


@pytest.mark.parametrize("rotation", LIVE)
def test_numbers_agree_with_numpy_and_nothing_is_scrolled_sideways(tab, rotation, tmp_path):
    motion = motion_of(rotation)
    opened(tab, page_of(rotation), tmp_path)
    compare_with_numpy(tab, motion)
    keys = list(tab.run(STATE))
    rng = np.random.default_rng(3)
    for _ in range(3):
        values = {key: float(rng.uniform(-1, 1)) for key in keys}
        if rotation in ("ZXZ", "zyx"):
            values |= {f"q-{k}": float(rng.uniform(-180, 180)) for k in range(3)}
        tab.run(f"({SET_ALL})({json.dumps(values)})")
        compare_with_numpy(tab, motion)
    for width in (320, 360, 768):
        tab.resize(width)
        assert tab.run("document.documentElement.scrollWidth") <= width


FILES = {
    "passive": '[rotation]\nsequence = "z(heading) y(elevation) x(bank)"\npassive = true',
    "own": """
        [rotation]
        matrix = [["cos(a)", "-sin(a)", "0"], ["sin(a)", "cos(a)", "0"], ["0", "0", "1"]]
        coordinates = ["a"]
        """,
    "top": """
        [rotation]
        sequence = "z(phi) x(theta) z(psi) y(alpha0)"
        [parameters]
        A = { positive = true, about = "a moment", unit = "kg m^2" }
        [body]
        principal_moments = ["A", "A", "2*A"]
        """,
}


@pytest.mark.parametrize("name", FILES)
def test_pages_of_files_agree_with_numpy_on_a_phone(tab, name, tmp_path):
    spec = read_spec(FILES[name], source=f"{name}.toml", name=name)
    made = output_of(replace(spec, note=("page",)))
    opened(tab, made.files[f"{name}_page.html"], tmp_path, 360)
    rng = np.random.default_rng(7)
    values = {key: float(rng.uniform(-1, 1)) for key in tab.run(STATE)}
    tab.run(f"({SET_ALL})({json.dumps(values)})")
    compare_with_numpy(tab, made.motion)
    assert tab.run("document.documentElement.scrollWidth") <= 360


@pytest.mark.parametrize(
    "rotation", ["unit_quaternion", "axis_angle", "cayley_klein", "direction_cosines"]
)
def test_bound_coordinates_stay_a_rotation(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    rng = np.random.default_rng(5)
    for _ in range(5):
        key = f"q-{rng.integers(3)}"
        tab.run(f"({SET_ALL})({json.dumps({key: float(rng.uniform(-0.9, 0.9))})})")
        matrix = np.reshape(tab.run(NUMBERS)["rotation_matrix-value"], (3, 3))
        assert np.abs(matrix @ matrix.T - np.eye(3)).max() < 1e-12
        assert abs(np.linalg.det(matrix) - 1) < 1e-12


CUT_OFF = """
[...document.querySelectorAll("input[type=number]")].filter((field) => {
  const style = getComputedStyle(field), pen = document.createElement("canvas").getContext("2d");
  pen.font = style.font;
  const room = field.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  return pen.measureText(field.value).width > room;
}).map((field) => field.value)
"""


def test_numbers_are_not_cut_off_on_a_phone(tab, tmp_path):
    text = page_of("unit_quaternion")
    opened(tab, text, tmp_path, 360)
    assert tab.run("document.querySelectorAll('input[type=number]').length") > 7
    assert tab.run(CUT_OFF) == []
    # Arrows would cover the digits, and no script can see how much room they take.
    assert "::-webkit-inner-spin-button { display: none; }" in text


def test_a_slider_that_is_moved_keeps_its_value_where_others_can_give_way(tab, tmp_path):
    opened(tab, page_of("unit_quaternion"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 0.5})})")
    assert abs(tab.run(STATE)["q-1"] - 0.5) < 1e-4


def test_arrow_keys_move_a_slider_and_the_figure_with_it(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    before = tab.run("document.querySelector('#figure g').innerHTML")
    start = tab.run("document.getElementById('q-0').valueAsNumber")
    tab.run("document.getElementById('q-0').focus()")
    for _ in range(3):
        tab.press("ArrowRight", 39)
    assert tab.run("document.getElementById('q-0').valueAsNumber") == start + 3
    assert tab.run("document.getElementById('q-0-number').valueAsNumber") == start + 3
    assert tab.run("document.querySelector('#figure g').innerHTML") != before
    compare_with_numpy(tab, motion_of("ZXZ"))


def test_everything_is_reached_by_the_tab_key_and_seen(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    reached = []
    for _ in range(40):
        tab.press("Tab", 9)
        focus = tab.run(
            "(() => { const e = document.activeElement;"
            "return [e.id || e.tagName, getComputedStyle(e).outlineStyle]; })()"
        )
        reached.append(focus[0])
        assert focus[1] != "none", focus
    for key in (
        "play",
        "reset",
        "speed",
        "time",
        "turns",
        "q-0",
        "q-0-number",
        "q_dot-2",
        "body",
        "SUMMARY",
    ):
        assert key in reached


LINES = """
(root) => [...document.querySelectorAll(`${root} polyline`)].map((line) =>
  [line.getAttribute("class"),
   line.getAttribute("points").split(/[ ,]/).map(Number)])
"""


@pytest.mark.parametrize("rotation", DRAWN)
def test_the_figure_begins_as_that_of_the_note(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    tab.click("[data-show=circles]")
    live = [(kind, points) for kind, points in tab.run(f"({LINES})('#figure')") if points]
    shown = tab.run(f"({LINES})('figure svg')")
    kept = [line for line in shown if line[0] not in ("turn", "guide thin")]
    assert len(kept) >= 8
    nearer = 1.2 if rotation.count("(") > 3 else 1  # the note draws many turns larger
    for kind, points in kept:
        points = np.divide(points, nearer)
        assert any(
            kind == other and len(points) == len(found) and np.allclose(points, found, atol=0.25)
            for other, found in live
        ), (kind, points)


LABELS = """
(root) => [...document.querySelectorAll(`${root} text`)].map((label) => label.textContent)
"""


@pytest.mark.parametrize("rotation", [*DRAWN, "rotation_vector", "unit_quaternion", "gibbs_vector"])
def test_lines_have_the_names_that_they_have_in_the_note(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    rates = {turn["rate_name"] for turn in carried(page_of(rotation))["scene"]["turns"]}
    live = {tidy(label) for label in tab.run(f"({LABELS})('#figure')")}
    shown = {tidy(label) for label in tab.run(f"({LABELS})('figure svg')")}
    assert live - {"Ω", *rates} == shown


def tidy(label: str) -> str:
    return "".join(label.split())


def test_a_turn_of_more_than_half_is_drawn_about_its_vector(tab, tmp_path):
    opened(tab, page_of("rotation_vector"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-0': 0.0, 'q-1': 0.0, 'q-2': -4.5})})")
    lines = tab.run(f"({LINES})('#figure')")
    (arc,) = [points for kind, points in lines if kind == "turn"]
    assert len(arc) == 2 * (35 + 1)  # a point every 7.5 degrees
    (vector,) = [points for kind, points in lines if kind == "vector"]
    assert vector[3] > 100  # downwards


SIGHT = """
(() => {
  const [outer, inner] = ["#figure", "#figure g"].map((e) =>
    document.querySelector(e).getBoundingClientRect());
  return ["left", "top", "right", "bottom"].map((side) => Math.round(inner[side] - outer[side]));
})()
"""


def test_the_scale_never_changes_and_everything_stays_in_sight(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.click("[data-show=rings]")
    box = "document.getElementById('figure').getAttribute('viewBox')"
    before = tab.run(box)
    rng = np.random.default_rng(6)
    for _ in range(25):
        values = {f"q-{k}": float(rng.uniform(-180, 180)) for k in range(3)}
        values |= {f"q_dot-{k}": float(rng.uniform(-180, 180)) for k in range(3)}
        tab.run(f"({SET_ALL})({json.dumps(values)})")
        left, top, right, bottom = tab.run(SIGHT)
        assert left >= 0
        assert top >= 0
        assert right <= 0
        assert bottom <= 0
        assert tab.run(box) == before


def test_a_pole_is_shown_when_it_is_near(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    assert tab.run("document.getElementById('warning').innerHTML") == ""
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 2.0})})")
    assert "θ = 0" in tab.run("document.getElementById('warning').innerHTML")
    assert tab.run("document.body.className") == "near-a-pole"
    tab.run(f"({SET_ALL})({json.dumps({'q-1': -179.0})})")
    assert "θ = π" in tab.run("document.getElementById('warning').innerHTML")
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 60.0})})")
    assert tab.run("document.getElementById('warning').innerHTML") == ""


def test_the_pole_of_a_vector_is_told_by_its_length(tab, tmp_path):
    opened(tab, page_of("rotation_vector"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-0': 2.1, 'q-1': 4.2, 'q-2': 4.2})})")
    assert "n = 2π" in tab.run("document.getElementById('warning').innerHTML")


def test_buttons_copy(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.call("Browser.grantPermissions", permissions=["clipboardReadWrite"])
    tab.click('[data-of="angular_velocity_body"] button')
    tab.wait_for("document.getElementById('said').textContent.startsWith('Copied: ')")
    expected = carried(page_of("ZXZ"))["copies"]["angular_velocity_body"]
    assert expected.startswith("\\[\n\\boldsymbol{\\Omega}'")
    assert tab.run("navigator.clipboard.readText()") == expected


def test_buttons_copy_without_a_clipboard_to_write_to(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.call("Browser.grantPermissions", permissions=["clipboardReadWrite"])
    expected = carried(page_of("ZXZ"))["copies"]["rotation_matrix"]
    tab.run("navigator.clipboard.writeText = () => Promise.reject(new Error())")
    tab.click('[data-of="rotation_matrix"] button')
    tab.wait_for("document.getElementById('said').textContent.startsWith('Copied: ')")
    assert tab.run("navigator.clipboard.readText()") == expected


def test_play_integrates_the_rates_and_pauses(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    before = tab.run(STATE)
    tab.click("#play")
    tab.wait_for(f"({STATE})['q-0'] !== {before['q-0']!r}")
    assert tab.run("document.getElementById('play').textContent") == "Pause"
    tab.click("#play")
    after = tab.run(STATE)
    moved = np.array([after[f"q-{k}"] - before[f"q-{k}"] for k in range(3)])
    rates = np.array([before[f"q_dot-{k}"] for k in range(3)])
    assert moved[0] > 0
    np.testing.assert_allclose(moved / rates, moved[0] / rates[0], rtol=1e-9)
    assert tab.run("document.getElementById('play').textContent") == "Play"
    tab.click("#reset")
    assert tab.run(STATE) == before


def test_with_reduced_motion_a_press_is_a_step(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path, prefers_reduced_motion="reduce")
    before = tab.run(STATE)
    assert tab.run("document.getElementById('play').textContent") == "Step"
    tab.click("#play")
    after = tab.run(STATE)
    assert abs(after["q-0"] - before["q-0"] - 0.1 * before["q_dot-0"]) < 1e-12
    assert tab.run(STATE) == after


def test_what_is_said_aloud_waits_until_all_is_at_rest(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 30.0})})")
    assert tab.run("document.getElementById('said').textContent") == ""
    tab.wait_for("document.getElementById('said').textContent.startsWith('angular velocity')")


def test_no_request_can_leave_a_page(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    blocked = "fetch('https://example.org').then(() => 'sent', () => 'blocked')"
    assert tab.run(blocked) == "blocked"
    assert all("Content Security Policy" in text for text in tab.complaints)
    tab.events.clear()


def test_words_for_angles_fit_too(tab, tmp_path):
    opened(
        tab, derive(rs.EulerAngles("XZY", ("heading", "elevation", "bank"))).page(), tmp_path, 360
    )
    assert tab.run("document.documentElement.scrollWidth") <= 360


def test_a_hostile_title_runs_nothing(tab, tmp_path):
    opened(tab, odd_page(), tmp_path)
    assert tab.run("document.title") == ODD
    assert tab.run("document.documentElement.className") == "scripted"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_axe_finds_nothing_in_either_theme(tab, theme, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path, 360, prefers_color_scheme=theme)
    tab.run(axe_source() + "; undefined")
    faults = tab.run("axe.run().then((found) => found.violations.map((fault) => fault.help))")
    assert faults == []


# --- the figure that teaches

STROKES = """
(kind) => [...document.querySelectorAll(`#figure polyline.${kind}`)].map((line) =>
  line.getAttribute("points").split(" ").map((point) => point.split(",").map(Number)))
"""


@pytest.mark.parametrize("rotation", ["ZXZ", "xyz", "z(phi) x(theta) z(psi) y(delta)"])
def test_the_turns_add_up_to_the_angular_velocity(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    terms = tab.run(f"({STROKES})('term')")
    (omega,) = tab.run(f"({STROKES})('omega')")
    assert len(terms) == len(carried(page_of(rotation))["scene"]["turns"])
    assert terms[0][0] == omega[0] == [0, 0]
    assert all(one[-1] == other[0] for one, other in pairwise(terms))
    np.testing.assert_allclose(terms[-1][-1], omega[-1], atol=0.2)


def test_angles_and_rates_are_in_degrees(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 90.0, 'q_dot-0': 0, 'q_dot-1': 0, 'q_dot-2': 36})})")
    cells = "[...document.querySelectorAll('#angular_velocity_body-value data')]"
    assert tab.run(f"{cells}.map((cell) => cell.textContent)") == ["0.00", "0.00", "36.00"]
    np.testing.assert_allclose(tab.run(f"{cells}.map((c) => Number(c.value))")[2], np.pi / 5)


def test_the_turns_are_made_one_by_one(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.click("[data-show=frames]")
    said = "document.getElementById('turn-words').textContent"
    assert tab.run(said).count("+") == 2  # Ω as a sum
    for done, sentence, frames in (
        (0, "Turn 1 of 3", 0),
        (1.5, "Turn 2 of 3", 3),
        (2, "3 of 3", 6),
    ):
        tab.run(
            f"(() => {{ const s = document.getElementById('turns'); s.value = {done};"
            "s.dispatchEvent(new Event('input')); })()"
        )
        assert sentence in tab.run(said)
        assert len(tab.run(f"({STROKES})('between')")) == frames
        assert tab.run(f"({STROKES})('omega')") == []
    tab.click("#reset")
    tab.click("#one-by-one")
    tab.wait_for("document.getElementById('turns').valueAsNumber > 0.2")
    tab.wait_for("document.getElementById('turns').valueAsNumber === 3")
    tab.wait_for("document.getElementById('play').textContent === 'Play'")
    assert len(tab.run(f"({STROKES})('omega')")) == 1


def test_the_body_is_where_the_matrix_takes_it(tab, tmp_path):
    opened(tab, page_of("zyx"), tmp_path)
    matrix = np.reshape(tab.run(NUMBERS)["rotation_matrix-value"], (3, 3))
    axes = {tuple(line[-1]) for line in tab.run(f"({STROKES})('body')") if len(line) == 2}
    view = carried(page_of("zyx"))["scene"]
    a, e = np.radians([view["azimuth"], view["elevation"]])
    across = np.array([-np.sin(a), np.cos(a), 0])
    up = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])
    for column in matrix.T:
        expected = 1.35 * 120 * np.array([across @ column, -up @ column])
        assert any(np.allclose(expected, axis, atol=0.2) for axis in axes)


def test_gimbal_rings_lock_where_two_of_them_are_in_one_plane(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    assert tab.run("document.querySelectorAll('.ring').length") == 0
    tab.click("[data-show=rings]")
    assert tab.run("document.querySelectorAll('.ring').length") > 6
    assert tab.run("document.querySelectorAll('.locked').length") == 0
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 0.5})})")
    assert tab.run("document.querySelectorAll('.locked').length") > 6


def test_the_axis_leaves_a_trace_while_it_moves(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    assert tab.run(f"({STROKES})('trace')") == []
    tab.run("document.getElementById('speed').value = '4'")
    tab.click("#play")
    tab.wait_for("document.querySelectorAll('#figure .trace').length > 0")
    tab.click("#play")
    tab.click("#reset")
    assert tab.run(f"({STROKES})('trace')") == []


def test_speed_is_a_factor_of_time(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path, prefers_reduced_motion="reduce")
    before = tab.run(STATE)
    tab.run("document.getElementById('speed').value = '4'")
    tab.click("#play")
    moved = tab.run(STATE)["q-0"] - before["q-0"]
    assert abs(moved - 0.1 * 4 * before["q_dot-0"]) < 1e-9


def test_a_link_holds_the_whole_state(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.run(f"({SET_ALL})({json.dumps({'q-0': -12.5, 'q-1': 75.0, 'q_dot-2': 7.0})})")
    tab.click("[data-show=rings]")
    tab.run(
        "(() => { for (const [id, value] of [['azimuth', '-50'], ['body', 'book']]) {"
        "const field = document.getElementById(id); field.value = value;"
        "field.dispatchEvent(new Event('input')); } })()"
    )
    tab.wait_for("location.hash.includes('book')")
    lines = "document.querySelectorAll('#figure g *').length"
    state, count = tab.run(STATE), tab.run(lines)
    link = tab.run("location.href")
    tab.call("Page.navigate", url="about:blank")
    tab.call("Page.navigate", url=link)
    tab.wait_for("document.documentElement?.className === 'scripted'")
    tab.events.clear()
    assert tab.run(STATE) == pytest.approx(state, abs=1e-7)
    assert tab.run("document.getElementById('body').value") == "book"
    assert tab.run(lines) == count


@pytest.mark.parametrize(
    "words", ["q=1 x", "q=&view=&turns=&show=&body=bishop", "%", "q=1e999 2 3"]
)
def test_a_broken_link_breaks_nothing(tab, words, tmp_path):
    file = tmp_path / "page.html"
    file.write_text(page_of("ZXZ"), encoding="utf-8")
    tab.call("Page.navigate", url="about:blank")
    tab.call("Page.navigate", url=f"{file.as_uri()}#{words}")
    tab.wait_for("document.documentElement?.className === 'scripted'")
    assert all(np.isfinite(value) for value in tab.run(STATE).values())
    assert tab.run("document.getElementById('body').value") == "top"
    tab.events.clear()


# --- time

GO_TO = """
(time) => {
  const slider = document.getElementById("time");
  slider.value = time;
  slider.dispatchEvent(new Event("input"));
}
"""


def test_the_slider_of_time_goes_to_any_moment_and_back(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    before = tab.run(STATE)
    tab.run(f"({GO_TO})(1.5)")
    after = tab.run(STATE)
    assert tab.run("document.getElementById('clock').textContent") == "1.50 s"
    for k in range(3):
        moved = after[f"q-{k}"] - before[f"q-{k}"] - 1.5 * before[f"q_dot-{k}"]
        assert abs((moved + np.pi) % (2 * np.pi) - np.pi) < 1e-12
    tab.run(f"({GO_TO})(0)")
    assert tab.run(STATE) == before


def test_a_motion_is_integrated_in_the_page_as_by_simulate(tab, tmp_path):
    motion = motion_of_file("heavy_symmetric_top")
    opened(tab, motion.page(), tmp_path)
    before = tab.run(STATE)
    integrals = tab.run(INTEGRALS)
    tab.run(f"({GO_TO})(4)")
    after = tab.run(STATE)
    np.testing.assert_allclose(tab.run(INTEGRALS), integrals, rtol=1e-6)
    names = ("phi", "theta", "psi")
    initial = {name: before[f"q-{k}"] for k, name in enumerate(names)}
    initial |= {f"{name}_dot": before[f"q_dot-{k}"] for k, name in enumerate(names)}
    constants = motion.forces.examples[0].parameters
    expected = motion.simulate(initial, constants, 4.0, samples=3)
    found = [after[f"q_dot-{k}"] for k in range(3)]
    np.testing.assert_allclose(found, expected.q_dot[-1], rtol=1e-5)
    assert tab.complaints == []


def test_a_page_starts_with_a_motion_and_follows_a_driven_one_in_time(tab, tmp_path):
    A, C = sp.symbols("A C")
    model = rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi"))
    potential = "k*(1 + b*cos(omega*t))*cos(theta)"
    motion = rs.derive(model, body=rs.principal_moments(A, A, C), potential=potential)
    start = {"phi": -2.0, "theta": 0.5, "psi": 7.0, "phi_dot": 0.1, "theta_dot": 0.2}
    start |= {"psi_dot": 30.0}
    constants = {"A": 1.0, "C": 0.5, "k": 4.0, "b": 0.5, "omega": 6.0, "M": 1.0}
    opened(tab, motion.page(start=start | constants), tmp_path)
    before = tab.run(STATE)
    assert before["q-1"] == pytest.approx(0.5)
    assert before["q_dot-2"] == pytest.approx(30.0)
    tab.run(f"({GO_TO})(3)")
    after = tab.run(STATE)
    expected = motion.simulate(start, constants, 3.0, samples=3)
    found = [after[f"q_dot-{k}"] for k in range(3)]
    np.testing.assert_allclose(found, expected.q_dot[-1], atol=1e-4)
    assert tab.complaints == []


INTEGRALS = """
[...document.querySelectorAll("#first_integrals-value data")].map((cell) => Number(cell.value))
"""


@cache
def motion_of_file(name: str) -> rs.Motion:
    (spec,) = read_file(name).singles()
    return motion_of_spec(spec)


CROSSED = """
[...document.querySelectorAll("#figure text")].flatMap((text) => {
  const box = text.getBBox(), lines = [...document.querySelectorAll("#figure polyline:not(.thin)")];
  const isIn = ({ x, y }) => Math.abs(x - box.x - box.width / 2) < box.width / 4
    && Math.abs(y - box.y - box.height / 2) < box.height / 5;
  return lines.filter((line) => {
    const length = line.getTotalLength();
    return [...Array(300).keys()].some((k) => isIn(line.getPointAtLength((length * k) / 299)));
  }).map((line) => `${text.textContent} on ${line.getAttribute("class")}`);
})
"""


@pytest.mark.parametrize("rotation", ["ZXZ", "ZYX", "XYZ"])
def test_no_label_lies_on_a_line(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    assert tab.run(CROSSED) == []


HANGING = """
(() => {
  const items = [...document.querySelectorAll("nav li")];
  document.querySelector("nav li a").textContent = "The centre of mass and the kinetic energy";
  const [left, right] = [items[0], items.at(-1)].map((item) => item.getBoundingClientRect());
  const words = document.querySelector("nav li a").getBoundingClientRect();
  const number = 2 * parseFloat(getComputedStyle(document.documentElement).fontSize);
  return right.left > left.right ? right.left - number - words.right : null;
})()
"""


def test_numbers_of_contents_keep_clear_of_the_column_before(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    assert tab.run(HANGING) >= 10


def test_sources_are_no_numbered_section(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    number = "(heading) => getComputedStyle(heading, '::before').content"
    *sections, sources = tab.run(f"[...document.querySelectorAll('main h2')].map({number})")
    assert all("counter" in number for number in sections)
    assert sources == "none"
