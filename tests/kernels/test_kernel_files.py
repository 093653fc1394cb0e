"""Generated modules as files: formatted, documented, alone, and the way to them."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys

import pytest
from numpy.testing import assert_allclose

import rigidsym as rs
from helpers.motions import derived
from helpers.node import load
from helpers.printed_lines import LEAN, of_rotations
from helpers.target_modules import EVERY, OTHERS, inputs, module
from rigidsym import __version__
from rigidsym.errors import KernelError
from rigidsym.kernels.module import generate
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import derive

FEW = ("rotation_matrix", "angular_velocity_body", "rates_from_angular_velocity_body")


@pytest.mark.parametrize("target", TARGETS)
def test_the_files_of_the_lecture_and_the_lines_of_other_rotations(target, golden):
    """All quantities for NumPy, and those with and without a divisor for the others."""
    motion = derived("ZXZ") if target == "numpy" else derive("ZXZ", only=FEW)
    files = dict(generate(motion, target).files)
    lean = motion.kernels("c", **LEAN).files if target == "c" else {}
    files |= {f"lean_{name}": text for name, text in lean.items() if name.endswith(".c")}
    for name, text in files.items():
        golden(f"kernels/{name}.txt", text.replace(f"rigidsym {__version__};", "rigidsym *;"))
    golden(f"kernels/lines_{target}.txt", "\n".join(of_rotations(target)) + "\n")


ALONE = """
import sys
for name in ("sympy", "rigidsym", "scipy", "jinja2"):
    sys.modules[name] = None
sys.path.insert(0, sys.argv[1])
import euler_zxz_intrinsic as kernels
value = kernels.angular_velocity_body([0.1, 0.2, 0.3], [[1, 2, 3]])
assert value.shape == (1, 3)
third_party = {name.partition(".")[0] for name in sys.modules} - set(sys.stdlib_module_names)
print(sorted(n for n in third_party if getattr(sys.modules.get(n), "__file__", "")))
"""


def test_a_written_module_needs_numpy_alone(tmp_path):
    generate(derived("ZXZ")).write(tmp_path)
    command = [sys.executable, "-I", "-c", ALONE, str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "'numpy'" in done.stdout
    assert "sympy" not in done.stdout


WORDS = [
    ("x0", "least", "body"),
    ("phi", "sin_phi", "M_PI"),
    ("lambda", "eps", "y0"),
    ("λ", "double", "far"),
    ("new", "this", "arguments"),
    ("signed", "j1", "NULL"),
    ("def", "class", "None"),
]
LOADED = [pytest.param(*p.values, marks=[*p.marks, pytest.mark.campaign]) for p in OTHERS]


@pytest.mark.parametrize("target", [*EVERY[:1], *LOADED])
def test_names_that_clash_are_kept_apart(target):
    q, q_dot = inputs("ZXZ", "angular_velocity_body", (4,))
    expected = module().angular_velocity_body(q, q_dot)
    for names in WORDS:
        motion = rs.derive(rs.EulerAngles("ZXZ", angles=names), only=["angular_velocity_body"])
        titled = rs.Motion(**{**vars(motion), "title": 'Turns "by" any \\name """'})
        functions = load(titled.kernels(target, conversions=True))
        assert 'Turns "by" any \\name """' in (functions.__doc__ or titled.title)
        tolerance = 0 if target == "numpy" else 1e-5
        found = functions.angular_velocity_body(q, q_dot)
        assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


@pytest.mark.skipif(not shutil.which("g++"), reason="no g++")
def test_a_c_header_is_taken_by_cpp_beside_cmath(tmp_path):
    motion = rs.derive(rs.EulerAngles("ZXZ", angles=("M_PI", "NULL", "j1")), ["rotation_matrix"])
    header = motion.kernels("c", conversions=True).write(tmp_path).with_suffix(".h")
    source = tmp_path / "use.cpp"
    source.write_text(f'#include <cmath>\n#include "{header.name}"\nint main() {{}}\n', "utf-8")
    command = ["g++", "-Wall", "-Wextra", "-Wshadow", "-Werror", "-fsyntax-only", str(source)]
    subprocess.run(command, check=True)


OPTIONS = [
    ("c", {"leen": "double"}, "c has no option leen; did you mean lean?"),
    ("c", {"lean": True}, "lean: expected none or double or float, got True"),
    ("numpy", {"lean": "double"}, "numpy has no option lean; known: conversions, derivatives"),
    ("numby", {}, "no target 'numby'; did you mean numpy"),
]


@pytest.mark.parametrize(("target", "options", "message"), OPTIONS)
def test_other_targets_and_options_are_refused_by_name(target, options, message):
    with pytest.raises(KernelError, match=re.escape(message)):
        derived("ZXZ").kernels(target, **options)


def test_a_function_that_is_not_there_is_refused_with_the_nearest_and_what_adds_more():
    message = "has no function rotation_matrx; did you mean rotation_matrix or rotation_rate?; conv"
    with pytest.raises(AttributeError, match=re.escape(message)):
        module().rotation_matrx  # noqa: B018


WORDY = {
    "rotation_vector": "inverse_rate_matrix_body",
    "quaternion": "rates_from_angular_velocity_body",
    "modified_rodrigues": "rotation_matrix",
    "z(2*phi-psi) x(theta)": "rotation_matrix",
    "z(phi) x(theta) z(psi) y(delta)": "rates_from_angular_velocity_body",
    "[1,1,0](a) z(b) x(c)": "inverse_rate_matrix_body",
    "unit_quaternion": "angular_velocity_body",
}


def test_what_modules_say_of_angles_series_poles_and_trajectories(golden):
    heads = []
    for rotation, quantity in WORDY.items():
        motion = rs.derive(rotation, only=[quantity])
        source = motion.kernels(conversions=rotation == "modified_rodrigues").source
        heads.append(source.split('"""')[1].replace(f"rigidsym {__version__};", "rigidsym *;"))
    golden("kernels/words.txt", "\n".join(heads))
