"""Generated modules as files: formatted, documented, alone, and the way to them."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import rigidsym as rs
from helpers.motions import derived
from helpers.printed_lines import LEAN, of_rotations
from helpers.target_modules import inputs, module, turned_by
from rigidsym import __version__
from rigidsym.commands.list import inventory
from rigidsym.errors import KernelError
from rigidsym.kernels import targets
from rigidsym.kernels.module import generate
from rigidsym.kernels.targets import TARGETS
from rigidsym.motion import derive

FEW = ("rotation_matrix", "angular_velocity_body", "rates_from_angular_velocity_body")


@pytest.mark.parametrize("target", TARGETS)
def test_the_files_of_the_lecture(target, golden):
    """All quantities for NumPy, and those with and without a divisor for the others."""
    motion = derived("ZXZ") if target == "numpy" else derive("ZXZ", only=FEW)
    for name, text in generate(motion, target).files.items():
        text = text.replace(f"rigidsym {__version__};", "rigidsym *;")
        golden(f"kernels/{name}.txt", text)


def test_the_lean_files_of_the_lecture(golden):
    for name, text in derive("ZXZ", only=FEW).kernels("c", **LEAN).files.items():
        if name.endswith(".c"):
            golden(f"kernels/lean_{name}.txt", text)


@pytest.mark.parametrize(
    ("target", "options", "named"),
    [
        ("c", {"leen": "double"}, "no option leen; did you mean lean?"),
        ("c", {"lean": True}, "expected one of 'none', 'double', 'float', got True"),
        ("c", {"libm": True}, 'c has no option libm; lean = "double" or "float" prints one plain'),
        ("numpy", {"lean": "double"}, "numpy has no option lean"),
    ],
)
def test_other_options_are_refused_by_name(target, options, named):
    with pytest.raises(KernelError, match=re.escape(named)):
        rs.derive("ZXZ", only="rotation_matrix").kernels(target, **options)


@pytest.mark.parametrize("target", TARGETS)
def test_each_target_prints_the_same_lines(target, golden):
    golden(f"kernels/lines_{target}.txt", "\n".join(of_rotations(target)) + "\n")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Two conventions and long names, as files."""
    folder = tmp_path_factory.mktemp("written")
    for sequence in ("ZXZ", "zyx"):
        generate(derived(sequence)).write(folder)
    long = ["the_first_angle_of_the_three_that_we_use", "second_angle_of_the_three", "l"]
    generate(turned_by("long_names", *long)).write(folder)
    return folder


ALONE = """
import sys
for name in ("sympy", "rigidsym", "scipy", "jinja2"):
    sys.modules[name] = None
sys.path.insert(0, sys.argv[1])
import euler_zxz_intrinsic as kernels
import pickle
value = kernels.angular_velocity_body([0.1, 0.2, 0.3], [[1, 2, 3]])
assert value.shape == (1, 3)
assert pickle.loads(pickle.dumps(kernels.rotation_matrix)) is kernels.rotation_matrix
third_party = {name.partition(".")[0] for name in sys.modules} - set(sys.stdlib_module_names)
print(sorted(n for n in third_party if getattr(sys.modules.get(n), "__file__", "")))
"""


def test_a_written_module_needs_numpy_alone(written):
    done = subprocess.run(
        [sys.executable, "-I", "-c", ALONE, str(written)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "'numpy'" in done.stdout
    assert "sympy" not in done.stdout


def test_divisors_are_written_in_the_inputs_of_a_function():
    """No reader knows x1, a name of an intermediate value"""
    for rotation, divisor in (
        (rs.RotationVector(), "c2(v1 * v1 + v2 * v2 + v3 * v3)"),
        (rs.rotation_from("[1,1,0](a) z(b) x(c)"), "sin(b) - cos(b)"),
    ):
        source = rs.derive(rotation, "inverse_rate_matrix_body").kernels("numpy").source
        assert f"Divides by {divisor}, near whose zeros" in source


def test_names_that_clash_are_kept_apart():
    for names in (("x0", "out", "np"), ("phi", "sin_phi", "phi_dot"), ("lambda", "q", "sin")):
        functions = generate(turned_by("clash", *names)).load()
        q, q_dot = inputs("ZXZ", "angular_velocity_body", (4,))
        for name in ("rotation_matrix", "angular_velocity_body", "angular_acceleration_space"):
            arrays = [q, q_dot, q_dot][: len(derived("ZXZ").step(name).quantity.inputs)]
            found = getattr(functions, name)(*arrays)
            assert_array_equal(found, getattr(module(), name)(*arrays))
            pole = np.full(3, np.inf)
            assert np.isnan(getattr(functions, name)(*[pole] * len(arrays))).any()
    parameters = inspect.signature(functions.rotation_matrix_scalar).parameters
    assert list(parameters) == ["lambda_", "q", "sin_"]


def test_text_of_a_person_cannot_leave_the_docstring():
    functions = generate(turned_by("quotes", "a", "b", "c")).load()
    assert functions.__doc__.startswith('Turns "by" any \\name """: functions of NumPy arrays.')


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("quaternion", "conversions=True adds the conversions"),
        ("rotation_matrix_jacobian_q", "derivatives=[...] adds derivatives"),
        ("rotation_matrx", "did you mean rotation_matrix or rotation_rate?"),
    ],
)
def test_a_function_that_is_not_there_is_refused_with_what_gives_it(name, remedy):
    with pytest.raises(AttributeError) as caught:
        getattr(module(), name)
    assert str(caught.value) == f"euler_zxz_intrinsic.py has no function {name}; {remedy}"


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


PRINTER = """
from types import ModuleType

from rigidsym.kernels.ir import FUNCTIONS
from rigidsym.kernels.targets.infix import infix

RESERVED = frozenset({"theta"})


def render(program):
    names = {name: name.upper() for name in FUNCTIONS}
    lines = []
    for kernel in program.kernels:
        lines.append(f"FUNCTION {kernel.name}({', '.join(kernel.components)})")
        lines += [f"  {a.name} := {infix(a.value, names)}" for a in kernel.assignments]
        lines += [f"  RESULT {infix(value, names)}" for value in kernel.outputs]
    return {f"{program.name}.toy": "\\n".join(lines) + "\\n"}


def load(name, files):
    module = ModuleType(name)
    module.text = "".join(files.values())
    return module
"""
ZXZ = """\
FUNCTION angular_velocity_body(phi, theta_, psi, phi_dot, theta_dot, psi_dot)
  sin_theta := SIN(theta_)
  cos_theta := COS(theta_)
  sin_psi := SIN(psi)
  cos_psi := COS(psi)
  x0 := phi_dot * sin_theta
  RESULT theta_dot * cos_psi + x0 * sin_psi
  RESULT x0 * cos_psi - theta_dot * sin_psi
  RESULT phi_dot * cos_theta + psi_dot
"""


def test_a_file_and_its_line_print_and_load(tmp_path, monkeypatch):
    (tmp_path / "toy.py").write_text(PRINTER, encoding="utf-8")
    monkeypatch.setattr(targets, "__path__", [*targets.__path__, str(tmp_path)])
    monkeypatch.setitem(targets.TARGETS, "toy", targets.Target(about="NAME.toy", ending=".toy"))
    motion = rs.derive("ZXZ", only=["angular_velocity_body"])
    kernels = motion.kernels("toy")
    del sys.modules[f"{targets.__name__}.toy"]
    assert kernels.source.splitlines() == ZXZ.splitlines()
    assert kernels.load().text == kernels.source
    with pytest.raises(KernelError, match=r"no target 'toi'; did you mean toy"):
        motion.kernels("toi")


def test_every_target_is_a_file_of_the_same_form():
    for name, target in targets.TARGETS.items():
        printer = targets.printer(name)
        assert {"RESERVED", "render", "load"} <= vars(printer).keys()
        assert target.about.startswith("NAME")
        assert f"{name} " in inventory()
