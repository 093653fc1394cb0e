"""The README's commands do what it says, in a fresh clone."""

from __future__ import annotations

import os
import re
import subprocess

import pytest

from helpers.command import ROOT

pytestmark = pytest.mark.campaign

README = (ROOT / "README.md").read_text(encoding="utf-8")


def command(mark: str) -> str:
    """The shell command behind a mark in the README."""
    match = re.search(rf"<!-- {mark} -->\n```sh\n(.+?)\n```", README, re.DOTALL)
    assert match, f"the README has no command marked {mark}"
    return match.group(1)


def test_the_main_command_gives_equation_18_in_a_fresh_clone(tmp_path):
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
    done = subprocess.run(
        ["bash", "-c", command("main")],
        cwd=clone,
        env={**os.environ, "PIP_COMPILE": "0"},  # what is imported is compiled then
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for line in ("φ̇ sin θ sin ψ + θ̇ cos ψ", "φ̇ sin θ cos ψ − θ̇ sin ψ", "φ̇ cos θ + ψ̇"):
        assert line in done.stdout
    folder = clone / "out" / "euler_zxz_intrinsic"
    assert {f.suffix for f in folder.iterdir()} == {".py", ".tex", ".html", ".json"}


def test_ci_runs_the_test_command_of_the_readme():
    assert "pytest" in command("tests")
    assert "<!-- tests -->" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
