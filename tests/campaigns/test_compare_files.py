"""`rigidsym compare` on pathological files: at most 10 s and 500 MB each, alone on a processor."""

from __future__ import annotations

import resource
import time
from multiprocessing import get_context

import pytest

from rigidsym.tools.compare.search import formulas

TURN = "[[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]]"
FILES = {
    "a sum nested in itself": "x = " + "1+(" * 43_000 + "1" + ")" * 43_000,
    "a megabyte in one line": "x = " + "a*b + " * 160_000 + "c",
    "a list of a megabyte": "x = [" + "cos(a), " * 125_000 + "0]",
    "broken syntax": "def f(: [[(" * 25_000,
    "10,000 matrices": "\n".join(f"R{k} = {TURN}" for k in range(10_000)),
    "nested blocks": "".join("    " * k + f"if x{k}:\n" for k in range(300))
    + "    " * 300
    + "y = 1",
    "nested braces": "void f() { " + "{ if (a > 1) " * 3_000 + "a = sin(a);" + "}" * 3_000 + "}",
    "nested choices": "x = " + "a ? sin(b) : " * 20_000 + "c;",
    "a value that grows": "def f(x):\n" + "    x = x*x + sin(x)\n" * 3_000 + "    return [x, x, x]",
    "values of values": "\n".join(f"y{k} = y{k - 1} + sin(y{k - 1})" for k in range(1, 3_000)),
}


def cost(text: str) -> tuple[float, int]:
    """The most seconds of a language, and the largest memory of this process in kilobytes."""
    seconds = []
    for suffix in (".py", ".cpp", ".js", ".m"):
        start = time.process_time()
        for _ in formulas(text, suffix):
            pass
        seconds.append(time.process_time() - start)
    return max(seconds), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


@pytest.mark.campaign
@pytest.mark.parametrize("name", FILES)
def test_a_pathological_file_costs_little(name):
    with get_context("spawn").Pool(1) as pool:
        seconds, kilobytes = pool.apply(cost, (FILES[name],))
    assert seconds < 10
    assert kilobytes < 500_000
