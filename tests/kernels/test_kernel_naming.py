"""Names in kernels: identifiers, each given once, whatever a person calls the coordinates."""

from __future__ import annotations

import re
import shutil
import subprocess

import numpy as np
import pytest

import rigidsym as rs
from helpers.node import load
from helpers.target_modules import EVERY
from rigidsym.kernels.lowering.lower import lower
from rigidsym.kernels.lowering.naming import Names, identifier
from rigidsym.kernels.targets import TARGETS


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("phi", "phi"),
        ("θ", "θ"),
        ("ϕ", "φ"),
        (r"\theta'", "theta"),
        ("2nd angle", "v2nd_angle"),
        ("__init__", "init"),
        ("_", "v"),
    ],
)
def test_names_become_identifiers(text, name):
    assert identifier(text) == name


def test_names_are_given_once():
    names = Names(["lambda", "x0"])
    assert [names.fresh(n) for n in ("lambda", "phi", "phi", "lambda")] == [
        "lambda_",
        "phi",
        "phi_",
        "lambda__",
    ]
    assert [names.numbered("x"), names.numbered("x")] == ["x1", "x2"]


WORDS = [
    ("lambda", "eps", "y0"),
    ("λ", "double", "M_PI"),
    ("eps_row", "least", "far"),
    ("new", "this", "arguments"),
    ("signed", "j1", "NULL"),
    ("def", "class", "None"),
]


@pytest.mark.campaign
@pytest.mark.parametrize("target", EVERY)
@pytest.mark.parametrize("names", WORDS, ids=" ".join)
def test_words_of_languages_are_renamed_so_that_every_module_loads(names, target):
    motion = rs.derive(rs.EulerAngles("ZXZ", angles=names), only=["angular_velocity_body"])
    plain = rs.derive("ZXZ", only=["angular_velocity_body"]).kernels().load()
    module = load(motion.kernels(target, conversions=True))
    given = [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]
    found = module.angular_velocity_body(*given)
    np.testing.assert_allclose(found, plain.angular_velocity_body(*given), rtol=1e-6)


def test_words_of_languages_are_renamed_alike_in_every_target():
    motion = rs.derive(rs.EulerAngles("ZXZ", angles=("lambda", "eps", "y0")))
    program = lower(motion)
    assert program.arguments[0].components == ("lambda_", "eps", "y0_")
    for target in TARGETS:
        source = " ".join(motion.kernels(target).files.values())
        assert all(re.search(rf"\b{name}\b", source) for name in ("lambda_", "eps_", "y0_"))


@pytest.mark.skipif(not shutil.which("g++"), reason="no g++")
def test_a_c_header_is_taken_by_cpp_beside_cmath(tmp_path):
    for names in WORDS:
        motion = rs.derive(rs.EulerAngles("ZXZ", angles=names), only=["rotation_matrix"])
        header = motion.kernels("c", conversions=True).write(tmp_path).with_suffix(".h")
        source = tmp_path / "use.cpp"
        source.write_text(f'#include <cmath>\n#include "{header.name}"\nint main() {{}}\n', "utf-8")
        command = ["g++", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-fsyntax-only", str(source)]
        assert subprocess.run(command, capture_output=True, check=False).returncode == 0
