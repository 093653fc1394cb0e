"""Derivation files: what they say, and every fault at once with its line and its path."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from textwrap import dedent

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rigidsym import resources
from rigidsym.errors import ModelError, RigidsymError, SpecError
from rigidsym.mechanics.quantities import QUANTITY_NAMES
from rigidsym.models.catalogue import EULER_SEQUENCES, EulerAngles
from rigidsym.spec import DerivationSpec, read_file, read_spec, spec_for

SHIPPED = Path(__file__).resolve().parent.parent / "derivations"
A_WHILE = 3.0  # seconds


def read(text: str, name: str = "top") -> DerivationSpec:
    return read_spec(dedent(text), source="top.toml", name=name)


def faults(text: str, name: str = "top") -> list[str]:
    with pytest.raises(SpecError) as caught:
        read(text, name)
    return [str(fault) for fault in caught.value.faults]


# what a file says


def test_a_small_file_asks_for_everything():
    spec = read('[rotation]\nsequence = "ZXZ"')
    assert spec == DerivationSpec(
        name="top",
        title=None,
        models=(EulerAngles("ZXZ"),),
        quantities=(),
        kernels=("numpy",),
        note=("tex",),
    )


def test_a_full_file():
    spec = read(
        """
        title = "Ω of a ship"
        [rotation]
        sequence = "zyx"
        angles = ["ψ", "theta", "λ"]
        passive = true
        [output]
        quantities = ["angular_velocity_body", "rotation_matrix"]
        kernels = ["numpy"]
        note = ["tex", "pdf"]
        """
    )
    assert spec == DerivationSpec(
        name="top",
        title="Ω of a ship",
        models=(EulerAngles("zyx", ("psi", "theta", "lambda"), passive=True),),
        quantities=("angular_velocity_body", "rotation_matrix"),
        kernels=("numpy",),
        note=("tex", "pdf"),
    )


@pytest.mark.parametrize("sequence", ["ZXZ", "313", "z(phi) x(theta) z(psi)", "z(φ)*x(θ)*z(ψ)"])
def test_spellings_of_one_rotation(sequence):
    assert read(f'[rotation]\nsequence = "{sequence}"').models == (EulerAngles("ZXZ"),)


def test_turns_name_their_angles():
    (model,) = read('[rotation]\nsequence = "x(a) y(b) z(c)"').models
    assert model == EulerAngles("XYZ", ("a", "b", "c"))


def test_a_list_names_its_derivations_itself():
    spec = read('title = "Two"\n[rotation]\nsequence = ["ZXZ", "x(a) y(b) x(c)"]', name="My file")
    assert [single.name for single in spec.singles()] == [
        "euler_zxz_intrinsic",
        "euler_xyx_intrinsic",
    ]
    assert [single.title for single in spec.singles()] == [None, None]
    assert [len(single.models) for single in spec.singles()] == [1, 1]


def test_a_list_of_one_names_its_derivation_too():
    spec = read('[rotation]\nsequence = ["zxz"]', name="My file")
    assert spec.name == "euler_zxz_extrinsic"
    assert spec.singles() == (spec,)


def test_a_byte_order_mark_and_other_line_ends_do_no_harm():
    plain = '[rotation]\nsequence = "ZXZ"\n'
    assert read("\ufeff" + plain.replace("\n", "\r\n")) == read(plain)


# faults

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
principal_moments = ["A", "A", "C"]
"""

ALL_OF_THEM = """\
many.toml: 24 faults, nothing written
  line 1: title: an empty text; expected a title, or no such key
  line 2: sequence: unknown key; it belongs in [rotation]
  line 3: rotaton: unknown key; did you mean rotation?
  line 5: rotation.sequence[1]: writes the folder euler_zxz_intrinsic, as entry 0 does
  line 5: rotation.sequence[2]: 'ZZX' is not an Euler sequence: two turns in a row are about one \
axis; neighbours must differ
  line 5: rotation.sequence[3]: expected a text in quotes, got the number 313
  line 5: rotation.sequence[4]: 'ZX' is not an Euler sequence: expected three axes such as ZXZ \
(intrinsic), zxz (extrinsic) or 313 (intrinsic)
  line 5: rotation.sequence[5]: 'zXz' is not an Euler sequence: upper case is intrinsic and lower \
case extrinsic; do not mix them
  line 5: rotation.sequence[6]: column 7: this ( is never closed
  line 6: rotation.sequence[7]: Euler angles need three different names, got a, a, b
  line 6: rotation.sequence[8]: column 1: expected a turn: x(...), y(...) or z(...), found 'x'
  line 7: rotation.angles: expected a list of three names such as ["phi", "theta", "psi"], got 4
  line 7: rotation.angles: the sequence names its angles itself; leave this key out
  line 9: rotation.angles[1]: 'phi_dot' cannot be a name here: a name that ends in dot reads as a \
rate
  line 10: rotation.angles[2]: expected a text in quotes, got the number 3
  line 11: rotation.angles[3]: phi is named twice
  line 13: rotation.passiv: unknown key; did you mean passive?
  line 14: rotation.passive: expected true or false, got the text "no"
  line 16: output.quantities[0]: unknown name "angular_velocity_bdy"; did you mean \
angular_velocity_body or angular_velocity_space?
  line 16: output.quantities[2]: rotation_matrix is named twice
  line 17: output.kernels: the list is empty; expected a list of names such as ["numpy"]
  line 18: output.note: expected a list of names such as ["tex"], got the text "tex"
  line 19: output.title: unknown key; it belongs at the top of the file, outside the tables
  line 20: body: unknown key; not read yet (known: title, rotation, output)"""


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
            f'[rotation]\nsequence = "{"z" * 201}"',
            f"line 2: rotation.sequence: expected {SEQUENCE}, got 201 characters",
        ),
        (
            '[rotation]\nsequence = "z(phi/2) x(a) z(b)"',
            "line 2: rotation.sequence: an angle has no good name: 'phi/2' cannot be a name here: "
            "expected letters (Latin or Greek) and digits, a letter first, joined by single _",
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
            f'{ZXZ}[output]\nnote = ["tex", "html"]',
            'line 4: output.note[1]: unknown name "html"; known: tex, pdf',
        ),
        (
            f'{ZXZ}[output]\nkernels = ["nunpy"]',
            'line 4: output.kernels[0]: unknown name "nunpy"; did you mean numpy?',
        ),
        (
            f'{ZXZ}[output]\nquantities = ["inertia_tensor\\u001b[2J"]',
            'line 4: output.quantities[0]: unknown name "inertia_tensor\\u001b[2J"; known: '
            + ", ".join(QUANTITY_NAMES),
        ),
        (
            f'{ZXZ}"passive " = true',
            'line 3: rotation."passive ": unknown key; did you mean passive?',
        ),
        (
            f"{ZXZ}[potential]",
            "line 3: potential: unknown key; not read yet (known: title, rotation, output)",
        ),
        (
            "a = 1\nb = \nc = 2",
            "line 2: not TOML: Invalid value, at column 5",
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


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("My File", "expected lower-case letters, digits and underscores, a letter first, got "
         '"My File"'),
        ("1st", 'expected lower-case letters, digits and underscores, a letter first, got "1st"'),
        ("", 'expected lower-case letters, digits and underscores, a letter first, got ""'),
        ("lambda", "lambda is a reserved word, of Python or of Windows"),
        ("aux", "aux is a reserved word, of Python or of Windows"),
        ("numpy", "numpy.py would hide the Python module of this name"),
        ("random", "random.py would hide the Python module of this name"),
    ],
)  # fmt: skip
def test_the_name_of_the_file_names_folder_and_module(name, fault):
    assert faults(ZXZ, name) == [f"the file's name names the derivation: {fault}"]


def test_a_long_wrong_text_is_cut():
    (fault,) = faults(f'{ZXZ}[output]\nnote = ["{"x" * 900}"]')
    assert fault == f'line 4: output.note[0]: unknown name "{"x" * 40}…"; known: tex, pdf'


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
    start = time.perf_counter()
    assert faults(text)
    assert time.perf_counter() - start < A_WHILE


# files


def test_files_are_read_by_path_or_shipped_name():
    assert read_file("euler_zxz") == read_file(str(SHIPPED / "euler_zxz.toml"))


def test_a_file_comes_before_a_shipped_one_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("euler_zxz").write_text('[rotation]\nsequence = "xyz"', encoding="utf-8")
    assert read_file("euler_zxz").models == (EulerAngles("xyz"),)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"\n\xff", "line 2: not UTF-8 text"),
        (b"#" * 200_001, "cannot be read: it has more than 200000 bytes"),
    ],
)
def test_files_that_are_no_text(tmp_path, content, fault):
    file = tmp_path / "top.toml"
    file.write_bytes(content)
    with pytest.raises(SpecError) as caught:
        read_file(str(file))
    assert str(caught.value) == f"{file}: 1 fault, nothing written\n  {fault}"


def test_files_that_cannot_be_opened(tmp_path):
    with pytest.raises(SpecError, match=r"cannot be read: Is a directory$"):
        read_file(str(tmp_path))
    with pytest.raises(SpecError) as caught:
        read_file("euler_xzx")
    assert str(caught.value) == (
        "euler_xzx: 1 fault, nothing written\n  no such file, and no shipped derivation of this "
        "name; did you mean euler_zxz or euler_all?"
    )


# the shipped files


@pytest.mark.parametrize("name", resources.names("derivations", ".toml"))
def test_shipped_files_are_good_and_explained(name):
    spec = read_file(name)
    assert spec.title
    assert (SHIPPED / f"{name}.toml").read_text(encoding="utf-8").startswith("# ")
    assert DerivationSpec.from_data(spec.to_data()) == spec


def test_the_shipped_lecture_is_the_lecture():
    assert read_file("euler_zxz").models == (EulerAngles("ZXZ", ("phi", "theta", "psi")),)


def test_the_shipped_aircraft_has_the_matrix_that_its_comment_says():
    (model,) = read_file("yaw_pitch_roll").models
    assert model == EulerAngles("ZYX", ("psi", "theta", "phi"), passive=True)
    first_row = [str(entry).replace("(t)", "") for entry in model.matrix.T[0, :]]
    assert first_row == ["cos(psi)*cos(theta)", "sin(psi)*cos(theta)", "-sin(theta)"]


def test_the_shipped_list_has_all_sequences():
    names = {EulerAngles(sequence).name for sequence in EULER_SEQUENCES}
    assert {single.name for single in read_file("euler_all").singles()} == names


# specifications in Python


def test_the_specification_of_one_rotation():
    model = EulerAngles("zyx", ("a", "b", "c"), passive=True)
    assert spec_for("zyx", angles=["a", "b", "c"], passive=True) == DerivationSpec(
        name=model.name, models=(model,)
    )
    assert spec_for("z(a) x(b) z(c)").models == (EulerAngles("ZXZ", ("a", "b", "c")),)


@pytest.mark.parametrize(
    ("sequence", "angles", "message"),
    [
        ("ZZX", None, "two turns in a row"),
        ("ZXZ", [], "three different names"),
        ("ZXZ", ["a", "b", "b"], "three different names"),
        ("ZXZ", ["a", "b", "t"], "t is the time"),
        ("z(a) x(b) z(c)", ["a", "b", "c"], "names its angles itself; leave the other names out"),
        ("z(a) x(b", None, "column 7: this \\( is never closed"),
    ],
)
def test_a_wrong_rotation_is_a_wrong_use(sequence, angles, message):
    with pytest.raises(RigidsymError, match=message) as caught:
        spec_for(sequence, angles=angles)
    assert caught.value.exit_code == 2


def test_a_specification_checks_itself():
    model = EulerAngles("ZXZ")
    with pytest.raises(SpecError) as caught:
        DerivationSpec(
            name="top",
            title="\n",
            models=(model, replace(model, passive=True)),
            quantities=("mass",),
            kernels=(),
        )
    assert [str(fault) for fault in caught.value.faults] == [
        'kernels: the list is empty; expected a list of names such as ["numpy"]',
        "models: writes the folder euler_zxz_intrinsic, as entry 0 does",
        f'quantities[0]: unknown name "mass"; known: {", ".join(QUANTITY_NAMES)}',
        "title: an empty text; expected a title, or no such key",
    ]
    with pytest.raises(SpecError, match=r"name: numpy\.py would hide the Python module"):
        DerivationSpec(name="numpy", models=(model,))
    with pytest.raises(SpecError, match="models: expected at least one rotation"):
        DerivationSpec(name="top", models=())


# as plain data


@pytest.mark.parametrize("passive", [False, True])
def test_the_data_of_every_rotation_goes_through_json_and_back(sequence, passive):
    spec = spec_for(sequence, angles=["alpha", "lambda", "gamma"], passive=passive)
    data = json.loads(json.dumps(spec.to_data()))
    assert DerivationSpec.from_data(data) == spec


def test_the_form_of_the_data():
    spec = read('title = "T"\n[rotation]\nsequence = "313"\n[output]\nquantities = ["spin_matrix"]')
    assert spec.to_data() == {
        "name": "top",
        "title": "T",
        "rotations": [
            {"sequence": "ZXZ", "angles": ["phi", "theta", "psi"], "passive": False},
        ],
        "quantities": ["spin_matrix"],
        "kernels": ["numpy"],
        "note": ["tex"],
    }


def test_wrong_data_has_every_fault_at_once():
    rotations = [{"sequence": "ZZX"}, {"angles": None, "seqence": 1}]
    with pytest.raises(SpecError) as caught:
        DerivationSpec.from_data({"rotations": rotations, "note": 1, "nam": ""}, source="top.json")
    assert [str(fault) for fault in caught.value.faults] == [
        "nam: unknown key; did you mean name?",
        "name: missing; expected the name of the derivation",
        'note: expected a list of names such as ["tex"], got the number 1',
        "rotations[0].sequence: 'ZZX' is not an Euler sequence: two turns in a row are about one "
        "axis; neighbours must differ",
        "rotations[1].seqence: unknown key; did you mean sequence?",
        f"rotations[1].sequence: missing; expected {SEQUENCE}",
    ]


@pytest.mark.parametrize("data", [None, [], "top"])
def test_data_that_is_no_object(data):
    with pytest.raises(SpecError, match="expected an object"):
        DerivationSpec.from_data(data)


def test_a_rotation_that_no_file_can_name_has_no_data():
    model = EulerAngles("ZXZ")
    chain = replace(model, name="chain", turns=(model.turns[1], model.turns[0], model.turns[2]))
    with pytest.raises(ModelError, match="chain is not a sequence of Euler angles"):
        DerivationSpec(name="chain", models=(chain,)).to_data()


# junk


def is_read_or_refused(read_it, *arguments) -> None:
    """Any error but a SpecError goes through."""
    try:
        spec = read_it(*arguments)
    except SpecError:
        return
    assert DerivationSpec.from_data(spec.to_data()) == spec


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
    is_read_or_refused(DerivationSpec.from_data, data)
