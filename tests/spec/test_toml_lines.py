"""Lines of keys: a table of layouts, and generated files against what tomllib reads in them."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from itertools import count

import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st

from rigidsym.spec.toml_lines import Path, locate


@pytest.mark.parametrize(
    ("text", "path", "line"),
    [
        ("a = 1", ("a",), 1),
        ("\n# a = 0\n\n  a = 1 # a", ("a",), 4),
        ("\r\n\r\na = 1\r\nb = 2", ("b",), 4),
        ("a.b . c = 1", ("a", "b"), 1),
        ("a.b = 1\na.c = 2", ("a",), 1),
        ("a.b = 1\na.c = 2", ("a", "c"), 2),
        ('\'a.b\' = 1\n"c\\"d" = 2', ('c"d',), 2),
        ('"\\u00e9" = 1', ("é",), 1),
        ("\n[a]\nb = 1", ("a",), 2),
        ("\n[a]\nb = 1", ("a", "b"), 3),
        ("[ a . 'b' ]\nc = 1", ("a", "b", "c"), 2),
        ("[a.b]\n[a]", ("a",), 2),
        ("[a]\n[a.b]", ("a",), 1),
        ("[[a]]\nb = 1\n[[a]]\nb = 2", ("a", 1, "b"), 4),
        ("[[a]]\nb = 1\n[[a]]\nb = 2", ("a",), 1),
        ("[[a]]\n[a.b]\nc = 1\n[[a]]\n[a.b]\nc = 2", ("a", 1, "b", "c"), 6),
        ("[[a]]\n[[a.b]]\n[[a.b]]\n[[a]]\n[[a.b]]", ("a", 1, "b", 0), 5),
        ("a = [1, 2,\n3,\n# 4,\n\n4]", ("a", 3), 5),
        ("a = [\n]\nb = 1", ("b",), 3),
        ("a = [[1,\n2],\n[3]]", ("a", 0, 1), 2),
        ("a = [[1,\n2],\n[3]]", ("a", 1, 0), 3),
        ("a = { b = 1, c.d = [\n2 ] }\ne = 3", ("a", "c", "d", 0), 2),
        ("a = {}\nb = 1", ("b",), 2),
        ('a = """\n]\\"" # "\n"""\nb = 1', ("b",), 4),
        ('a = """"q""""\nb = 1', ("b",), 2),
        ('a = """"""\nb = 1', ("b",), 2),
        ("a = '''\n'q'' ]'''''\nb = 1", ("b",), 3),
        ("a = ''\nb = ['#', \"]\",\n1]", ("b", 2), 3),
        ("a = 1979-05-27 07:32:00 # c\nb = [1979-05-27 07:32:00, 1]", ("b", 1), 2),
        ("a = 1979-05-27T07:32:00Z\nb = -inf", ("b",), 2),
    ],
)
def test_lines(text, path, line):
    tomllib.loads(text)
    assert locate(text)[path] == line


# generated files

bare = st.sampled_from("abcdefghijkl")
keys = st.one_of(bare, bare.map('"{}"'.format), bare.map("'{}'".format), st.just('"] #\\" = "'))
dotted = st.lists(keys, min_size=1, max_size=3).flatmap(
    lambda parts: st.sampled_from([".", " . "]).map(lambda dot: dot.join(parts))
)
gaps = st.sampled_from(["", " ", "\n", " # ] } '''\n", "\n\n"])  # where line ends are free
NUMBER = "@"  # takes a number of its own, which tells the line it stands on
scalars = st.sampled_from(
    [
        NUMBER,
        NUMBER,
        "true",
        "-inf",
        "1979-05-27 07:32:00",
        "''",
        "'] # \"'",
        '"a \\" ] = #"',
        '"""\n"a"\n]\\"""""',
        "'''\n= ' # '\n''''",
    ]
)


def compound(inner):
    lists = st.lists(st.tuples(gaps, inner, gaps).map("".join), max_size=4).flatmap(
        lambda parts: gaps.map(lambda gap: f"[{','.join(parts)}{',' * bool(parts)}{gap}]")
    )
    tables = st.lists(st.tuples(dotted, inner).map(" = ".join), max_size=3).map(
        lambda parts: f"{{ {', '.join(parts)} }}"
    )
    return lists | tables


values = st.recursive(scalars, compound, max_leaves=6)
statements = st.one_of(
    st.tuples(dotted, values).map(" = ".join),
    dotted.map("[{}]".format),
    dotted.map("[[ {} ]]".format),
    st.sampled_from(["", "# [a] = '''", "  "]),
)


def numbered(text: str) -> str:
    numbers = count(7_000_001)
    return re.sub(NUMBER, lambda _: str(next(numbers)), text)


def leaves(value: object, path: Path = ()) -> Iterator[tuple[Path, object]]:
    """Every path of a parsed file, with what stands there."""
    if path:
        yield path, value
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from leaves(entry, (*path, key))
    elif isinstance(value, list):
        for place, entry in enumerate(value):
            yield from leaves(entry, (*path, place))


@settings(
    max_examples=400,
    deadline=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
@given(st.lists(statements, max_size=8), st.sampled_from(["\n", "\r\n"]))
def test_every_path_is_located_and_every_number_on_its_line(parts, line_end):
    text = numbered("\n".join(parts)).replace("\n", line_end)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        assume(False)
    lines = locate(text)
    found = dict(leaves(data))
    assert lines.keys() == found.keys()
    for path, value in found.items():
        if isinstance(value, int) and value > 7_000_000:
            assert lines[path] == text[: text.index(str(value))].count("\n") + 1


@settings(max_examples=200, deadline=None)
@given(st.text(alphabet="ab=[]{}.,'\"\\# \n1", max_size=40))
def test_no_text_that_tomllib_takes_is_too_much(text):
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return
    assert locate(text).keys() == dict(leaves(data)).keys()


def test_text_that_is_not_toml_is_refused():
    with pytest.raises(ValueError, match=r"^not TOML at character 0$"):
        locate("*")
