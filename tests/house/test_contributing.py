"""The recipe of CONTRIBUTING.md for a quantity, followed word for word in a copy of the package."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys

from helpers.command import ROOT

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PROGRAM = """
import sys
from rigidsym.commands.cli import main
import rigidsym as rs

chain = rs.derive("z(a) y(b) z(c) x(d) z(e)", ["angular_velocity_squared"])
assert chain.is_proved and chain.definitions
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
    (sentence,) = re.findall(r"```toml\n(.*?)```", recipe, re.DOTALL)
    table = package / "mechanics" / "quantities" / "kinematics.py"
    head, name, rest = table.read_text("utf-8").partition("\nrate_matrix_space = ")
    table.write_text(f"{head}\n{entry}\n{name}{rest}", "utf-8")
    reasons = tmp_path / "templates" / "notes" / "en" / "reasons.toml"
    reasons.write_text(reasons.read_text("utf-8") + sentence, "utf-8")
    words = ["derive", "ZXZ", "--only", "angular_velocity_squared", "--target", "numpy,c"]
    run = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words],
        cwd=tmp_path,
        env={"PYTHONPATH": str(tmp_path), "PATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
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
