"""Kernels made by hand, whose lines have every width: what is broken into lines, and where."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle, islice

from rigidsym.kernels.ir import (
    Assignment,
    Call,
    Choice,
    Compare,
    Guarded,
    Kernel,
    KernelArgument,
    Name,
    Negative,
    Number,
    Product,
    Program,
    Sum,
)
from rigidsym.mechanics.conversions.function import Continuity

WIDEST = 44


LONG = range(20, 30)  # where rows of three names begin to be broken


def swept() -> Program:
    """Kernels for each length of names."""
    kernels = [kernel for length in range(1, WIDEST) for kernel in _of_length(length)]
    kernels += [_long(length, 97) for length in LONG]
    remarks = "word " * 99, "long" * 30 + "-" + "words" * 9
    continuity = Continuity("quaternion", remarks)
    return _program("swept", [*kernels, _long(1, 96)])._replace(continuity=continuity)


def of_series(order: int) -> Program:
    """One function of n², and no other."""
    kernel = Kernel(
        name=f"c{order}",
        arguments=(_vector("q", ["n"]),),
        assignments=(Assignment("c", Call(f"c{order}", Name("n"))),),
        outputs=(Name("c"),),
        shape=(1,),
    )
    return _program(f"series_{order}", [kernel])


def _program(name: str, kernels: list[Kernel]) -> Program:
    arguments = {argument.name: argument for kernel in kernels for argument in kernel.arguments}
    return Program(
        name=name,
        title="Names of every length",
        convention=("None.",),
        source="nobody",
        arguments=(*arguments.values(),),
        kernels=(*kernels,),
    )


def _long(length: int, count: int, every: int = 8) -> Kernel:
    """So many assignments, with every function that long ones may call."""
    names = [letter * length for letter in "abc"]
    functions = ("sin", "cos", "sqrt", "abs")
    calls = [Assignment(f"{f}_a", Call(f, Name(names[0]))) for f in functions]
    known = [*map(Name, names), *(Name(call.name) for call in calls)]
    sums = []
    for k in range(count - 4):  # each needs what was computed long before
        product = Product((known[-1 - k // 3], known[k // 2]))
        sums.append(Assignment(f"x{k}", Sum((known[k % 5], product))))
        known.append(Name(f"x{k}"))
    return Kernel(
        name=f"long_{length}_{count}_{every}",
        arguments=(_vector(f"q{length}", names),),
        assignments=(*calls, *sums),
        outputs=(*(Name(a.name) for a in sums[::-every]),),
        shape=(len(sums[::-every]),),
    )


def _of_length(length: int) -> Iterator[Kernel]:
    names = [letter * length for letter in "abc"]
    a, b, c = map(Name, names)
    sines = [
        Assignment(f"{start}_{name.text}", Call(function, name))
        for name in (a, b, c)
        for function, start in (("sin", "sin"), ("cos", "cosine"))
    ]
    first, second = Name(sines[0].name), Name(sines[3].name)
    product = Product((first, second, c))
    yield Kernel(
        name=f"vector_{length}",
        arguments=(_vector(f"q{length}", names),),
        assignments=(
            *sines,
            Assignment("x", Sum((product, Negative(a), c))),
            Assignment("angle", Sum((a, b))),
            Assignment("sine", Call("sin", Name("angle"))),
        ),
        outputs=(
            Sum((product, Name("x"), Name("sine"))),
            Negative(product),
            Product((c,), (a,)),
            a,
        ),
        shape=(2, 2),
    )
    yield Kernel(
        name=f"row_{length}",
        arguments=(
            _vector(f"q{length}", names),
            _vector("v", ["d" * length]),
        ),
        assignments=(
            Assignment("size", Call("abs", a)),
            Assignment("t", Sum((Product((b,), (a,)), *(c,) * (length % 20)))),
            Assignment("g", Guarded(Name("t"), Name("size"), 1 + length % 2)),
            Assignment("upper", Choice(Compare("<", b, c), c, b)),
            Assignment("lower", Choice(Compare("<", b, c), b, c)),
            Assignment("other", Choice(Compare(">=", b, c), b, c)),
            Assignment("is_far", Compare(">", b, Number(0.25))),
            Assignment("y", Choice(Name("is_far"), Name("g"), Negative(b))),
        ),
        outputs=(
            Product((Name("y"),), (Name("g"),)),
            c,
            Name("d" * length),
            *map(Name, ("upper", "lower", "other")),
        ),
        shape=(6,),
    )
    yield Kernel(
        name=f"both_{length}",
        arguments=(_vector(f"q{length}", names), _vector(f"u{length}", ["e" * (length + 30)])),
        assignments=(),
        outputs=(
            a,
            Sum((a, b)),
            b,
            c,
            Product((a, c)),
            Sum((Name("e" * (length + 30)), Number(1.5))),
        ),
        shape=(6,),
        parts=((2,), (2, 2)),
    )
    many = [f"m{k}" for k in range(length)]
    yield Kernel(
        name=f"many_{length}",
        arguments=(_vector("w", many),),
        assignments=(),
        outputs=(*(Name(name) for k, name in enumerate(many) if k % 5 in (0, 1, 3)),),
        shape=(len([k for k in range(length) if k % 5 in (0, 1, 3)]),),
    )


def _vector(name: str, components: list[str]) -> KernelArgument:
    units = tuple(islice(cycle(("rad", "", "m")), len(components)))  # some have none
    return KernelArgument(name, (*components,), units, "a vector")
