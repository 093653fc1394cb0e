"""`rigidsym compare` on source files and functions: what is found, named, and found wrong.

Formulas of public code are written in their own files here, with the repository and the line they
stand in; only the formula is theirs.
"""

from __future__ import annotations

import json
import operator
import re
import tomllib
from contextlib import nullcontext
from time import process_time, sleep

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

import rigidsym as rs
import rigidsym.tools.compare.search
from helpers.command import ROOT, call
from rigidsym.commands.cli import commands
from rigidsym.errors import ExpressionError
from rigidsym.tools.compare.comparison import identified
from rigidsym.tools.compare.program import formula_matrix, program_formulas
from rigidsym.tools.compare.quantities import _angles, target
from rigidsym.tools.compare.search import formulas, search, source_files
from rigidsym.tools.compare.syntax import GRAMMARS, limits, patterns

W_BODY = "[[1, 0, -sin(b)], [0, cos(a), sin(a)*cos(b)], [0, -sin(a), cos(a)*cos(b)]]"


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("{{cosf(a), -sinf(a)}, {sinf(a), std::cos(a)}}", "[[cos(a),-sin(a)],[sin(a),cos(a)]]"),
        ("[1 -s; 0 q(2)^2]", "[[1,-s],[0,q_2**2]]"),
        ("[1 - s, 0\n 2 c*s]", "[[1-s,0],[2,c*s]]"),
        ("np.array([self.phi, x[3]*2.0], dtype=float)", "[phi, x_3*2.0]"),
        ("[1 - c^2, -2^2]", "[1 - c**2, -4]"),
        ("float R[9] = {1, 0, 0, 0, c, -s, 0, s, c};", "[[1, 0, 0], [0, c, -s], [0, s, c]]"),
        ("pow(q.w(), 2) + state->roll", "pow(q_w,2)+roll"),
        (r"\dot\phi \sin^2\theta + \tfrac12 x_1", "phi_dot*sin(theta)**(2)+((1)/(2))*x_1"),
        (r"\sqrt{x^2}\,(a + b) \sqrt2 y", "sqrt(x**(2))*(a+b)*sqrt(2)*y"),
        (r"c\theta^2 - \sin^{-1}(\frac{a}2 b)", "cos(theta)**2 - asin(a/2*b)"),
        (r"\sin(\theta)^2 + \cos\left(a\right)^{-1} - \sqrt{b}^3", "sin(theta)**2+1/cos(a)-b**1.5"),
        (r"\dot{\phi}_{12} + \ddot{x}", "phi_12_dot + x_ddot"),
        (r"R = \begin{pmatrix} a & b \\[2pt] w\,x & \sin 2\theta \end{pmatrix}", None),
    ],
)
def test_notations_are_read_as_one_language(text, read):
    expected = formula_matrix(read or "[[a, b], [w*x, sin(2*theta)]]")
    assert formula_matrix(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        *("__import__('os')", "(lambda: 1)()", "[x for x in y]", "9**9**9", "1e999"),
        *("(" * 5000, "[" * 300 + "]" * 300, "x" * 30_000, "\0", "[1, [2, [3]]", "one(10**9)"),
        *("[[a, b], [c]]", r"\sin x_{a+b}", "sin(a, b)", "[[a, b], [c, d]] / [[1, 2], [3, 4]]"),
        *("one(20) + [a" + ", a" * 20 + "]", "a < b", "([[a+b, 1], [a, c]]**8)**8"),
        *(r"\frac{", r"\begin{pmatrix} & \end{pmatrix}", r"\input{a}", "eye(" + "9" * 5000 + ")"),
    ],
)
def test_hostile_text_is_refused(text):
    with pytest.raises(ExpressionError):
        rs.compare(text)


ABOUT_X = r"\begin{bmatrix}1&0&0\\0&c\phi&-s\phi\\0&s\phi&c\phi\end{bmatrix}"
ABOUT_Z = r"\begin{bmatrix}\cosψ&-\sin\psi&0\\ \sin\psi&\cos\psi&0\\0&0&1\end{bmatrix}"
RATES = r"\begin{pmatrix}\dot\phi\\ \dot\theta\\ \dot\psi\end{pmatrix}"
TO_BODY = r"1&0&-s_\theta\\0&c_\phi&s_\phi c_\theta\\0&-s_\phi&c_\phi c_\theta"
PRODUCTS = {
    rf"\mathbf{{A}} = \left({ABOUT_Z}{ABOUT_X}\right)^\top.": "rotation_matrix of z(first) "
    "x(second), transposed (passive, for row vectors, or by columns)",
    rf"{RATES} = \left[\begin{{array}}{{ccc}}{TO_BODY}\end{{array}}\right] {RATES}": "angular_"
    "velocity_body of ZYX",
}


@pytest.mark.parametrize(("text", "read"), PRODUCTS.items(), ids=range(len(PRODUCTS)))
def test_products_and_transposes_of_matrices_are_read_in_latex(text, read):
    found = rs.compare(text)
    own = f"{found.found}, {found.arrangement}".strip(", ")
    assert (own, found.is_proved) == (read, True)


@pytest.mark.parametrize(
    "text",
    [
        r"R = #\,.",
        r"R = #, \quad \phi = \omega t",
        r"R = #, \quad \text{where}",
        r"R = # = \mathbf{R}_z(\phi)",
        r"\begin{align}R &= #\\\end{align}",
        "R = # % a comment",
        r"R = (#^{\mathsf T})^T",
    ],
)
def test_what_stands_beside_a_matrix_in_latex_is_left_out(text):
    array = ABOUT_Z.replace("{bmatrix}", "{array}")
    assert formula_matrix(array.replace("{array}", "{array}{c c|c}", 1)) == formula_matrix(ABOUT_Z)
    assert formula_matrix(text.replace("#", ABOUT_Z)) == formula_matrix(ABOUT_Z)


def test_a_letter_without_a_meaning_is_refused_in_latex():
    with pytest.raises(ExpressionError, match="unexpected 'é' in LaTeX"):
        rs.compare(r"\begin{pmatrix}\cos é&0\\0&1\end{pmatrix}")


def test_products_of_numpy_arrays_are_those_of_their_entries(tmp_path):
    a = "np.array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]])"
    b = "np.array([[1, 0, 0], [0, cos(b), -sin(b)], [0, sin(b), cos(b)]])"
    assert rs.compare(f"{a} @ {b}").is_equal
    assert rs.compare(f"{a} * {b}").found is None
    for line, product, count in (
        ("import numpy as np", "A * B", 2),
        ("import torch  # sympy", "A * B", 2),
        ("import torch", "torch.mul(A, B)", 2),
        ("import numpy as np", "np.inner(A, B)", 2),
        ("from sympy import *", "A * B", 3),
        ("from sympy import *\nimport numpy as np", "A * B", 2),
    ):
        text = f"{line}\ndef matrix(a, b):\n    A = {a}\n    B = {b}\n    return {product}\n"
        assert len(found_in(tmp_path, "a.py", text)) == count


def run(*arguments):
    return CliRunner().invoke(commands, ["compare", *arguments])


def found_in(tmp_path, name, text):
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    return [each for each in search(file) if each.comparison]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("R << cos(a), -sin(a), 0, sin(a), cos(a), 0, 0, 0, 1;\nS = R;", [(1, "R")]),
        ("p = cos(a)*x - sin(a)*y;\nq = sin(a)*x + cos(a)*y;\nr = z;", [(1, "p, q, r")]),
        ("k[0] = cos(a); k[0][1] = sin(a);", []),
    ],
)
def test_streams_components_and_entries_are_followed(text, expected):
    body = f"void f() {{ {text} }}"
    assert [(each.line, each.name) for each in formulas(body, ".cpp") if each.forms] == expected


def test_files_are_those_of_known_languages_and_others_are_refused(tmp_path):
    for name in ("b.py", "a.c", "notes.txt", "sub/d.m", ".venv/e.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("x = 1")
    (tmp_path / "binary.cpp").write_bytes(b"\x7fELF\0\0 cos(a)*sin(b)")
    found = [file.relative_to(tmp_path).as_posix() for file in source_files([tmp_path])]
    assert found == ["a.c", "b.py", "sub/d.m"]
    message = "README.md: expected a folder, or a file .py, .c, "
    assert message in call("compare", str(ROOT / "README.md"), cwd=tmp_path, status=2).stderr


def test_a_function_is_read_in_its_file():
    with pytest.raises(ExpressionError, match="`rigidsym compare FILE` reads functions"):
        rs.compare(np.sin, "ZYX", "rotation_matrix")


def test_the_command_says_what_is_wrong_and_returns_one():
    text = W_BODY.replace("-sin(b)", "sin(b)")
    done = run("--formula", text, "--rotation", "xyz", "--quantity", "rate_matrix_body")
    assert "entry (1, 3): sin(b) should be -sin(b)" in done.stdout
    assert (done.exit_code, run("--formula", W_BODY).exit_code) == (1, 0)


def test_the_command_needs_a_formula_or_paths(tmp_path):
    assert run().exit_code == 2
    half = call("compare", "--formula", "[a, b]", "--rotation", "ZYX", cwd=tmp_path, status=2)
    assert "a formula is compared with --quantity NAME of --rotation" in half.stderr
    assert run(str(tmp_path), "--rotation", "ZYX", "--quantity", "rotation_matrix").exit_code == 2


def test_a_folder_without_formulas_is_told_from_a_right_one(tmp_path):
    empty = call("compare", str(tmp_path), cwd=tmp_path, status=2)
    assert "no source files; looked for .py, .c, .h, " in empty.stderr
    (tmp_path / "a.py").write_text("x = 1\n")
    assert "no known formula in 1 file\n" in call("compare", ".", cwd=tmp_path).stderr
    required = call("compare", ".", "--require", "1", cwd=tmp_path, status=1)
    assert "expected at least 1 (--require)" in required.stderr


TURN = "np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])"
SINES = "c, s = np.cos(phi), np.sin(phi)"
CHANGED = {  # statements of a function of phi and psi: what its matrix is
    f"phi = -phi; {SINES}; return {TURN}": "transposed",
    f"phi *= -1; {SINES}; return {TURN}": "transposed",
    f"phi = np.pi/2 - phi; {SINES}; return {TURN}": "from another axis",
    f"phi, psi = psi, phi; {SINES}; return {TURN}": "with psi as angle",
    f"{SINES}; M = {TURN}; M[0, 1] = s; return M": "entry (1, 2): sin(phi) should be -sin(phi)",
    f"{SINES}; M = {TURN}; change(M); return M": "equal to",  # before it is changed
    f"{SINES}; M = {TURN}; N = M; N[0, 1] = s; return M": "entry (1, 2)",
    f"{SINES}\n    if flip: s = -s\n    return {TURN}": "in one of several branches",
    f"{SINES}\n    if flip: return None\n    return {TURN}": "equal to",
    f"{SINES}\n    if 0: s = -s\n    return {TURN}": "equal to",
    f"{SINES}\n    for k in range(n): s = -s\n    return {TURN}": "",
    f"{SINES}\n    for k in range(n):\n        s = -s\n        break\n    return {TURN}": "",
    f"{SINES}; M = {TURN}\n    if flip: M[0, 1] = s\n    return M": "branches",
    f"{SINES}\n    for k in range(n):\n        M = {TURN}\n        s = -s\n    return c": "",
    f"{SINES}\n    s += 0.1\n    return {TURN}": "(a term too many)",
    f"(phi := -phi); {SINES}; return {TURN}": "",
    f"{SINES}; M = {TURN}; M *= -1; M[0] = [0, 0, 1]; return M": "",
    f"def g():\n        nonlocal phi\n        phi = -phi\n    g(); {SINES}; return {TURN}": "",
    f"{SINES}; M = {TURN}; N = M\n    if flip: pass\n    N[0, 1] = s; return M": "entry (1, 2)",
    f"{SINES}; M = {TURN}; N = M; N *= -1; return M": "",
    f"{SINES}\n    try: g()\n    except OSError: s = -s\n    return {TURN}": "branches",
    f"{SINES}; return np.array([c, -s, 0, s, c, 0, 0, 0, 1]).reshape((3, 3), order='F')": "",
    f"phi = psi % 1.4; {SINES}; return {TURN}": "; not read: phi in line 3",
    f"phi %= 2*np.pi; {SINES}; return {TURN}": "; not read: phi in line 3",
    f"{SINES}; return np.array([c, -s, 0, s, c, 0, 0, 0, 1]).reshape(3, 3).T": "transposed",
    f"{SINES}; M = {TURN}; M[[0, 1]] = M[[1, 0]]; return M": "equal to",  # before it is changed
    f"{SINES}; M = {TURN.replace('-s', 's')}; M[0, -2] *= -1; return M": "",
    f"{SINES}; M = {TURN.replace('-s', 's')}; M = M*signs; return M": "",
    f"{SINES}; M = {TURN.replace('-s', 's')}; N = M.T; N[1, 0] = -s; return M": "transposed",
    f"turn = lambda phi: {TURN.replace('c', 'np.cos(phi)').replace('s,', 'np.sin(phi),')}; "
    f"{SINES}; return {TURN}": "equal to",
}  # fmt: skip


@pytest.mark.parametrize(("text", "said"), CHANGED.items(), ids=range(len(CHANGED)))
def test_all_that_happens_to_a_name_before_its_use_is_followed(tmp_path, text, said):
    file = tmp_path / "a.py"
    file.write_text(f"import numpy as np\ndef f(phi, psi, flip, n, self):\n    {text}\n")
    said_of_all = [str(each) for each in search(file) if each.formula.line > 2 and each.comparison]
    whole = [each for each in said_of_all if "of z(" in each]
    assert bool(whole) == bool(said), whole
    assert all(said in each for each in whole)


ROWS = "c, -s, 0, s, c, 0, 0, 0, 1"
INNER = (
    f"let c = Math.cos(a), s = Math.sin(a); # return [[{ROWS[:8]}], [{ROWS[10:17]}], [0, 0, 1]];"
)
OF_C = f"double c = cos(a), s = sin(a); # double R[9] = {{{ROWS}}};"
ALIASES = {  # a file, a statement in place of # in its function: the verdict on its matrix
    ("a.js", INNER, "{ let s = c; }"): "equal to",
    ("b.js", INNER, "{ var s = c; }"): "close to",
    ("c.js", INNER, "s |= 0;"): None,
    ("a.cpp", OF_C, "{ double s = c, *c; }"): "equal to",
    ("b.cpp", OF_C, "double& t = s; t = -t;"): None,
    ("c.cpp", OF_C, "double* t = &s; *t = -s;"): None,
    ("d.cpp", OF_C, "s = sin((int)a);"): None,
    ("e.cpp", OF_C, "int k = a/2; s = sin(k);"): None,
    ("f.cpp", f"M R; double c = cos(a), s = sin(a); R << {ROWS}; #", "M S = R.transpose();"): "z(",
    ("g.cpp", f"M R; double c = cos(a), s = sin(a); R << {ROWS.replace('-', '')}; #", "M& r = R; "
    "r(0, 1) = -s;"): "equal to",
}  # fmt: skip


@pytest.mark.parametrize("case", ALIASES, ids=lambda case: case[0])
def test_names_end_with_their_block_and_objects_may_have_two(tmp_path, case):
    name, body, statement = case
    text = body.replace("#", statement)
    function = (
        f"function f(a) {{ {text} }}" if name.endswith("js") else f"void f(double a) {{ {text} }}"
    )
    said = [str(each) for each in found_in(tmp_path, name, function)]
    assert bool(said) == bool(ALIASES[case]), said
    assert all(ALIASES[case] in each for each in said)
    assert ("transposed" in "".join(said[1:])) == ("transpose" in statement)


TURNED = "R[0]=c; R[1]=-s; R[2]=0; R[3]=s; R[4]=c; R[5]=0; R[6]=0; R[7]=0; R[8]=1;"
COLUMNS = "(cos(a), sin(a), 0, -sin(a), cos(a), 0, 0, 0, 1)"
SQUARES = "x*x + y*y"
AXIS = (
    "s = sin(a), c = cos(a), t = 1 - c; R[0]=t*x*x + c; R[1]=t*x*y - s*z; R[2]=t*x*z + s*y;"
    "R[3]=t*x*y + s*z; R[4]=t*y*y + c; R[5]=t*y*z - s*x; R[6]=t*x*z - s*y; R[7]=t*y*z + s*x;"
    "R[8]=t*z*z + c;"
)
EXACT = {  # bodies of void f(int k, double a, x, y, z, R[9]) in C++: the words for R
    f"double h = 1/2*a, c = cos(h), s = sin(h); {TURNED}": "; not read: h in line 1",
    f"double c = cos(std::min(a, 1.0)), s = sin(std::min(a, 1.0)); {TURNED}": "",
    f"double s = k ? sin(a) : 0, c = cos(a); {TURNED}": "in one of several branches",
    f"double s = sin(a), c = cos(a); switch (k) {{ case 0: s = -s; case 1: s = 2*s; }} {TURNED}": (
        "a as angle (proved); in one of several branches"
    ),
    f"double s = cosine(a), c = cos(a); {TURNED}": "",
    f"double s = sinus(a), c = cos(a); {TURNED}": "(proved)",
    f"glm::dmat3 m{COLUMNS}; R = m;": "a as angle (proved)",
    f"x = x/sqrt({SQUARES}); y = y/sqrt({SQUARES}); {AXIS}": "",
    f"double n = sqrt({SQUARES}); x /= n; y /= n; {AXIS}": "",
    f"double n = sqrt({SQUARES} + z*z); x /= n; y /= n; z /= n; {AXIS}": "(proved)",
}


FLAT = "[cos(a), sin(a), 0, -sin(a), cos(a), 0, 0, 0, 1]"
ABOUT = (
    " double c = cos(a), s = 2*sin(h(a))*cos(h(a)), R[9] = {c, -s, 0, s, c, 0, 0, 0, 1}; } "
    "double h(double a) { return a/2; } "
)
ABOUT_JS = (
    "function f(a) { let c = Math.cos(a), s = k(1)*Math.sin(a); let R = [[c, -s, 0], [s, c, 0],"
)
BATCH = (
    "def f(a):\n    c, s = torch.cos(a), torch.sin(a)\n    r = torch.stack([c, -s, 0*c], {})\n"
    "    return torch.stack([r, torch.stack([s, c, 0*c], {}), torch.stack([0*c, 0*c, 1], {})], 1)\n"
)
OF_Q = "[{}(y*y+z*z), s*(x*y-w*z), s*(x*z+w*y)], [s*(x*y+w*z), {}(x*x+z*z), s*(y*z-w*x)], [s*(x*z-"
BREAK = "switch (n) { case 1: if (n > 0) { s = -s; break; } f(); }"
BY_COLUMNS = "{ let (s, c) = a.sin_cos(); Matrix3::new(c, s, 0, -s, c, 0, 0, 0, 1) }"
OWN = "double sinus(double x) { return sin(x); } double cosine(double x) { return x; }"
OWN += " void f(int k, double a, double x, double y, double z, double R[9]) {"
HALF = "q[0] = cos(deg/2); q[1] = sin(deg/2); q[2] = 0; q[3] = 0;"
OF_JAVA = "class A {{ double[] f({} a) {{ return new double[]{{cos(a/2), sin(a/2), 0, 0}}; }} }}"
OF_ENTRIES = TURNED.replace("s", "sin(a)").replace("c", "cos(a)")
OF_MEMBER = HALF.replace("deg", "p.deg")
TYPES = ("long", "int32_t", "unsigned", "const short", "const int&")
WHOLE = [  # divisions and matrices of whole numbers, which are rounded
    *(("c", f"void f({kind} deg, float q[4]) {{ {HALF} }}") for kind in TYPES),
    ("c", f"void f(int n, float q[4]) {{ int x, deg; deg = n; {HALF} }}"),
    ("c", f"void f(int n, int deg, float q[4]) {{ {HALF} }}"),
    ("cpp", f"struct P {{ int deg; }}; void f(P& p, float q[4]) {{ {OF_MEMBER} }}"),
    *(("java", OF_JAVA.format(kind)) for kind in ("long", "Integer")),
    ("rs", "fn f(a: i32) -> [f64; 4] { [((a / 2) as f64).cos(), ((a / 2) as f64).sin(), 0., 0.] }"),
    ("cpp", f"void f(double a, int R[9]) {{ {OF_ENTRIES} }}"),
    (
        "cpp",
        "Eigen::Matrix3i f(double a) { Eigen::Matrix3i m; m << cos(a), -sin(a), 0, sin(a), "
        "cos(a), 0, 0, 0, 1; return m; }",
    ),
    ("py", f"def f(a):\n    return np.array({FLAT}).astype(int)\n"),
    ("py", f"def f(a):\n    return np.array({FLAT}, dtype=np.int32)\n"),
    (
        "py",
        "def f(a):\n    R = np.eye(3, dtype=int)\n    R[0, 0] = cos(a); R[0, 1] = -sin(a)\n    "
        "R[1, 0] = sin(a); R[1, 1] = cos(a); R[2, 2] = 1\n    R[0, 2] = R[1, 2] = R[2, 0] = R[2, "
        "1] = 0\n    return R\n",
    ),
]
NAN = "; asin has no bounds: by rounding at a pole it may be NaN"
CERTAIN = {("z.cpp", f"{OWN} {body} }}"): words for body, words in EXACT.items()}
CERTAIN |= {  # a program: the end of the verdict, and nothing if there is none
    ("a.cpp", f"void f(double a) {{{ABOUT}"): "(proved)",
    ("b.cpp", f"void f(double a) {{{ABOUT} double h(double a, int k) {{ return a; }}"): "(proved)",
    ("c.cpp", f"struct A {{ double h(double a, int k = 1); void f(double a) {{{ABOUT}}}; "
     "double h(double a, int k) { return a; }"): None,
    ("a.js", f"function k(a) {{ return 1; }} {ABOUT_JS} [0, 0, 1]]; }}"): "(proved)",
    ("b.js", f"function k(a) {{ return 1; }} function k(a, b) {{ return -1; }} {ABOUT_JS}"
     " [0, 0, 1]]; }"): None,
    ("c.py", "def f(R):\n    b = -np.arcsin(R[2, 0])\n    near = np.isclose(np.cos(b), 0, 1e-6)\n"
     "    return np.where(near, 0, np.arctan2(R[2, 1], R[2, 2])), b, np.arctan2(R[1, 0], R[0, 0]) "
     "if abs(np.cos(b)) < 1e-6 else 0\n"): None,
    ("d.py", BATCH.format(0, 0, 0)): "by columns) (proved)",
    ("e.py", BATCH.format(1, 1, 1)): None,
    ("f.py", "def f(R):\n    a, b, c = torch.unbind(R, -1)\n    return torch.atan2(c[1], c[2]), "
     "torch.asin(-c[0]), torch.atan2(b[0], a[0])\n"): None,
    ("g.py", "def f(w, x, y, z):\n    s = helper()\n    return [" + OF_Q.format("1-s*", "1-s*")
     + "w*y), s*(y*z+w*x), 1-s*(x*x+y*y)]]\n"): "if s = 2/(w**2 + x**2 + y**2 + z**2) (proved); "
    "not read: s in line 2",
    ("h.py", "def f(R):\n    M, n = R.T, R[:, 0]\n    return np.arctan2(M[1, 2], R[2, 2]), "
     "np.arcsin(-n[2]), np.arctan2(n[1], R[0, 0])\n"): "euler_angles of xyz (to nine digits at 20 "
    f"points, not proved){NAN}",
    ("i.py", "def f(w, x, y, z):\n    s = np.clip(2*(w*y - z*x), -0.99, 0.99)\n    return atan2("
     "2*(w*x + y*z), 1 - 2*(x*x + y*y)), np.arcsin(s), np.arctan2(2*(w*z + x*y), 1 - 2*(y*y + "
     "z*z))\n"): None,
    ("i.c", "short a;\nvoid f(float a, double q[4]) { // a short name\n double h = a/2; q[0] = cos("
     "h); q[1] = sin(h); q[2] = 0; q[3] = 0; }"): "a as angle (proved)",
    ("h.c", "void f(int a, double q[4]) { q[0] = cos(a/2); q[1] = 0; q[2] = 0; q[3] = sin(a/2); }"):
    None,
    **{(f"w{k}.{suffix}", text): None for k, (suffix, text) in enumerate(WHOLE)},
    ("p.py", "def f(w, x, y, z):\n    s = LIMIT(2*(w*y - z*x), -1, 1)\n    return atan2(2*(w*x + y*"
     "z), 1 - 2*(x*x + y*y)), asin(s), atan2(2*(w*z + x*y), 1 - 2*(y*y + z*z))\n"):
    "points, not proved)",
    ("h.cpp", "void f(const double *a, double s) { Vec q; q[1] = a[1]*sin(s); q[2] = a[2]; "
     "q[3] = a[3]; q *= s; g(q); }"): None,
    ("j.py", "from numpy import cos as sin, sin as cos\nR = lambda a: [[cos(a), -sin(a), 0], "
     "[sin(a), cos(a), 0], [0, 0, 1]]\n"): "a quarter or half turn away (proved)",
    ("i.cpp", "void f() { gx -= (q0*s1 - q1*s0 - q2*s3 + q3*s2)*dt*k + bx; gy -= (q0*s2 + q1*s3 -"
     " q2*s0 - q3*s1)*dt*k + by; gz -= (q0*s3 - q1*s2 + q2*s1 - q3*s0)*dt*k + bz; }"): None,
    ("j.cpp", "template <typename T> void f(const T& a, T q[4]) { T h = T(a)/T(2); q[0] = cos(h); "
     "q[1] = sin(h); q[2] = T(0); q[3] = T(0)*a; }"): "(proved)",
    ("a.cs", "class A { double S(double d) => Math.Sin(d); double[] F(double a) { return new[] {"
     "Math.Cos(a/2), S(a/2), 0, 0}; } }"): "(proved)",
    ("b.cs", "class A { float3x3 F(float a) { float s, c; sincos(a, out s, out c); return float3x3("
     "c, -s, 0, s, c, 0, 0, 0, 1); } }"): "a as angle (proved)",
    ("s.py", "def f(a):\n    s, c = torch.sin(a), torch.cos(a)\n    return torch.stack((c, -s, 0, "
     "s, c, 0, 0, 0, 1), -1).reshape(a.shape + (3, 3))\n"): "a as angle (proved)",
    ("k.py", "def f(p, q):\n    a, u, b, v = p[0], p[1:4], q[0], q[1:4]\n    return np.r_[a*b - "
     "np.dot(u, v), a*v + b*u + np.cross(u, v)]\n"): "quaternion_product p times q (proved)",
    ("a.m", "e = [atan2d(R(3,2), R(3,3)); asind(-R(3,1)); atan2d(R(2,1), R(1,1))];"): NAN,
    ("b.m", f"function R = f(a)\n  R = reshape({FLAT}, 3, 3);\nend\n"): "a as angle (proved)",
    ("l.py", f"def f(a):\n    return np.reshape({FLAT}, (3, 3), 'F')\n"): None,
    ("m.py", f"def f(a):\n    a = degrees(a)\n    R = {FLAT}\n"): None,
    ("e.js", f"function f(a) {{ {INNER.replace('#', 'let g = () => { s = -s; }; g();')} }}"): None,
    ("b.c", f"void f(double a) {{ {OF_C.replace('#', BREAK)} }}"): "in one of several branches",
    # the vector before and after a measurement are not taken for one another
    ("n.py", "def f(x, y, z, w):\n    a = 1 - 2*(y*y + z*z)\n    y = measured()\n    R = [[a, 2*("
     "x*y - w*z), 2*(x*z + w*y)], [2*(x*y + w*z), 1 - 2*(x*x + z*z), 2*(y*z - w*x)], [2*(x*z - w*y)"
     ", 2*(y*z + w*x), 1 - 2*(x*x + y*y)]]\n"): None,
    ("o.py", "def f(q):\n    w, x, y, z = q[0], q[1], q[2], q[3]\n    R = [[1 - 2*(y*y + z*z), 2*("
     "x*y - w*z), 2*(x*z + w*y)], [2*(x*y + w*z), 1 - 2*(x*x + z*z), 2*(y*z - w*x)], [2*(x*z - "
     "w*y), 2*(y*z + w*x), 2*(w*w + z*z) - norm(q)**2]]\n"): "q_3 as w, x, y, z (proved)",
    ("a.rs", f"use cgmath; fn f(a: f32) {BY_COLUMNS}"): "a as angle (proved)",
    ("c.js", "function f(a) { let c = Math.cos(a), s = Math.sin(a); m[0] = c; m[3] = -s; m[6] = 0;"
     " m[1] = s; m[4] = c; m[7] = 0; m[2] = 0; m[5] = 0; m[8] = 1; }"):
    "transposed (passive, or stored by columns) (proved)",
    ("d.cpp", "void f(double a) { m(1,1) = cos(a); m(1,2) = -sin(a); m(1,3) = 0; m(2,1) = sin(a); "
     "m(2,2) = cos(a); m(2,3) = 0; m(3,1) = 0; m(3,2) = 0; m(3,3) = 1; }"): "a as angle (proved)",
    ("e.cpp", "M f() { M H; H(0,0) = -x(); H(0,1) = w(); H(0,2) = -z(); H(0,3) = y(); H(1,0) = "
     "-y(); H(1,1) = z(); H(1,2) = w(); H(1,3) = -x(); H(2,0) = -z(); H(2,1) = -y(); H(2,2) = x(); "
     "H(2,3) = w(); return H; }"): "rate_matrix_space of unit_quaternion, half (proved)",
    ("f.cpp", "P f(Q q) { P a; a.p.X(cos(q.W())*p.X() - sin(q.W())*p.Y()); "
     "a.p.Y(sin(q.W())*a.p.X() + cos(q.W())*p.Y()); a.p.Z(p.Z()); return a; }"): None,
    ("g.cpp", "void f(double a) { q.W(cos(a/2)); q.X(sin(a/2)); q.Y(0); q.Z(0); }"):
    "a as angle (proved)",
    ("p.py", "def f(self):\n    v, a = self.turn()\n    R = np.cos(a)*np.eye(3) + np.sin(a)*np.arr"
     "ay([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]]) + (1 - np.cos(a))*np.outer(v, "
     "v)\n"):
    "v_0 in line 2, v_1 in line 2, v_2 in line 2",
    ("c.m", "function a = f(obj, t, w, U)\n  a = obj.I\\(t - cross(w, obj.I*w));\nend\n"):
    "if one matrix is the inverse of the other (proved)",
    ("q.py", "def f(x, y, z, q):\n    return np.dot(np.array([[0, -x, -y, -z], [x, 0, z, -y], [y, "
     "-z, 0, x], [z, y, -x, 0]]), q)/2\n"): "q_3 as w, x, y, z (proved)",
    ("c.rs", "fn f(yaw: Angle<f64>) -> Q { let h = 0.5 * yaw.get(); let (s, c) = h.sin_cos(); "
     "Q::quaternion(0.0, 0.0, s, c) }"): "z(angle) with yaw as angle, scalar last (proved)",
    ("h.cc", "void f(double *q, double B[3][3]) { B[0][0] = 1; B[0][1] = q[2]; B[0][2] = -q[1]; B"
     "[1][0] = -q[2]; B[1][1] = 1; B[1][2] = q[0]; B[2][0] = q[1]; B[2][1] = -q[0]; B[2][2] = 1;"
     "\nm33Scale(1. / (1 + v3Dot(q, q)), B, B); }"): "q_2 as g1, g2, g3, half (proved)",
    ("r.py", "def f(q):\n    B = np.zeros((3, 4)); B[0, 0] = -q[1]; B[0, 1] = q[0]; B[0, 2] = q[3];"
     " B[0, 3] = -q[2]; B[1, 0] = -q[2]; B[1, 1] = -q[3]; B[1, 2] = q[0]; B[1, 3] = q[1]; B[2, 0] ="
     " -q[3]; B[2, 1] = q[2]; B[2, 2] = -q[1]; B[2, 3] = q[0]\n"): "as w, x, y, z, half (proved)",
    ("d.rs", "fn f(a: f64) -> M { let c = a.cos(); let s = a.sin(); let k = s.mul_add(-1.0, 0.0); "
     "M::from([[c, k, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) }"): "a as angle (proved)",
    ("t.py", "W_T = [[1, 0, 0], [0, cos(a), -sin(a)], [-sin(b), sin(a)*cos(b), cos(a)*cos(b)]]\n"):
    "with a, b as the angles about x, y, transposed (proved)",
    ("s.cc", "void f(M A, double b) { auto g = [&]() { d = 1; }; double c = cos(b), s = sin(b); "
     "v = A.row(0); R = Matrix3d(c, -s, 0, s, c, 0, 0, 0, 1); }"): "b as angle (proved)",
    ("v.py", f"def f(a, eps):\n    return np.reshape({FLAT}, (3, 3)) + eps\n"): None,
    ("d.js", "const k = 180 / PI; function f(a, b, c, d) { return [atan2(2*(a*b + c*d), 1 - 2*(b*b"
     " + c*c))*k, asin(2*(a*c - d*b))*k, atan2(2*(a*d + b*c), 1 - 2*(c*c + d*d))*k]; }"):
    f"up to the factor k (to nine digits at 20 points, not proved){NAN}",
}  # fmt: skip


@pytest.mark.parametrize("program", CERTAIN, ids=lambda program: program[0])
def test_only_what_is_certain_is_said(tmp_path, program):
    texts = [str(each) for each in found_in(tmp_path, *program)]
    assert bool(texts) == bool(CERTAIN[program]), texts
    assert all(each.endswith(CERTAIN[program]) for each in texts), texts


LARGE = {  # programs that took minutes
    "a.py": "import os" + "\n" * 200_000,
    "a.rs": "fn f() {}" + "\n" * 200_000,
    "a.js": f"const x = {'1' * 100_000}n;",
    "b.js": f"function f() {{ return '{'[' * 100_000}'; }}",
    "c.js": f"function f() {{ var q = (a{' ' * 100_000} + b).foo(1); return [q, q, q]; }}",
    "d.js": "function f(){" * 300 + "}" * 300,
    "a.c": "void f(int k) {" + "".join(f"x{k} = 1; if (k) y = 2;" for k in range(1_000)) + "}",
    "b.py": "if k: y = 1\n" + "".join(f"elif k == {k}: y = {k}\n" for k in range(2_000)),
    "e.js": f"function f() {{ {','.join(f'x{k}={k}' for k in range(3_000))}; }}",
    "b.cpp": "void f(double a) { R(0,0) = cos(a) * ; sin( ( [ { " * 6_000,
    "b.c": "void f(double a, double *R) { R[0]=cos(a);"
    + "".join(f"if (c[{k}]) R[{k % 9}] = {k}*sin(a); else R[1] = R[2];" for k in range(2_000))
    + "}",
    "c.py": "def f(a, b):\n v = cross(a, b)\n" + " v = cross(v, b) + cross(a, v)\n" * 400,
    "c.cpp": "".join(
        f"void f{k}(double a) {{ R << cos(a), -sin(a), {k}*sin(a), sin(a), cos(a), 0, 0, 0, 1; }}\n"
        for k in range(2, 2_000)
    ),
    "a.cpp": "double f(double a) { return a; }" * 1_500 + "void g() {" + "R[0] = f(a);" * 900 + "}",
}


@pytest.mark.parametrize("name", LARGE)
def test_the_time_for_a_file_is_bounded(tmp_path, name):
    start = process_time()
    assert found_in(tmp_path, name, LARGE[name]) == []
    assert process_time() - start < 10


def test_a_hook_runs_for_the_files_of_every_language():
    hook = re.search(r"files: (.*)", (ROOT / ".pre-commit-hooks.yaml").read_text())[1]
    assert all(re.search(hook, f"a{ending}") for ending in GRAMMARS)


def test_every_pattern_that_is_used_is_in_the_table_and_the_other_way_round():
    sources = "".join(each.read_text() for each in (ROOT / "rigidsym/tools/compare").glob("*.py"))
    assert {*re.findall(r"\bpatterns\.(\w+)", sources)} == vars(patterns).keys()


def test_of_equally_near_rotations_that_of_yaw_pitch_and_roll_is_named(tmp_path):
    text = """def quaternion(roll, pitch, yaw):
    cr, cp, cy = cos(roll/2), cos(pitch/2), cos(yaw/2)
    sr, sp, sy = sin(roll/2), sin(pitch/2), sin(yaw/2)
    x, y = sr*cp*cy - cr*sp*sy, cr*sp*cy + sr*cp*sy
    return [cr*cp*cy + sr*sp*sy, x, y, cr*cp*sy + sr*sp*cy]
"""
    (found,) = found_in(tmp_path, "q.py", text)
    assert "of ZYX with yaw, pitch, roll as the angles about z, y, x: entry 4: " in str(found)


def test_another_convention_than_the_expected_one_is_a_fault(tmp_path):
    rows = "[[cos(a), sin(a), 0], [-sin(a), cos(a), 0], [0, 0, 1]]"
    turns = {
        "x": "[[1, 0, 0], [0, cos(a), -sin(a)], [0, sin(a), cos(a)]]",
        "y": "[[cos(a), 0, sin(a)], [0, 1, 0], [-sin(a), 0, cos(a)]]",
        "z": "[[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]]",
    }
    text = "".join(f"def R{axis}(a):\n    return np.array({m})\n" for axis, m in turns.items())
    (tmp_path / "a.py").write_text(f"{text}def f(r, p, y):\n    return Rz(y) @ Ry(p) @ Rx(r)\n")
    (tmp_path / "b.py").write_text(f"def f(a):\n    return np.array({rows})\n")
    a, b = str(tmp_path / "a.py"), str(tmp_path / "b.py")
    assert run(a, b).exit_code == 0
    assert run(a, "--expect", "z(yaw) y(pitch) x(roll)", "--expect-active").exit_code == 0
    other = run(a, "--expect", "ZXZ")
    assert other.exit_code == 1
    assert "expected the axes z x z in the product of rotations, not z y x" in other.stdout
    refused = call("compare", a, "--expect", "", cwd=tmp_path, status=2).stderr
    assert "'' is not a rotation" in refused
    assert run(b, "--expect-active").exit_code == 1
    (tmp_path / "d.py").write_text(f"def f(w, x, y, z):\n    return {ROLL}, {PITCH}, {YAW}\n")
    for expected, code in (("ZYX", 0), ("xyz", 0), ("XYZ", 1), ("ZXZ", 1)):
        assert run(str(tmp_path / "d.py"), "--expect", expected).exit_code == code
    (tmp_path / "c.py").write_text(f"def f(a):\n    R = {FLAT}\n")
    assert run(str(tmp_path / "c.py"), "--expect-active").exit_code == 0  # or by columns
    annotation = run(b, "--expect-active", "--format", "github").stdout
    assert annotation.startswith(f"::error file={b},line=2::returned: equal to")


def test_a_log_in_sarif_has_what_github_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "my file.py"
    file.write_text(f"def f(phi):\n    {SINES}\n    return {TURN.replace('-s', 's')}\n")
    wrong = tmp_path / "b.py"
    wrong.write_text("def step(rpy, omega, dt):\n    rpy += dt*omega\n")
    text = run(str(file), str(wrong), "--expect-active", "--format", "sarif").stdout
    (log,) = json.loads(text)["runs"]
    driver = log["tool"]["driver"]
    assert driver["version"] == rs.__version__
    rules = {rule["id"]: rule for rule in driver["rules"]}
    assert all({"shortDescription", "help", "helpUri"} <= rule.keys() for rule in rules.values())
    assert [result["ruleId"] for result in log["results"]] == ["wrong_formula", "body_rates"]
    for result, uri, line in zip(log["results"], ("my%20file.py", "b.py"), (3, 2), strict=True):
        (place,) = result["locations"]
        own = place["physicalLocation"]
        assert result["ruleId"] in rules
        assert result["message"]["text"]
        assert own["artifactLocation"] == {"uri": uri}
        assert own["region"] == {"startLine": line}


def test_a_fault_of_the_baseline_is_accepted_wherever_its_lines_move(tmp_path):
    file, baseline = tmp_path / "a.py", tmp_path / "baseline.json"
    wrong = "[[1, 0, 0], [0, cos(a), sin(a)], [0, sin(a), cos(a)]]"
    file.write_text(f"def f(a):\n    return np.array({wrong})\n")
    baseline.write_text(run(str(file), "--format", "json").stdout)
    accepted = (str(file), "--baseline", str(baseline))
    assert (run(str(file)).exit_code, run(*accepted).exit_code) == (1, 0)
    file.write_text("\n" + file.read_text())
    done = run(*accepted)
    assert (done.exit_code, done.stdout) == (0, "")  # it is counted, not listed
    assert f"1 fault accepted by {baseline}" in done.stderr
    assert "no longer" not in done.stderr
    assert json.loads(run(*accepted, "--format", "json").stdout)[0]["fault"]  # for the next one
    own = file.read_text()
    file.write_text(own + own.replace("def f", "def g"))
    assert run(*accepted).exit_code == 1  # a copy is another fault
    file.write_text(own.replace("sin(a)], [0, sin", "-sin(a)], [0, -sin"))
    done = run(*accepted)
    assert done.exit_code == 1
    assert f"{baseline}: no longer found: {file}:2: returned: " in done.stderr
    for text, fault, wanted in (
        ("{", "not JSON: Expecting property name", "expected a result of `rigidsym compare"),
        *((text, "another JSON file; ", "expected a result of") for text in ("{}", "[{}]")),
        ('[{"fault": true, "path": "a.py"}]', "made by an earlier version; ", "write it again"),
    ):
        baseline.write_text(text)
        refused = call("compare", *accepted, cwd=tmp_path, status=3).stderr
        assert f"{baseline}: {fault}" in refused
        assert wanted in refused
    for name, fault in (("", "an empty path"), ("x.json", "File 'x.json' does not exist")):
        refused = call("compare", str(file), "--baseline", name, cwd=tmp_path, status=2).stderr
        assert f"Invalid value for '--baseline': {fault}" in refused


def test_what_cannot_be_read_is_listed_with_its_reason(tmp_path):
    file = tmp_path / "a.py"
    rows = "[[c, -s, 0], [s, c, 0], [0, 0, 1]]"
    text = f"def f(a, n):\n    c, s = cos(a), sin(a)\n    for k in n: s = -s\n    return {rows}\n"
    file.write_text(text)
    done = run(str(file), "--why")
    assert "a.py:4: returned: not read, since s in line 3 cannot be read" in done.stderr
    file.write_text(text.replace("c, s = cos(a", "c, s = cos((a"))
    reason = "a.py:2: not read, since there is a syntax error"
    assert reason in run(str(file), "--why").stderr
    file.unlink()
    # An unknown macro is an error of syntax too, but no formula is lost.
    macro = "API_EXPORT int h(int k) {\n return 2 ** k;\n}\n"
    (tmp_path / "a.cpp").write_text(f"int f() {{\n sin(a);\n}}\n{macro}x = [3*sin(a) 4 +;\n")
    (tmp_path / "b.cpp").write_text(f"int f() {{\n sin(a);\n}}\n{macro}")
    (tmp_path / "a.rs").write_text("pub fn f(a: f32) -> f32 {\n    a\n}\nfn g() {}\n// sin")
    done = run(str(tmp_path), "--why")
    assert "a.cpp:7: not read, since there is a syntax error" in done.stderr
    assert "no known formula in 3 files, 1 not readable" in done.stderr


def test_a_file_that_is_not_compared_to_the_end_is_named(tmp_path):
    odd = "def f(a):\n    return [sin(a)**{0}, cos(a) + {0}, a*sin({0}*a)]\n"
    wrong = "def f(a):\n    return [[cos(a), sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]]\n"
    (tmp_path / "a.py").write_text("".join(map(odd.format, range(2, 42))) + wrong)
    done = run(str(tmp_path))
    assert (done.exit_code, done.stdout) == (0, "")
    assert re.search(r"a\.py:\d+: not compared from here on, since the formulas", done.stderr)
    assert "no known formula in 1 file, 1 not compared to the end" in done.stderr


def test_angles_that_are_not_in_the_formula_are_an_error():
    turn = "[cos(psi) -sin(psi) 0; sin(psi) cos(psi) 0; 0 0 1]"
    for angles, formula, there in (
        ("abc", turn, "psi"),
        ("klm", "[sin(b) sin(a) sin(d) sin(c)]", "a, b, c, d"),
        (("psi", "b", "c"), turn, ""),
        ("abc", "[1 0 0; 0 1 0; 0 0 1]", ""),
    ):
        motion = rs.derive(rs.EulerAngles("ZYX", angles=tuple(angles)), "rotation_matrix")
        error = pytest.raises(ExpressionError, match=f": the formula has {there}$")
        with error if there else nullcontext():
            rs.compare(formula, motion, "rotation_matrix")


LIMITS = {"most_formulas": 2, "most_steps": -30, "most_nodes": 20, "longest_file": 90}


@pytest.mark.parametrize(("limit", "value"), LIMITS.items())
def test_a_file_above_a_limit_is_named(limit, value, tmp_path, monkeypatch):
    file = tmp_path / "a.py"
    file.write_text("".join(f"def f{k}(c, s):\n    return {TURN}\n" for k in range(4)))
    whole = run(str(file))
    assert (whole.stdout.count("(proved)"), whole.stderr) == (4, "rigidsym: 4 formulas in 1 file\n")
    monkeypatch.setattr(limits, limit, value)
    done = run(str(file))
    assert done.exit_code == 0
    assert re.search(r"a\.py:\d: not compared from here on, since the file is too", done.stderr)
    assert "1 not compared to the end" in done.stderr


def test_a_failure_in_one_file_does_not_end_the_search(tmp_path, monkeypatch):
    for name in ("a.py", "b.py", "c.py"):
        (tmp_path / name).write_text(f"# {name}\nR = lambda s, c: {TURN}\n")

    def failing(text, suffix):
        return {}[0] if "b.py" in text else program_formulas(text, suffix)

    monkeypatch.setattr(rigidsym.tools.compare.search, "program_formulas", failing)
    done = run(str(tmp_path))
    assert "b.py:1: not read, since there was an error in reading it: KeyError: 0" in done.stderr
    assert (done.exit_code, done.stdout.count("(proved)")) == (3, 2)
    slow = lambda text, end: sleep(30 * ("c.py" in text)) or program_formulas(text, end)  # noqa: E731
    monkeypatch.setattr(rigidsym.tools.compare.search, "program_formulas", slow)
    done = run(str(tmp_path), "--format", "json", "--timeout", "1")
    assert "not compared" in json.loads(done.stdout)[-1]["text"], done.exception


@pytest.mark.parametrize(
    ("line", "is_wrong"),
    [
        ("rpy += dt*omega", True),
        ("angles += dt*omega", False),
        ("triangles_rpys += dt*omega", False),
        ("rpy += omega", False),
        ("roll += p; pitch += q; yaw += r", False),
        ("roll += p*dt; pitch += q*dt; yaw += r*dt", True),
        ("roll += (p + sin(roll)*tan(pitch)*q)*dt; pitch += q*dt; yaw += r*dt", False),
        ("x += p*dt; y += q*dt; z += r*dt", False),
        ("velocity += dt*omega", False),
    ],
)
def test_body_rates_that_are_taken_for_those_of_euler_angles_are_a_fault(tmp_path, line, is_wrong):
    (tmp_path / "a.py").write_text(f"def step(rpy, omega, velocity, p, q, r, dt):\n    {line}\n")
    done = run(str(tmp_path))
    assert ("are taken for the rates of Euler angles" in done.stdout) == is_wrong
    assert done.exit_code == is_wrong


OF_STATES = {  # statements of MATLAB, and parts of the findings
    "p_dot = q*r*(b - c)/a; q_dot = p*r*(c - a)/b; r_dot = p*q*(a - b)/c; s = sin(phi); "
    "phi_dot = p + (q*s + r*cos(phi))*tan(theta); theta_dot = q*cos(phi) - r*s; psi_dot = (q*s + "
    "r*cos(phi))/cos(theta);": ["to euler_equations_acceleration", "rates_from_angular_velocity"],
    "d = [-s(1)*s(5) - s(2)*s(6) - s(3)*s(7); s(1)*s(4) + s(3)*s(6) - s(2)*s(7); s(2)*s(4) - "
    "s(3)*s(5) + s(1)*s(7); s(3)*s(4) + s(2)*s(5) - s(1)*s(6)]/2;": ["body of unit_quaternion"],
    "u = [qx; qy; qz]; v = [vx; vy; vz]; t = 2*cross(u, v); r = v + qw*t + cross(u, t); "
    "m = [r(2); r(1); r(3)];": ["to rotated_vector", "entries 1 and 2 are exchanged"],
    "a = x/2; b = y/2; c = z/2; m = [cos(a)*cos(b)*cos(c) + sin(a)*sin(b)*sin(c); sin(a)*cos(b)*"
    "cos(c) + cos(a)*sin(b)*sin(c); cos(a)*sin(b)*cos(c) - sin(a)*cos(b)*sin(c); cos(a)*cos(b)*"
    "sin(c) + sin(a)*sin(b)*cos(c)];": ["proved with this change\n  or close to quaternion of"],
}


@pytest.mark.parametrize("axes", ["XYZ", "YXZ", "XZY"])
def test_several_readings_have_lines_of_their_own_the_named_order_first(tmp_path, axes):
    file = tmp_path / "a.m"
    file.write_text(f"function m = of_{axes}(x, y, z)\n{[*OF_STATES][-1]}\nend\n")
    text = run(str(file)).stdout
    assert text.startswith(f"{file}:2: m: close to quaternion of {axes} with ")
    assert text.count("\n  or close to quaternion of ") == 2
    annotation = run(str(file), "--format", "github").stdout
    assert annotation.partition("::m: ")[2] == text.partition(" m: ")[2].replace("\n", "%0A", 2)


@pytest.mark.parametrize("text", OF_STATES, ids=range(len(OF_STATES)))
def test_parts_of_a_state_and_repairs_in_other_entries_are_named(tmp_path, text):
    found = [str(each) for each in found_in(tmp_path, "a.m", text)]
    assert len(found) == len(OF_STATES[text]), found
    assert all(part in own for part, own in zip(OF_STATES[text], found, strict=True)), found


WRONG_BY = {  # the last lines of a function in Python: parts of the only finding
    "return inv(I) @ (t + cross(w, I @ w))": "the terms with w_0, w_1, w_2 should",
    "return inv(I) @ (t - cross(w, I @ w))": "euler_equations_acceleration, if one matrix is the",
    "return K @ (t + cross(w, I @ w))": "",  # K may be anything
    "return [((Iz - Iy)*q*r + tx)/Ix, ((Ix - Iz)*p*r + ty)/Iy, "
    "((Iy - Ix)*p*q + tz)/Iz]": "the terms with p, q, r should have the opposite sign",
    "return [[1, sin(a)*tan(b), cos(a)*tan(b)], [0, cos(a), -sin(a)], "
    "[0, sin(a)*cos(b), cos(a)/cos(b)]]": "sin(a)*cos(b) should be sin(a)/cos(b) (a product in",
    "a_dot = p + (sin(a)*q + cos(a)*r)*tan(b); b_dot = cos(a)*q - sin(a)*r; "
    "c_dot = (sin(a)*q + cos(a)*r)*cos(b)": "should be (q*sin(a) + r*cos(a))/cos(b) (a product",
}


@pytest.mark.parametrize(("text", "said"), WRONG_BY.items(), ids=range(len(WRONG_BY)))
def test_torques_and_quotients_that_are_wrong_are_named(tmp_path, text, said):
    found = [str(each) for each in found_in(tmp_path, "a.py", f"def f(w, t):\n    {text}\n")]
    assert len(found) == bool(said), found
    assert all(said in each for each in found), found


def test_a_plain_form_is_named_before_a_conjugated_one_about_other_axes():
    goal = target("YZX", "quaternion")
    formula = goal.matrix.xreplace(dict(zip(goal.inputs["q"], sp.symbols("a b c"), strict=True)))
    wrong = sp.ImmutableMatrix([formula[0] - 2 * formula[0].args[0], *formula[1:]])
    assert str(identified(wrong, is_in_program=True).found) == "quaternion of YZX"


# Names in a program

TURNED = """{above}def {name}(a, b, c):
    {inside}
    return np.array([
        [cos(a)*cos(b), cos(a)*sin(b)*sin(c) - sin(a)*cos(c), cos(a)*sin(b)*cos(c) + sin(a)*sin(c)],
        [sin(a)*cos(b), sin(a)*sin(b)*sin(c) + cos(a)*cos(c), sin(a)*sin(b)*cos(c) - cos(a)*sin(c)],
        [-sin(b), cos(b)*sin(c), cos(b)*cos(c)]])
"""
CLAIMS = {  # name, comment above, and docstring of a function about z, y, x: what is said of it
    ("euler_to_rot_zyx", "", "pass"): "",
    ("euler_to_rot_xyz", "", "pass"): "",  # about axes of space
    ("euler_to_rot_zxy", "", "pass"): "name of euler_to_rot_zxy says zxy",
    ("rotation312", "", "pass"): "name of rotation312 says 312",
    ("turn", "# A 3-1-2 sequence\n", "pass"): "comment of turn says 3-1-2",
    ("turn", "", '"""Of angles YXZ."""'): "comment of turn says YXZ",
    ("turn", "", '"""Not YXZ, but ZYX."""'): "",
    ("turn_123456", "# 213 lines\n\n", "pass"): "",
}


@pytest.mark.parametrize("claim", CLAIMS, ids=range(len(CLAIMS)))
def test_an_order_of_axes_in_a_name_is_compared_with_the_formula(tmp_path, claim):
    name, above, inside = claim
    text = TURNED.format(name=name, above=above, inside=inside)
    (found,) = found_in(tmp_path, "a.py", text)
    said = f"; the {CLAIMS[claim]}, the formula is ZYX" * bool(CLAIMS[claim])
    assert str(found).endswith(f"(proved){said}")
    (tmp_path / "a.py").write_text(text)
    assert run(str(tmp_path)).exit_code == 0


def test_a_rate_of_a_quaternion_without_the_factor_one_half_is_named(tmp_path):
    text = """def {name}(q0, q1, q2, q3, wx, wy, wz):
    v = q0*wx + q2*wz - q3*wy, q0*wy - q1*wz + q3*wx, q0*wz + q1*wy - q2*wx
    d = [-q1*wx - q2*wy - q3*wz, v[0], v[1], v[2]]
    return d{half}
"""
    for name, half, is_said in (("q_dot", "", 1), ("q_dot", "/2", 0), ("times", "", 0)):
        found = found_in(tmp_path, "a.py", text.format(name=name, half=half))
        said = [str(each) for each in found if "it lacks the factor 1/2" in str(each)]
        assert len(said) == is_said
    returned = text.replace("d = [", "return [").format(name="times", half="")
    (found,) = found_in(tmp_path, "a.py", returned)
    assert str(found).endswith("equal to quaternion_product q times w (proved)")


# Euler angles from a matrix or a quaternion

AXES = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"]
MATRIX = sp.ImmutableMatrix(3, 3, sp.symbols("R(1:4)(1:4)", real=True))


@pytest.mark.parametrize("axes", AXES)
def test_angles_are_those_of_scipy_and_known_in_every_convention(axes):
    turn = Rotation.random(random_state=7)
    values = dict(zip(MATRIX, turn.as_matrix().ravel(), strict=True))
    angles = _angles(axes, MATRIX)
    ours = np.array(angles.xreplace(values).evalf(), float).ravel()
    assert ours == pytest.approx(turn.as_euler(axes))
    assert str(rs.compare(angles).found) == f"euler_angles of {axes}"


ROLL = "atan2(2*(w*x + y*z), 1 - 2*(x*x + y*y))"
PITCH, YAW = "asin(2*(w*y - z*x))", "atan2(2*(w*z + x*y), 1 - 2*(y*y + z*z))"
OF_ANGLES = {  # three entries: the finding
    (ROLL, PITCH, YAW): "agrees with euler_angles of xyz (to nine digits at 20 points",
    (YAW, PITCH, ROLL): "agrees with euler_angles of ZYX (",
    (PITCH, ROLL, YAW): "of xyz, the angles in the order 2 1 3 (",
    (ROLL, f"-{PITCH}", YAW): "of xyz, with the opposite sense of angle 2 (a convention or wrong",
    (ROLL.replace("2*(w*x + y*z)", "w*x + y*z"), PITCH, YAW): "entry 1: atan2(w*x + y*z, -2*x**2",
    (ROLL.replace("x*x + y*y", "x*x - y*y"), PITCH, YAW): "close to euler_angles of xyz: entry 1",
    (ROLL, PITCH, YAW.replace("1 - 2*(y*y", "1 - 2*(x*x")): "entry 3",
    (ROLL, PITCH, f"atan2({YAW[6:-1].split(', ')[1]}, {YAW[6:-1].split(', ')[0]})"): "entry 3",
    (ROLL.replace("atan2(", "atan((").replace(", ", ")/(") + ")", PITCH, YAW): "should be atan2(2*",
    (ROLL, PITCH.replace("w*y - z*x", "w*y + z*x"), YAW): "close to euler_angles of xyz: entry 2",
    ("atan2(m12, m22)", "-asin(m02)", "atan2(m01, m00)"): "of xyz, transposed (passive) (",
    ("atan2(m32, m33)", "-asin(m31)", "atan2(m21, m11)"): "euler_angles of xyz (",
    ("atan2(q[6], q[10])", "-asin(q[2])", "atan2(q[1], q[0])"): "euler_angles of xyz (",
    ("atan2(c.y, c.z)", "-asin(c.x)", "atan2(b.x, a.x)"): "euler_angles of xyz (",
    ("atan2(a, b)", "asin(c)", "atan2(d, e)"): "not a known quantity",
    ("atan2(m10, m11)", "asin(m00)", "atan2(m01, m22)"): "not a known quantity",
}


@pytest.mark.parametrize(("entries", "finding"), OF_ANGLES.items(), ids=range(len(OF_ANGLES)))
def test_three_angles_are_right_close_or_unknown(entries, finding):
    assert finding in rs.compare(f"[{', '.join(entries)}]").text()


TEXT = (ROOT / "tests/tools/compare_programs.toml").read_text()
PROGRAMS = {each["name"]: each for each in tomllib.loads(TEXT)["program"]}


@pytest.mark.parametrize("name", PROGRAMS)
def test_programs_of_the_table_are_read(tmp_path, name):
    findings = found_in(tmp_path, name, PROGRAMS[name]["text"])
    found = [str(each) for each in findings]
    assert len(found) == len(PROGRAMS[name]["said"]), found
    assert all((each.record()["branch"] or "") in str(each) for each in findings)
    assert all(map(operator.contains, found, PROGRAMS[name]["said"])), found


def test_a_fault_is_at_the_line_of_its_entry_and_counts_once(tmp_path):
    file = tmp_path / "a.py"
    file.write_text("""import numpy as np
def f(a, b):
    s, c = np.sin, np.cos
    R = np.array([
        [c(a)*c(b), -s(a), c(a)*s(b)],
        [s(a)*c(b), c(a), s(a)*s(b)],
        [s(b), 0, c(b)],
    ])
    return np.asarray(R)
""")
    (found,) = found_in(tmp_path, "a.py", file.read_text())
    assert found.formula.line == 4
    annotation = run(str(file), "--format", "github").stdout
    assert annotation.startswith(f"::error file={file},line=7::R: close to")


OF_TURNS = {  # a wrong turn about y, and a product with it
    "a.py": "def Ry(t):\n    s, c = sin(t), cos(t)\n    return [[c, 0, s], [0, 1, 0], [s, 0, c]]\n"
    "def Rz(t):\n    return [[cos(t), -sin(t), 0], [sin(t), cos(t), 0], [0, 0, 1]]\n"
    "def f(a, b):\n    return np.dot(\n        Rz(a), Ry(b))\n",
    "b.py": "def f(a, b):\n    R = array([[cos(b), 0, sin(b)], [0, 1, 0], [sin(b), 0, cos(b)]])\n"
    "    T = array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]]) @ R\n    S = T @ T\n",
}


@pytest.mark.parametrize("name", OF_TURNS)
def test_a_fault_is_not_reported_again_in_a_product(tmp_path, name):
    file = tmp_path / name
    file.write_text(OF_TURNS[name])
    done = run(str(file), "--why")
    assert done.stdout.count("close to") == done.stdout.count("close to rotation_matrix of y(") == 2
    assert ": not read, since it contains " in done.stderr
    right = OF_TURNS[name].replace("[s, 0", "[-s, 0").replace("[sin(b), 0", "[-sin(b), 0")
    file.write_text(right)
    assert "close to" not in run(str(file)).stdout


def test_a_vector_is_found_once_beside_its_components_and_up_to_a_factor(tmp_path):
    """psiphi75/ahrs, Mahony.js, line 101"""
    text = """def f(q0, q1, q2, q3, gx, gy, gz, f):
    w = f*(-q1*gx - q2*gy - q3*gz)
    x = f*(q0*gx + q2*gz - q3*gy)
    y = f*(q0*gy - q1*gz + q3*gx)
    z = f*(q0*gz + q1*gy - q2*gx)
    return w, x, y, z
"""
    twice = found_in(tmp_path, "a.py", text.replace("    return", "    print") + text)
    assert [each.formula.line for each in twice] == [2, 8]  # in two functions
    (found,) = found_in(tmp_path, "a.py", text)
    assert "quaternion_product q times g, up to the factor f (proved)" in str(found)
    steps = """def f(self, p, q, r, dt):
    phi, theta = self.phi, self.theta
    self.phi += (p + tan(theta)*(q*sin(phi) + r*cos(phi)))*dt
    self.theta += (q*cos(phi) + r*sin(phi))*dt
    self.psi += ((q*sin(phi) + r*cos(phi))/cos(theta))*dt
"""
    (found,) = found_in(tmp_path, "a.py", steps)
    assert "a.py:4: self: close to rates_from_angular_velocity_body of xyz" in str(found)
