"""A function of one orientation in parts that are short enough to review, and need little stack.

What a later part needs is kept in an array, whose places are used again.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.targets.c.function import CStatement, Function, listed

_MOST = 60  # lines of a part
_FRAME = 6  # of them for the head and the braces, besides one an argument


def parts_of(function: Function) -> Iterator[str]:
    """The parts, static, and the function itself, which calls them; it alone if it is short."""
    kernel = function.kernel
    steps = _results_early(function.steps(), kernel)
    cuts = list(_cuts(steps, kernel))
    kept = _Kept(steps, cuts, kernel)
    real, suffix = function.precision.real, function.precision.suffix
    unused = (a.name for a in kernel.arguments if kernel.used.isdisjoint(a.components))
    calls = [f"    (void){name};" for name in unused]
    if len(cuts) == 1:
        yield _text(function.signature, [*calls, *kept.lines(0, real)])
        return
    calls += [f"    {real} shared[{kept.size}];"] if kept.size else []
    for place in range(len(cuts)):
        name = f"{function.name}_part{place + 1}{suffix}"
        lines = kept.lines(place, real)
        text = "\n".join(lines)
        arrays = {a.name: f"const {real} {{}}[{len(a.components)}]" for a in kernel.arguments}
        arrays["shared"] = f"{'' if kept.stored[place] else 'const '}{real} {{}}[{kept.size}]"
        arrays["out"] = f"{real} {{}}[{len(kernel.outputs)}]"
        given = [n for n in arrays if re.search(rf"\b{n}\[", text)]
        yield _text(listed(0, f"static void {name}(", [arrays[n].format(n) for n in given]), lines)
        calls.append(listed(4, f"{name}(", given) + ";")
    yield _text(function.signature, calls)


def _text(head: str, lines: Sequence[str]) -> str:
    return "\n".join([head, "{", *lines, "}"])


def _results_early(steps: Iterator[CStatement], kernel: Kernel) -> list[CStatement]:
    """Each entry of the result as soon as its values are known."""
    ordered: list[CStatement] = []
    after: defaultdict[int, list[CStatement]] = defaultdict(list)
    place = dict.fromkeys(kernel.components, 0)
    for step in steps:
        if step.defines:
            ordered.append(step)
            place |= dict.fromkeys(step.defines, len(ordered))
        elif step.lines:
            after[max((place[name] for name in step.uses), default=0)].append(step)
    return [*after[0], *(e for k, s in enumerate(ordered, start=1) for e in (s, *after[k]))]


def _cuts(steps: Sequence[CStatement], kernel: Kernel) -> Iterator[range]:
    """Ranges of steps, each as long as its lines allow."""
    first, room = 0, _MOST - _FRAME - len(kernel.arguments)
    last = {name: k for k, step in enumerate(steps) for name in step.uses}
    while first < len(steps):
        end = first + 1
        while end < len(steps) and _length(steps, range(first, end + 1), last) <= room:
            end += 1
        yield range(first, end)
        first = end


def _length(steps: Sequence[CStatement], cut: range, last: dict[str, int]) -> int:
    """Lines of a part, with those that fetch and keep values."""
    inside = [steps[k] for k in cut]
    defined = {name for step in inside for name in step.defines}
    fetched = {name for step in inside for name in step.uses} - defined
    kept = [name for name in defined if last.get(name, -1) >= cut.stop]
    return sum(len(step.lines) for step in inside) + len(fetched) + len(kept)


class _Kept:
    """Where values are between parts: components in the arguments, others in the array `shared`."""

    def __init__(self, steps: Sequence[CStatement], cuts: Sequence[range], kernel: Kernel) -> None:
        self._parts = [[steps[k] for k in cut] for cut in cuts]
        self._homes = {
            name: f"{a.name}[{k}]" for a in kernel.arguments for k, name in enumerate(a.components)
        }
        self._conditions = {n for step in steps if step.is_condition for n in step.defines}
        self.stored: list[list[str]] = []  # names that each part keeps for later ones
        self.size = 0
        last = {n: k for k, part in enumerate(self._parts) for step in part for n in step.uses}
        free: list[int] = []
        held: dict[str, int] = {}
        for k, part in enumerate(self._parts):
            for name in [name for name in held if last[name] <= k]:
                free.append(held.pop(name))
            defined = [n for step in part for n in sorted(step.defines)]
            self.stored.append([name for name in defined if last.get(name, -1) > k])
            for name in self.stored[-1]:
                if not free:
                    free, self.size = [self.size], self.size + 1
                held[name] = free.pop()
                self._homes[name] = f"shared[{held[name]}]"

    def lines(self, place: int, real: str) -> list[str]:
        """The lines of a part: values fetched, statements, values kept."""
        part = self._parts[place]
        defined = {name for step in part for name in step.defines}
        used = {name for step in part for name in step.uses} - defined
        return [
            *(f"    {self._fetched(n, real)}" for n in self._homes if n in used),
            *(f"    {line}" for step in part for line in step.lines),
            *(f"    {self._homes[name]} = {name};" for name in self.stored[place]),
        ]

    def _fetched(self, name: str, real: str) -> str:
        is_condition = name in self._conditions
        test = " > 0" if is_condition else ""
        return f"const {'int' if is_condition else real} {name} = {self._homes[name]}{test};"
