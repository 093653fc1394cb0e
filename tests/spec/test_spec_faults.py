"""Wrong derivation files: every fault at once, with its line and its path; and junk."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import example, given, settings, strategies as st

from rigidsym.errors import SpecError
from rigidsym.motion import QUANTITIES
from rigidsym.pipeline import read_record, read_spec
from rigidsym.spec.derivation_spec import DerivationSpec

SHIPPED = Path(__file__).resolve().parents[2] / "derivations"


def read(text: str, name: str = "top") -> DerivationSpec:
    return read_spec(dedent(text), source="top.toml", name=name)


def faults(text: str, name: str = "top") -> list[str]:
    with pytest.raises(SpecError) as caught:
        read(text, name)
    return [str(fault) for fault in caught.value.faults]


MANY = """\
title = ""
sequence = "ZXZ"
[rotaton]
[rotation]
sequence = ["ZXZ", "313", "ZZX", 313, "z(a) x(b)", "zXz", "z(a) x(b",
    "z(a) x(a) z(b)", "xyz(", "zxz"]  # the last is fine
angles = [
    "phi",
    "phi_dot", # a rate
    3,
    "φ",
]
passiv = true
passive = "no"
[output]
quantities = ["angular_velocity_bdy", "rotation_matrix", "rotation_matrix"]
kernels = []
note = "tex"
title = "Top"
[body]
principal_moments = ["A", "A"]
"""

ALL_OF_THEM = """\
many.toml: 21 faults, nothing written
  line 1: title: the title is empty; write one, or leave this key out
  line 2: sequence: unknown key; it belongs in [rotation]
  line 3: rotaton: unknown key; did you mean rotation or notation?
  line 5: rotation.sequence[1]: writes the folder euler_zxz_intrinsic, as entry 0 does
  line 5: rotation.sequence[2]: 'ZZX' is not an Euler sequence: consecutive axes must differ: Z \
follows Z
  line 5: rotation.sequence[3]: expected a text in quotes, got the number 313
  line 5: rotation.sequence[5]: 'zXz' is not an Euler sequence: upper case is intrinsic and lower \
case extrinsic; do not mix them
  line 5: rotation.sequence[6]: column 7: unclosed (
  line 6: rotation.sequence[8]: column 1: expected a turn: x(...), y(...), z(...) or \
[1,1,0](...), found 'x'
  line 7: rotation.angles: expected a list of three names such as ["phi", "theta", "psi"], got 4
  line 7: rotation.angles: the sequence names its angles itself; leave this key out
  line 9: rotation.angles[1]: 'phi_dot' is not a valid name: a name that ends in dot reads as a \
rate
  line 10: rotation.angles[2]: expected a text in quotes, got the number 3
  line 11: rotation.angles[3]: phi is named twice
  line 13: rotation.passiv: unknown key; did you mean passive?
  line 14: rotation.passive: expected true or false, got the text "no"
  line 16: output.quantities[0]: unknown name "angular_velocity_bdy"; did you mean \
angular_velocity_body or angular_velocity_space?
  line 16: output.quantities[2]: rotation_matrix is named twice
  line 18: output.note: expected a list of names such as ["tex"], got the text "tex"
  line 19: output.title: unknown key; it belongs at the top of the file, outside the tables
  line 21: body.principal_moments: expected three moments of inertia, got a list"""


def test_every_fault_is_reported_at_once():
    with pytest.raises(SpecError) as caught:
        read_spec(MANY, source="many.toml", name="many")
    assert str(caught.value) == ALL_OF_THEM
    assert caught.value.exit_code == 3


SEQUENCE = 'a sequence such as "ZXZ", or a list of sequences'
ZXZ = '[rotation]\nsequence = "ZXZ"\n'


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", 'rotation: missing; expected [rotation] with sequence = "ZXZ" or another'),
        ("rotation = 3", "line 1: rotation: expected a table [rotation], got the number 3"),
        ("[[rotation]]", "line 1: rotation: expected a table [rotation], got a list"),
        ("\n[rotation]", f"line 2: rotation.sequence: missing; expected {SEQUENCE}"),
        (
            "[rotation]\nsequence = 313",
            f"line 2: rotation.sequence: expected {SEQUENCE}, got the number 313",
        ),
        (
            "[rotation]\nsequence = []",
            f"line 2: rotation.sequence: the list is empty; expected {SEQUENCE}",
        ),
        (
            "[rotation]\nsequence = { zxz = 1 }",
            f"line 2: rotation.sequence: expected {SEQUENCE}, got a table",
        ),
        (
            f'[rotation]\nsequence = "{"z" * 901}"',
            'line 2: rotation.sequence: expected a sequence such as "ZXZ", turns such as '
            '"z(phi) x(theta)", or a name, got 901 characters',
        ),
        (
            '[rotation]\nsequence = "z(phi_dot) x(a) z(b)"',
            "line 2: rotation.sequence: column 1: 'phi_dot' is not a valid name: a name that "
            "ends in dot reads as a rate",
        ),
        (
            '[rotation]\nsequence = ["zxz", "x(a) y(b) z(c)", "z(a) x(b) z(c)", "x(d) y(e) z(f)"]',
            "line 2: rotation.sequence[3]: writes the folder euler_xyz_intrinsic, as entry 1 does",
        ),
        (
            f'{ZXZ}angles = ["a", "b"]',
            'line 3: rotation.angles: expected a list of three names such as ["phi", "theta", '
            '"psi"], got 2',
        ),
        (
            f"{ZXZ}angles = []",
            "line 3: rotation.angles: the list is empty; expected a list of three names such as "
            '["phi", "theta", "psi"]',
        ),
        (
            f'{ZXZ}angles = "abc"',
            'line 3: rotation.angles: expected a list of three names such as ["phi", "theta", '
            '"psi"], got the text "abc"',
        ),
        (
            f"{ZXZ}passive = 1979-05-27",
            "line 3: rotation.passive: expected true or false, got a date or a time",
        ),
        (
            f"{ZXZ}passive = {10**15}",
            "line 3: rotation.passive: expected true or false, got a number",
        ),
        (
            f"title = true\n{ZXZ}",
            "line 1: title: expected a text in quotes, got true",
        ),
        (
            f'title = "a\\nb"\n{ZXZ}',
            "line 1: title: expected one line of at most 200 printable characters",
        ),
        (
            f'title = "{"a" * 201}"\n{ZXZ}',
            "line 1: title: expected one line of at most 200 printable characters",
        ),
        (f"{ZXZ}output.kernels = 1", "line 3: rotation.output: unknown key; it belongs at the top "
         "of the file, outside the tables"),
        (
            f'{ZXZ}[output]\nnote = ["tex", "docx"]',
            'line 4: output.note[1]: unknown name "docx"; '
            "known: tex, fragment.tex, html, md, ipynb, page, pdf",
        ),
        (
            f'{ZXZ}[output]\nkernels = ["nunpy"]',
            'line 4: output.kernels[0]: unknown name "nunpy"; did you mean numpy?',
        ),
        (
            f'{ZXZ}[output]\nquantities = ["weight\\u001b[2J"]',
            'line 4: output.quantities[0]: unknown name "weight\\u001b[2J"; known: '
            f"{', '.join(QUANTITIES[:3])} and {len(QUANTITIES) - 3} more (`rigidsym list`)",
        ),
        (
            f'{ZXZ}"passive " = true',
            'line 3: rotation."passive ": unknown key; did you mean passive?',
        ),
        (
            f"{ZXZ}[potential]",
            "line 3: potential: unknown key; it belongs in [dynamics]",
        ),
        (
            "a = 1\nb = \nc = 2",
            "line 2: not TOML: Invalid value, at column 5",
        ),
        (
            f"{ZXZ}[body]\nshape = 'sphere'\n[dynamics]\nmethod = 'newton'",
            "line 6: dynamics.method: no method 'newton'; known: lagrange, euler",
        ),
        (
            f"{ZXZ}constraints = ['phi']",
            "line 3: rotation.constraints: only a rotation with matrix has this key",
        ),
        (
            f"{ZXZ}[output]\nderivatives = ['angular_velocity_body by q']\n"
            "quantities = ['rotation_matrix']",
            "line 4: output.derivatives[0]: no quantity \"angular_velocity_body\"; known: "
            "rotation_matrix",
        ),
        (
            f"{ZXZ}[notation]\nrates = 'dashed'",
            'line 4: notation.rates: unknown choice "dashed"; known: dot, fraction',
        ),
        (
            f"{ZXZ}[body]\nshape = 'sphere'\n[dynamics]\ntorque = 3",
            "line 6: dynamics.torque: expected a list of three texts in quotes, got the number 3",
        ),
        ("a = [1,\n2\n\n", "line 2: not TOML: Unclosed array, at the end of the file"),
        ("a = 1\na = 2\n", "line 2: not TOML: Cannot overwrite a value, at column 6"),
        ("a = " + "[" * 990, "lists or tables nested too deeply to be read"),
        ("\n#" + "a" * 1000, "line 2: a line of 1001 characters; expected at most 1000"),
        ("\n" * 50_001, "a file of 50001 characters; expected at most 50000"),
    ],
)  # fmt: skip
def test_one_fault(text, fault):
    assert faults(text) == [fault]


A_NAME = "expected a lower-case letter, then lower-case letters, digits or underscores, got "


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("My File", f'{A_NAME}"My File"'),
        ("1st", f'{A_NAME}"1st"'),
        ("", f'{A_NAME}""'),
        ("lambda", "lambda is a reserved word of Python or Windows"),
        ("aux", "aux is a reserved word of Python or Windows"),
        ("numpy", "numpy.py would hide the Python module of this name"),
        ("random", "random.py would hide the Python module of this name"),
    ],
)  # fmt: skip
def test_the_name_of_the_file_names_folder_and_module(name, fault):
    assert faults(ZXZ, name) == [f"the file name is the name of the derivation: {fault}"]


def test_a_wrong_text_does_not_turn_the_message_around():
    (fault,) = faults(f'{ZXZ}[output]\nnote = ["\u202efdp"]')
    known = "tex, fragment.tex, html, md, ipynb, page, pdf"
    assert fault == f'line 4: output.note[0]: unknown name "\\u202efdp"; known: {known}'


def test_a_long_wrong_text_is_cut():
    (fault,) = faults(f'{ZXZ}[output]\nnote = ["{"x" * 900}"]')
    known = "tex, fragment.tex, html, md, ipynb, page, pdf"
    assert fault == f'line 4: output.note[0]: unknown name "{"x" * 40}…"; known: {known}'


@pytest.mark.parametrize(
    "text",
    [
        "\n".join([".".join(["a"] * 450) + " = 1"] * 50),
        "\n".join(f"k{place} = 1" for place in range(5000)),
        "x" * 1_000_000,
        "\n" * 1_000_000,
        "[[rotation]]\n" * 3000,
        ZXZ + "[output]\nquantities = [\n" + '"rotation_matrxi",\n' * 500 + "]",
    ],
    ids=["dots", "keys", "one line", "lines", "tables", "typing errors"],
)
def test_large_files_are_refused_at_once(text):
    assert faults(text)  # read to its end, some of it would take minutes


# junk


def is_read_or_refused(read_it, *arguments) -> None:
    """Any error but a SpecError goes through."""
    try:
        spec = read_it(*arguments)
    except SpecError:
        return
    assert read_record(spec.to_data()) == spec


GOOD = (SHIPPED / "yaw_pitch_roll.toml").read_text(encoding="utf-8")
places = st.integers(0, len(GOOD))


@settings(max_examples=200, deadline=timedelta(seconds=10))
@given(places, places, st.text(max_size=3) | st.sampled_from(['"', "[", "]", "\n", "=", ".", "{"]))
def test_a_damaged_file_is_read_or_refused(first, second, patch):
    start, end = sorted((first, second))
    is_read_or_refused(read, GOOD[:start] + patch + GOOD[min(end, start + 20) :])


fields = st.sampled_from(
    ["title", "rotation", "sequence", "angles", "passive", "output", "note", "kernels", "body"]
)
toml_values = st.recursive(
    st.sampled_from(["1", "true", "-nan", "07:32:00", '"ZXZ"', '"zyx"', '"tex"', '"φ"', '"numpy"'])
    | st.text(alphabet="xyz(abφ)* ^\u202e", max_size=20).map('"{}"'.format),
    lambda inner: (
        st.lists(inner, max_size=4).map(lambda parts: f"[{', '.join(parts)}]")
        | st.tuples(fields, inner).map(lambda pair: "{{ {} = {} }}".format(*pair))
    ),
    max_leaves=5,
)
lines = st.one_of(
    st.tuples(fields, toml_values).map(" = ".join),
    st.tuples(fields, fields, toml_values).map(lambda t: "{}.{} = {}".format(*t)),
    st.sampled_from(["[rotation]", "[output]", "[body]", "[[rotation]]", 'sequence = "ZXZ"']),
)


@settings(max_examples=300, deadline=timedelta(seconds=10))
@given(st.lists(lines, max_size=8).map("\n".join) | st.text(max_size=80))
@example("x = 0x" + "f" * 900)
@example("[rotation]\nsequence = 1e999")
def test_any_text_is_read_or_refused(text):
    is_read_or_refused(read, text)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(fields | st.text(), inner),
    max_leaves=8,
)


@settings(max_examples=200, deadline=timedelta(seconds=10))
@given(
    st.fixed_dictionaries(
        {},
        optional={
            "name": st.just("top") | json_values,
            "title": json_values,
            "rotations": st.lists(
                st.fixed_dictionaries({"sequence": st.just("ZXZ") | json_values}) | json_values
            ),
            "quantities": json_values,
            "note": st.just(["tex"]) | json_values,
        },
    )
    | json_values
)
def test_any_data_is_read_or_refused(data):
    is_read_or_refused(read_record, data)


def test_faults_of_dynamics_are_placed():
    text = '[rotation]\nsequence = "ZXZ"\n[dynamics]\npotential = "m*("\nforces = { chi = "1" }\n'
    assert faults(text) == [
        "line 3: dynamics: forces act on a body; expected [body] as well",
        "line 4: dynamics.potential: column 4: expected a number, a name or (, found the end",
        "line 5: dynamics.forces: a force on chi, which is not a coordinate; expected phi, theta, "
        "psi",
    ]


PINCHED = """\
[rotation]
matrix = [["cos(phi)", "-sin(phi)", "0"], ["sin(phi)", "cos(phi)", "0"], ["0", "0", "1"]]
coordinates = ["phi"]
constraints = ["(b - a**2)**2 + (a - 3)**2"]
example = { a = 3, b = "9" }
"""


def test_a_point_of_constraints_is_read_and_kept():
    spec = read(PINCHED)
    (model,) = spec.models
    assert {str(name): value for name, value in model.example} == {"a": 3, "b": 9}
    again = read_record(spec.to_data())
    assert again.models == spec.models


AN_ENTRY = "expected an expression in quotes or a finite number"
NUMBERS = """\
[rotation]
matrix = [["cos(phi)", "-sin(phi)", 0], ["sin(phi)", "cos(phi)", 0], [0, 0.0, ONE]]
coordinates = ["phi"]
"""


def test_entries_of_a_matrix_may_be_numbers():
    (model,) = read(NUMBERS.replace("ONE", "1")).models
    (texts,) = read(NUMBERS.replace("ONE", '"1"')).models
    assert model == texts


@pytest.mark.parametrize(
    ("entry", "fault"),
    [
        ("true", f"rotation.matrix[2][2]: {AN_ENTRY}, got true"),
        ("[1]", f"rotation.matrix[2][2]: {AN_ENTRY}, got a list"),
        ("nan", f"rotation.matrix[2][2]: {AN_ENTRY}, got a number"),
        ('"cos(psi"', "rotation.matrix[2][2]: "),
        ('"1"]]\nsequence = "ZXZ"\n#', "rotation.sequence: a rotation with matrix does not"),
        ("1, 0", "rotation.matrix: expected three rows of three expressions, got a list"),
    ],
)
def test_a_wrong_entry_of_a_matrix_is_named(entry, fault):
    with pytest.raises(SpecError) as caught:
        read(NUMBERS.replace("ONE", entry))
    (found,) = caught.value.faults
    assert fault in str(found)


@pytest.mark.parametrize(
    ("example", "fault"),
    [
        ("{ c = 1 }", "rotation.matrix: top: the example: unknown name c"),
        ('{ a = "b" }', "rotation.example.a: unknown name 'b'"),
        (
            "{ a = inf }",
            "rotation.example.a: expected an expression in quotes or a finite number, got a number",
        ),
        (
            "{ a = [] }",
            "rotation.example.a: expected an expression in quotes or a finite number, got a list",
        ),
        ("3", "rotation.example: expected a table [rotation.example], got the number 3"),
    ],
)
def test_a_wrong_point_is_named(example, fault):
    assert fault in "\n".join(faults(PINCHED.replace('{ a = 3, b = "9" }', example)))
