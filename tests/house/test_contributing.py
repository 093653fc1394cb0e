"""The recipes of CONTRIBUTING.md, followed word for word in a copy of the package."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys

from helpers.command import ROOT

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")


def test_the_page_for_contributors_stays_short():
    assert PAGE.count("\n") <= 120


def test_the_recipe_for_a_quantity_gives_a_proved_quantity(tmp_path):
    for folder in ("templates", "derivations"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    package = tmp_path / "rigidsym"
    shutil.copytree(ROOT / "rigidsym", package, ignore=shutil.ignore_patterns("__pycache__"))
    recipe = PAGE[PAGE.index("**A quantity.**") : PAGE.index("**A target.**")]
    (line,) = re.findall(r"```text\n(.*?)```", recipe, re.DOTALL)
    (method,) = re.findall(r"```python\n(.*?)```", recipe, re.DOTALL)
    (entry,) = re.findall(r'`("\w+": .*)`', recipe)
    (claim,) = re.findall(r"`(SAME_LENGTH = [^`]*)`", recipe)
    table = package / "mechanics" / "quantities" / "energy.py"
    head, rows, formulas = table.read_text("utf-8").partition("    angular_momentum   ")
    formulas = formulas.replace("    {\n", f"    {{\n{entry},\n", 1)
    indented = "".join(f"    {each}\n" for each in line.splitlines())
    table.write_text(f"{head}{indented.lstrip()}{rows}{formulas}\n{claim}\n", "utf-8")
    derive = package / "mechanics" / "energy" / "derive.py"
    start, first, rest = derive.read_text("utf-8").partition("    def translational_energy(")
    body = "".join(f"    {each}\n" for each in method.splitlines())
    derive.write_text(f"{start}{body}\n{first}{rest}", "utf-8")
    program = "from rigidsym.commands.cli import main; main()"
    words = ["run", "solid_cone", "--only", "angular_momentum_squared"]
    command = [sys.executable, "-c", program, *words]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    record = json.loads((tmp_path / "out/solid_cone/solid_cone.json").read_text("utf-8"))
    (quantity,) = record["quantities"]
    assert quantity["symbol"]["text"] == "|L_R|²"
    assert [proof["status"] for proof in quantity["proofs"]] == ["exact"]
