"""The wheel, the sdist and the editable install each find their templates and derivations."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.campaign

ROOT = Path(__file__).resolve().parents[2]
PROBE = (
    "from rigidsym.system import resources\n"
    "print(resources.folder('templates'))\n"
    "assert 'euler_zxz' in resources.names('derivations', '.toml')\n"
    "import rigidsym as rs\n"
    "motion = rs.derive(rs.EulerAngles('ZXZ'))\n"
    "assert 'angular_velocity_body' in motion.kernels().source\n"
    "assert r'\\documentclass' in motion.note().latex()\n"
)


def call(*command: str | Path, cwd: Path) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
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


def test_the_editable_install_finds_the_checkout(tmp_path):
    home = tmp_path / "venv"
    venv.create(home)
    python = home / "bin" / "python"
    libraries = sysconfig.get_path("purelib", vars={"base": str(home), "platbase": str(home)})
    # The dependencies are those of the running interpreter; only rigidsym itself is installed.
    inherited = "\n".join(path for path in sys.path if path.endswith("-packages"))
    (Path(libraries) / "inherited.pth").write_text(inherited + "\n")
    pip = (sys.executable, "-m", "pip", "--python", python, "install", "--quiet")
    call(*pip, "--no-deps", "--no-build-isolation", "-e", ROOT, cwd=tmp_path)
    found = call(python, "-c", PROBE, cwd=tmp_path)
    assert Path(found.strip()) == ROOT / "templates"
