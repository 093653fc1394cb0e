"""Installs find their files, and what README and CONTRIBUTING tell people to do works."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from helpers.command import ROOT

pytestmark = pytest.mark.campaign

PROBE = (
    "from rigidsym.system import resources\n"
    "print(resources.folder('templates'))\n"
    "assert 'euler_zxz' in resources.names('derivations', '.toml')\n"
    "import rigidsym as rs\n"
    "motion = rs.derive(rs.EulerAngles('ZXZ'))\n"
    "assert 'angular_velocity_body' in motion.kernels().source\n"
    "assert r'\\documentclass' in motion.note().latex()\n"
)


def call(*command: str | Path, cwd: Path, **variables: str) -> str:
    environment = {**os.environ, **variables}
    done = subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """(wheel, sdist); the wheel is built from the sdist."""
    place = tmp_path_factory.mktemp("dist")
    call(sys.executable, "-m", "build", "--no-isolation", "--outdir", place, ROOT, cwd=place)
    return next(place.glob("*.whl")), next(place.glob("*.tar.gz"))


def test_the_wheel_finds_what_it_carries(distributions, tmp_path):
    wheel, _ = distributions
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "lib")
    probe = f"import sys; sys.path.insert(0, {str(tmp_path / 'lib')!r})\n{PROBE}"
    found = call(sys.executable, "-c", probe, cwd=tmp_path)
    assert Path(found.strip()) == tmp_path / "lib" / "rigidsym" / "_data" / "templates"


def test_the_sdist_runs_in_place(distributions, tmp_path):
    _, sdist = distributions
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    (folder,) = (path for path in tmp_path.iterdir() if path.is_dir())
    found = call(sys.executable, "-c", PROBE, cwd=folder)
    assert Path(found.strip()) == folder / "templates"
    assert (folder / "tests").is_dir()


README = (ROOT / "README.md").read_text(encoding="utf-8")


def command(mark: str) -> str:
    """The shell command behind a mark in the README."""
    match = re.search(rf"<!-- {mark} -->\n```sh\n(.+?)\n```", README, re.DOTALL)
    assert match, f"the README has no command marked {mark}"
    return match.group(1)


def test_the_main_command_gives_equation_18_in_a_fresh_clone(tmp_path):
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
    printed = call("bash", "-c", command("main"), cwd=clone, PIP_COMPILE="0")
    for line in ("φ̇ sin θ sin ψ + θ̇ cos ψ", "φ̇ sin θ cos ψ − θ̇ sin ψ", "φ̇ cos θ + ψ̇"):
        assert line in printed
    folder = clone / "out" / "euler_zxz_intrinsic"
    assert {f.suffix for f in folder.iterdir()} == {".py", ".tex", ".html", ".json"}


@pytest.mark.parametrize(("mark", "word"), [("main", "derive ZXZ"), ("tests", "pytest")])
def test_ci_runs_the_commands_of_the_readme(mark, word):
    assert word in command(mark)
    assert f"$(block {mark})" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PROGRAM = """
import sys
from rigidsym.commands.cli import main
import rigidsym as rs

chain = rs.derive("z(a) y(b) z(c) x(d) z(e)", ["angular_velocity_squared"])
assert chain.is_proved and chain.definitions
for axes in ("XYX", "XYZ"):
    assert rs.derive(axes, ["angular_velocity_squared"]).is_proved
motion = rs.derive("ZXZ")
assert motion.is_proved and "The squares of the components are added." in motion.page()
assert 'id="angular_velocity_squared-value"' in motion.page()
main()
"""


def test_one_entry_is_derived_proved_and_printed_everywhere(tmp_path):
    shutil.copytree(ROOT / "templates", tmp_path / "templates")
    (tmp_path / "derivations").symlink_to(ROOT / "derivations")
    package = tmp_path / "rigidsym"
    shutil.copytree(ROOT / "rigidsym", package, ignore=shutil.ignore_patterns("__pycache__"))
    recipe = PAGE[PAGE.index("**A quantity.**") : PAGE.index("**A target.**")]
    (entry,) = re.findall(r"```python\n(.*?)```", recipe, re.DOTALL)
    sentences = re.findall(r"```toml\n(.*?)```", recipe, re.DOTALL)
    table = package / "mechanics" / "quantities" / "kinematics.py"
    head, name, rest = table.read_text("utf-8").partition("\nrate_matrix_space = ")
    table.write_text(f"{head}\n{entry}\n{name}{rest}", "utf-8")
    for file, sentence in zip(("quantities", "reasons"), sentences, strict=True):
        with (tmp_path / f"templates/notes/en/{file}.toml").open("a", encoding="utf-8") as stream:
            stream.write(sentence)
    words = ("derive", "ZXZ", "--only", "angular_velocity_squared", "--target", "numpy,c")
    call(sys.executable, "-c", PROGRAM, *words, cwd=tmp_path, PYTHONPATH=str(tmp_path), PATH="")
    files = {
        path.name.removeprefix("euler_zxz_intrinsic"): path.read_text("utf-8")
        for path in (tmp_path / "out/euler_zxz_intrinsic").iterdir()
    }
    record = json.loads(files[".json"])
    (quantity,) = record["quantities"]
    assert quantity["symbol"]["text"] == "|Ω|²"
    assert quantity["because"] == "The squares of the components are added."
    assert [proof["status"] for proof in quantity["proofs"]] == ["exact"]
    assert "def angular_velocity_squared(" in files[".py"]
    assert "angular_velocity_squared" in files[".h"]
    note = files[".tex"]
    assert "The squares of the components are added." in note
    assert note.index(r"\section{The angular velocity}") < note.index("squares of the components")
