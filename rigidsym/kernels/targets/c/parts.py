"""A function of one orientation in parts that are short enough to review, and need little stack.

What a later part needs is kept in an array, whose places are used again.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator, Sequence

from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.targets.c.function import CStatement, Function, listed

_MOST = 60  # lines of a function
_FRAME = 6  # of them for the head and the braces, besides one an argument
_PLACES = 80  # of `shared`, in 640 bytes


def parts_of(function: Function) -> Iterator[str]:
    """The parts and the function itself, which calls them; it alone if it is short.

    If the values in between need too much memory, it calls stages, each with values of its own,
    which compute some entries of the result from the arguments.
    """
    kernel = function.kernel
    steps = _results_early(function.steps(), kernel)
    unused = (a.name for a in kernel.arguments if kernel.used.isdisjoint(a.components))
    calls = [f"    (void){name};" for name in unused]
    if _length(steps, range(len(steps)), {}) <= _room(kernel):
        kept = _Kept(steps, [range(len(steps))], kernel)
        yield _text(function.signature, [*calls, *kept.lines(0, function.precision.real)])
        return
    stages, first = list(_stages(steps, function)), 1
    for number, stage in enumerate(stages, start=1):
        yield from stage.parts(first)
        lines = stage.calls(first)
        first += len(stage.cuts)
        if len(stages) == 1:
            calls += lines
        else:
            name = f"{function.name}_stage{number}{function.precision.suffix}"
            yield _declared(function, name, lines)
            calls += _called(function, name, lines, shares=False)
    yield _text(function.signature, calls)


def _stages(steps: Sequence[CStatement], function: Function) -> Iterator[_Stage]:
    """As many entries of the result at a time as the memory and the lines allow."""
    order = _DepthFirst(steps)
    results = [k for k, step in enumerate(steps) if not step.defines]
    first, last = 0, _Stage(function, order.of(results[:1]))
    for k in range(1, len(results)):
        longer = _Stage(function, order.of(results[first : k + 1]))
        if not longer.is_small:
            yield last
            first, longer = k, _Stage(function, order.of([results[k]]))
        last = longer
    yield last


class _DepthFirst:
    """An order in which few values wait: what needs the most places is computed first."""

    def __init__(self, steps: Sequence[CStatement]) -> None:
        self._steps = steps
        makers = {name: k for k, step in enumerate(steps) for name in step.defines}
        self._before: list[list[int]] = []
        places: list[int] = []  # that a step and all before it need (Sethi and Ullman)
        for step in steps:
            before = {makers[name] for name in step.uses if name in makers}
            self._before.append(sorted(before, key=lambda k: (-places[k], k)))
            needed = (places[k] + j for j, k in enumerate(self._before[-1]))
            places.append(max(needed, default=1))

    def of(self, results: Sequence[int]) -> list[CStatement]:
        """The steps of some results, one result after the other."""
        order: dict[int, None] = {}
        waiting = list(reversed(results))
        while waiting:
            missing = [k for k in self._before[waiting[-1]] if k not in order]
            if missing:
                waiting.append(missing[0])
            else:
                order[waiting.pop()] = None
        return [self._steps[k] for k in order]


class _Stage:
    """Steps in parts, and the array `shared` between them."""

    def __init__(self, function: Function, steps: Sequence[CStatement]) -> None:
        self._function = function
        self.cuts = list(_cuts(steps, function.kernel))
        self._kept = _Kept(steps, self.cuts, function.kernel)

    @property
    def is_small(self) -> bool:
        return self._kept.size <= _PLACES and len(self.calls(1)) <= _MOST - _FRAME

    def parts(self, first: int) -> Iterator[str]:
        size, real = self._kept.size, self._function.precision.real
        for place, name in enumerate(self._names(first)):
            constant = "" if self._kept.stored[place] else "const "
            shared = f"{constant}{real} shared[{size}]"
            yield _declared(self._function, name, self._lines(place), shared)

    def calls(self, first: int) -> list[str]:
        """The lines that call the parts."""
        size, real = self._kept.size, self._function.precision.real
        called = (
            _called(self._function, name, self._lines(place), shares=True)
            for place, name in enumerate(self._names(first))
        )
        declared = [f"    {real} shared[{size}];"] if size else []
        return [*declared, *(line for lines in called for line in lines)]

    def _names(self, first: int) -> Iterator[str]:
        suffix = self._function.precision.suffix
        return (f"{self._function.name}_part{first + k}{suffix}" for k in range(len(self.cuts)))

    def _lines(self, place: int) -> list[str]:
        return self._kept.lines(place, self._function.precision.real)


def _text(head: str, lines: Sequence[str]) -> str:
    return "\n".join([head, "{", *lines, "}"])


def _declared(function: Function, name: str, lines: Sequence[str], shared: str = "") -> str:
    """A function of the arrays that its lines name, for those of this file only."""
    real, arguments = function.precision.real, function.kernel.arguments
    arrays = {a.name: f"const {real} {a.name}[{len(a.components)}]" for a in arguments}
    arrays |= {"shared": shared, "out": f"{real} out[{len(function.kernel.outputs)}]"}
    given = [arrays[n] for n in _arrays(function, lines) if arrays[n]]
    return _text(listed(0, f"PART void {name}(", given), lines)


def _called(function: Function, name: str, lines: Sequence[str], *, shares: bool) -> list[str]:
    given = [n for n in _arrays(function, lines) if shares or n != "shared"]
    return f"{listed(4, f'{name}(', given)};".split("\n")


def _arrays(function: Function, lines: Sequence[str]) -> list[str]:
    words = set(re.findall(r"\w+", "\n".join(lines)))
    return [
        n for n in (*(a.name for a in function.kernel.arguments), "shared", "out") if n in words
    ]


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
    first, room = 0, _room(kernel)
    last = {name: k for k, step in enumerate(steps) for name in step.uses}
    while first < len(steps):
        end = first + 1
        while end < len(steps) and _length(steps, range(first, end + 1), last) <= room:
            end += 1
        yield range(first, end)
        first = end


def _room(kernel: Kernel) -> int:
    return _MOST - _FRAME - len(kernel.arguments)


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
            *(
                f"    const int {name} = {home} > 0;"
                if name in self._conditions
                else f"    const {real} {name} = {home};"
                for name, home in self._homes.items()
                if name in used
            ),
            *(f"    {line}" for step in part for line in step.lines),
            *(f"    {self._homes[name]} = {name};" for name in self.stored[place]),
        ]
