"""Laws in vectors and quaternions of Euler angles: right, wrong in one entry, and look-alikes."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.tools.compare.quantities import _laws, target

PRODUCT = (
    "[a0*b0 - a1*b1 - a2*b2 - a3*b3, a0*b1 + a1*b0 + a2*b3 - a3*b2, "
    "a0*b2 - a1*b3 + a2*b0 + a3*b1, a0*b3 + a1*b2 - a2*b1 + a3*b0]"
)
TURNED = (
    "[v.x + 2*(q.w*(q.y*v.z - q.z*v.y) + q.y*(q.x*v.y - q.y*v.x) - q.z*(q.z*v.x - q.x*v.z)), "
    "v.y + 2*(q.w*(q.z*v.x - q.x*v.z) + q.z*(q.y*v.z - q.z*v.y) - q.x*(q.x*v.y - q.y*v.x)), "
    "v.z + 2*(q.w*(q.x*v.y - q.y*v.x) + q.x*(q.z*v.x - q.x*v.z) - q.y*(q.y*v.z - q.z*v.y))]"
)
EULER = "[(tx - (Izz - Iyy)*q*r)/Ixx, (ty - (Ixx - Izz)*p*r)/Iyy, (tz - (Iyy - Ixx)*p*q)/Izz]"
TORQUE = "[I1*a1 + (I3 - I2)*w2*w3, I2*a2 + (I1 - I3)*w3*w1, I3*a3 + (I2 - I1)*w1*w2]"
STEINER = (
    "[[m*(y*y+z*z), -m*x*y, -m*x*z], [-m*x*y, m*(x*x+z*z), -m*y*z], [-m*x*z, -m*y*z, m*(x*x+y*y)]]"
)
TENSOR = (
    "[[Ixx + m*(dy^2 + dz^2), Ixy - m*dx*dy, Ixz - m*dx*dz], [Ixy - m*dx*dy, "
    "Iyy + m*(dx^2 + dz^2), Iyz - m*dy*dz], [Ixz - m*dx*dz, Iyz - m*dy*dz, Izz + m*(dx^2 + dy^2)]]"
)
HALF = (
    "[cos(r/2)*cos(p/2)*cos(y/2) + sin(r/2)*sin(p/2)*sin(y/2), "
    "sin(r/2)*cos(p/2)*cos(y/2) - cos(r/2)*sin(p/2)*sin(y/2), "
    "cos(r/2)*sin(p/2)*cos(y/2) + sin(r/2)*cos(p/2)*sin(y/2), "
    "cos(r/2)*cos(p/2)*sin(y/2) - sin(r/2)*sin(p/2)*cos(y/2)]"
)
RIGHT = {  # formula: its law, a change that makes one entry wrong, and the kind of the repair
    PRODUCT: ("quaternion_product", ("- a1*b3", "+ a1*b3"), "sign"),
    TURNED: ("turned_vector", ("(q.y*v.z - q.z*v.y) +", "(q.y*v.z + q.z*v.y) +"), "sign"),
    EULER: ("euler_equations_acceleration", ("(Ixx - Izz)", "(Izz - Ixx)"), "sign"),
    TORQUE: ("euler_equations_torque", ("w3*w1", "w3*w2"), "index"),
    STEINER: ("parallel_axis_term", ("(y*y+z*z)", "(y*y+z*x)"), "index"),
    TENSOR: ("parallel_axis_theorem", ("m*(dx^2 + dy^2)", "m*(dx^2 - dy^2)"), "sign"),
    HALF: ("quaternion of ZYX", ("- cos(r/2)*sin(p/2)", "- sin(r/2)*sin(p/2)"), "sine and cosine"),
}


@pytest.mark.parametrize("text", RIGHT, ids=[name for name, _, _ in RIGHT.values()])
def test_a_law_is_proved_and_one_wrong_entry_is_named(text):
    name, change, kind = RIGHT[text]
    right, wrong = rs.compare(text), rs.compare(text.replace(*change, 1))
    assert (str(right.found), right.is_equal, right.is_proved) == (name, True, True)
    assert (str(wrong.found), wrong.is_equal, wrong.is_proved) == (name, False, True)
    assert [repair.kind for repair in wrong.repairs] == [kind]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PRODUCT.replace("a0*b0 - ", "a0*b0 + ").replace("+ a", "- a"), ""),
        ("[tx/Ixx, ty/Iyy, tz/Izz]", ""),  # a small body may be spun without gyroscopic torque
        ("[a2*b3 - a3*b2, a3*b1 - a1*b3, a1*b2 - a2*b1]", ""),
        ("[[m*y*y, -m*x*y, -m*x*z], [-m*x*y, m*z*z, -m*y*z], [-m*x*z, -m*y*z, m*x*x]]", ""),
        (HALF.replace("/2", ""), ""),
        (STEINER.replace("-m", "m"), "off-diagonal entries with the other sign"),
        (TENSOR.replace("+ m", "! m").replace("- m", "+ m").replace("!", "-"), "to the centre"),
        (PRODUCT.replace("a1", "(-a1)").replace("a2", "(-a2)").replace("a3", "(-a3)"), "the first"),
        (HALF.replace("sin(r/2)", "-sin(r/2)"), "with the opposite sense of r"),
    ],
)
def test_look_alikes_and_other_ways_of_writing_are_not_called_wrong(text, words):
    found = rs.compare(text)
    assert found.repairs == ()
    assert words in found.arrangement if words else not found.is_equal or found.is_proved


@pytest.mark.parametrize("axes", ["ZYX", "ZXZ", "xyz"])
def test_quaternions_of_angles_are_those_of_scipy(axes):
    goal = target(axes, "quaternion")
    angles = [0.3, -0.8, 1.1]
    values = dict(zip(goal.inputs["q"], angles, strict=True))
    ours = np.array(goal.matrix.xreplace(values).evalf(), float).ravel()
    x, y, z, w = Rotation.from_euler(axes, angles).as_quat()
    assert ours == pytest.approx([w, x, y, z])
    last = goal.matrix.extract([1, 2, 3, 0], [0])
    names = {s: sp.Symbol(name) for name, s in goal.coordinates.items()}
    assert rs.compare(-last.xreplace(names)).arrangement == "scalar last, negative"


def test_laws_hold_in_numbers():
    """The product, the turned vector and Steiner's theorem by SciPy and by the sum over a body."""
    rng = np.random.default_rng(3)
    a, b, v = Rotation.random(random_state=1), Rotation.random(random_state=2), rng.normal(size=3)
    by_name = {law.quantity: law for law in _laws()}

    def value(name, *vectors):
        law = by_name[name]
        numbers = dict(zip(sum(law.inputs.values(), ()), np.concatenate(vectors), strict=True))
        return np.array(law.matrix.xreplace(numbers), float).squeeze()

    first = lambda turn: np.roll(turn.as_quat(), 1)  # noqa: E731
    products = value("quaternion_product", first(a), first(b))
    assert np.abs(products @ first(a * b)) == pytest.approx(1)
    assert value("turned_vector", first(a), v) == pytest.approx(a.apply(v))
    term = value("parallel_axis_term", [2.5], v)
    assert term == pytest.approx(2.5 * (v @ v * np.eye(3) - np.outer(v, v)))
    w, moments, torque = rng.normal(size=(3, 3))
    rate = value("euler_equations_acceleration", w, moments, torque)
    assert moments * rate + np.cross(w, moments * w) == pytest.approx(torque)
    assert value("euler_equations_torque", w, moments, rate) == pytest.approx(torque)
