"""What a kernel computes, in no language yet: single assignment, every name defined before use.

Expressions are trees of the nodes below, over names. What is shared has a name; a call of a
function (sine, cosine, square root) always has one, so that it is made once, and so have a choice
and a guarded divisor.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import cached_property
from math import prod

from rigidsym.errors import KernelError
from rigidsym.mechanics.conversions.function import Continuity
from rigidsym.models.rotation import RotationModel
from rigidsym.system.records import NamedTuple, Record

# What every target must be able to call; and c0, c1, c2, ..., the functions c_k of n² that
# `algebra.stable_forms` derives.
# `eps` is the spacing of floats at one, in the type of its argument; `atan2` takes two arguments.
FUNCTIONS = ("sin", "cos", "sqrt", "abs", "atan2", "eps")


class Name(Record):
    """The value of an input or of an assignment."""

    text: str


class Number(Record):
    """An exact number, or the nearest double of an irrational one."""

    value: Fraction | float


class Negative(Record):
    """Minus the operand; as a term of a sum after the first, a subtraction."""

    operand: Expression


class Sum(Record):
    """The terms, added from left to right."""

    terms: tuple[Expression, ...]


class Product(Record):
    """The factors, multiplied from left to right, over the product of the divisors."""

    factors: tuple[Expression, ...]
    divisors: tuple[Expression, ...] = ()

    def __post_init__(self) -> None:
        if not self.factors:
            raise KernelError("a product needs at least one factor")


class Call(Record):
    """A function of one name, or of two."""

    function: str  # one of FUNCTIONS, or c0, c1, c2, ...
    argument: Name
    second: Name | None = None

    @property
    def arguments(self) -> tuple[Name, ...]:
        return (self.argument,) if self.second is None else (self.argument, self.second)

    @property
    def order(self) -> int | None:
        """k, where the function is c_k."""
        return int(self.function[1:]) if self.function not in FUNCTIONS else None


class Guarded(Record):
    """A value that divides, or NaN where rounding leaves no digit of it.

    That is where its size is at most eps^power times the size of `scale`, with the eps of its
    type; without a scale, where it is at most the smallest normal number over eps.
    """

    value: Name
    scale: Name | Number | None
    power: int = 1


class Compare(Record):
    """Whether a comparison holds; it does not where an operand is NaN."""

    relation: str  # "<", "<=", ">", ">=" or "=="
    left: Expression
    right: Expression


class Choice(Record):
    """`then` where the condition holds, else `otherwise`. A target may compute both."""

    condition: Expression  # a comparison, or the name of one
    then: Expression
    otherwise: Expression


Expression = Name | Number | Negative | Sum | Product | Call | Guarded | Compare | Choice


def parts(expression: Expression) -> tuple[Expression, ...]:
    """The expressions that one node is made of."""
    match expression:
        case Name() | Number():  # most are
            return ()
        case Negative(operand):
            return (operand,)
        case Sum(terms):
            return terms
        case Product(factors, divisors):
            return factors + divisors
        case Call():
            return expression.arguments
        case Compare(_, left, right):
            return (left, right)
        case Choice(condition, then, otherwise):
            return (condition, then, otherwise)
        case Guarded(value, scale):
            return (value,) if scale is None else (value, scale)


def walk(expression: Expression) -> Iterator[Expression]:
    """The expression and all that it is made of, the whole before its parts."""
    left = [expression]
    while left:
        node = left.pop()
        yield node
        left += reversed(parts(node))


def names_in(expression: Expression) -> Iterator[str]:
    return (node.text for node in walk(expression) if isinstance(node, Name))


class KernelArgument(NamedTuple):
    """An array of inputs and the names of its components, row by row."""

    name: str
    components: tuple[str, ...]
    units: tuple[str, ...]
    about: str
    shape: tuple[int, ...]  # (3, 3) of a matrix, () of a number such as the time, else (n,)


class Assignment(NamedTuple):
    """One name and its value."""

    name: str
    value: Expression


class Kernel(Record, kw_only=True):
    """One quantity as a function of vectors: assignments in order, then the outputs by rows.

    A kernel equals only itself, so that what is printed of it can be kept.

    Raises KernelError where a name is used before it is defined or defined twice, a call stands
    inside an expression, or the number of outputs does not fit the shape.
    """

    name: str
    arguments: tuple[KernelArgument, ...]
    assignments: tuple[Assignment, ...]
    outputs: tuple[Expression, ...]
    shape: tuple[int, ...]
    equation: int | None = None  # its number in the note, where it has one
    symbol: str = ""  # Unicode, one line: "Ω′"
    definition: str = ""  # Unicode, one line: "Rᵀ Ω"; may be empty
    about: str = ""  # words
    remarks: tuple[str, ...] = ()  # paragraphs
    unit: str = ""  # SI; "" for a pure number
    halves: tuple[Expression, ...] = ()  # of Euler angles: a₀ to a₃ of `conversions`
    original: Kernel | None = None  # the same but for the order of outputs, and names of inputs
    __eq__, __hash__ = object.__eq__, object.__hash__

    def __post_init__(self) -> None:
        if len(self.outputs) != prod(self.shape):
            raise KernelError(
                f"{self.name}: shape {self.shape} needs {prod(self.shape)} outputs, "
                f"got {len(self.outputs)}"
            )
        if self.original:  # which has been checked
            return
        known: set[str] = set()
        lines: list[tuple[str, Expression | None]] = [(name, None) for name in self.components]
        lines += [*self.assignments, *(("", output) for output in self.outputs)]
        for name, value in lines:
            for node in walk(value) if value else ():
                if isinstance(node, Name) and node.text not in known:
                    raise KernelError(f"{self.name}: {node.text} is used before it is defined")
                if isinstance(node, Call | Guarded | Choice) and not (name and node is value):
                    called = node.function if isinstance(node, Call) else type(node).__name__
                    raise KernelError(f"{self.name}: {called} is called inside an expression")
            if name in known:
                raise KernelError(f"{self.name}: {name} is defined twice")
            known.update([name] if name else [])

    @property
    def components(self) -> tuple[str, ...]:
        """The names of all inputs, in the order of the arguments."""
        return tuple(name for argument in self.arguments for name in argument.components)

    @cached_property
    def values(self) -> tuple[Expression, ...]:
        """Of all assignments, then the outputs."""
        return (*(assignment.value for assignment in self.assignments), *self.outputs)

    @cached_property
    def nodes(self) -> tuple[Expression, ...]:
        """All that the values are made of."""
        return tuple(node for value in self.values for node in walk(value))

    @cached_property
    def used(self) -> frozenset[str]:
        """The names that occur in the values."""
        return frozenset(node.text for node in self.nodes if isinstance(node, Name))

    @cached_property
    def calls(self) -> dict[str, Call]:
        """name: call, of the assignments that are calls."""
        return {a.name: a.value for a in self.assignments if isinstance(a.value, Call)}

    @cached_property
    def guards(self) -> dict[str, Guarded]:
        """name: guarded value, of the assignments that are one."""
        return {a.name: a.value for a in self.assignments if isinstance(a.value, Guarded)}

    @cached_property
    def sines(self) -> dict[Name, dict[str, str]]:
        """angle: {"sin": name, "cos": name}, of all that is taken of it."""
        found: dict[Name, dict[str, str]] = {}
        for name, call in self.calls.items():
            if call.function in ("sin", "cos"):
                found.setdefault(call.argument, {})[call.function] = name
        return found

    @property
    def statements(self) -> Iterator[tuple[str, Expression | dict[str, Call]]]:
        """The assignments, with all functions c_k of one square in the place of the first."""
        groups: dict[Name, dict[str, Call]] = {}
        for name, call in sorted(self.calls.items(), key=lambda named: named[1].order or 0):
            if call.order is not None:
                groups.setdefault(call.argument, {})[name] = call
        for name, value in self.assignments:
            if not isinstance(value, Call) or value.order is None:
                yield name, value
            elif group := groups.pop(value.argument, None):
                yield next(iter(group)), group

    @cached_property
    def divisors(self) -> tuple[Expression, ...]:
        """What the kernel divides by, each once: where one of them vanishes, it has a pole."""
        found = (d for node in self.nodes if isinstance(node, Product) for d in node.divisors)
        return tuple(dict.fromkeys(found))

    @property
    def returned_arguments(self) -> list[int]:
        """Places of the arguments whose components can be results as they are."""
        names = {output.text for output in self.outputs if isinstance(output, Name)}
        for name, value in reversed(self.assignments):
            if name in names and isinstance(value, Name | Choice | Guarded):
                names.update(names_in(value))
        return [k for k, a in enumerate(self.arguments) if not names.isdisjoint(a.components)]

    @cached_property
    def delicate(self) -> frozenset[str]:
        """Names whose relative error is the result's: factors of a divisor or of a size."""
        reached = {name for divisor in self.divisors for name in _factors_in(divisor)}
        # From the last one back, since a factor is assigned before the product that it is in.
        for assignment in reversed(self.assignments):
            is_size = isinstance(assignment.value, Call) and assignment.value.function == "abs"
            if is_size or assignment.name in reached:
                reached.update(_factors_in(assignment.value))
        return frozenset(reached)


def _factors_in(expression: Expression) -> Iterator[str]:
    """The names that an expression is a product of; a sum has errors of its own."""
    if not isinstance(expression, Sum):
        for part in parts(expression):
            yield from _factors_in(part)
    if isinstance(expression, Name):
        yield expression.text


class Program(NamedTuple):
    """The kernels of one derivation, and what a reader of the generated file must know."""

    name: str  # of the file, without its suffix
    title: str
    arguments: tuple[KernelArgument, ...]  # all that occur, in the order of a signature
    kernels: tuple[Kernel, ...]
    model: RotationModel | None = None
    of_body: tuple[str, ...] = ()  # sentences
    remarks: tuple[str, ...] = ()  # paragraphs for the head of the module
    continuity: Continuity | None = None  # of the coordinates along a trajectory

    @property
    def called(self) -> frozenset[str]:
        """The names of all functions that the kernels call."""
        return frozenset(c.function for kernel in self.kernels for c in kernel.calls.values())

    @property
    def last(self) -> int:
        """The highest k of the functions c_k that are called; -1 if there are none."""
        calls = (call for kernel in self.kernels for call in kernel.calls.values())
        return max((call.order for call in calls if call.order is not None), default=-1)

    @property
    def orders(self) -> int:
        """How many functions c_k are computed together: the first three, or more."""
        return max(2, self.last) + 1

    @property
    def has_angles(self) -> bool:
        return not self.called.isdisjoint(("sin", "cos"))

    @property
    def has_series(self) -> bool:
        return self.last >= 0

    @property
    def has_guards(self) -> bool:
        return any(kernel.guards for kernel in self.kernels)

    @property
    def has_matrices(self) -> bool:
        """Whether an argument is one."""
        return any(len(a.shape) > 1 for kernel in self.kernels for a in kernel.arguments)
