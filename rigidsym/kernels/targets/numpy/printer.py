"""Kernels as a Python module that depends only on NumPy, with scalar twins on plain floats."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from math import prod
from types import ModuleType

from rigidsym.kernels import loaded
from rigidsym.kernels.ir import (
    FUNCTIONS,
    Call,
    Choice,
    Kernel,
    Name,
    Program,
    functions_of,
    last_order,
)
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.schedule import narrowed
from rigidsym.kernels.targets.numpy.unwrap import unwrap_text
from rigidsym.kernels.targets.text import python, remarks
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python import (
    WIDTH,
    bracketed,
    docstring,
    exploded,
    tuple_of,
)
from rigidsym.system import resources

TEMPLATE = "numpy/module.py.jinja"
# the last two: of the functions that a page offers to copy, which are these in Python and C
RESERVED = python.RESERVED | {"np", "tan", "ValueError", "ZeroDivisionError", "entire", "fabs"}
OPTIONS = ("out: Array | None = None", "threads: int = 1")  # of every function of arrays

_BY_SIZE = (
    "Batches of fewer than 240 rows compute sines and cosines by another formula "
    "than large ones, so the last bits of a row may depend on the number of rows."
)
_NESTING = ("a float", "a tuple", "a tuple of rows", "a tuple of matrices")
_LONG = 96  # assignments of a kernel whose twin shares the function of arrays
_SPELLED = len("float, float, float, float")  # longer types are those of tuples of any length

_SCALAR = python.Statements(
    indent=8,
    functions={name: name for name in FUNCTIONS},
    guard="_or_nan_scalar",
    series="_entire_scalar",
)
BLOCK = python.Statements(
    indent=4,
    functions={"sin": "_sin", "cos": "_cos", "eps": "_eps"}
    | {"sqrt": "np.sqrt", "abs": "np.abs", "atan2": "np.arctan2"},
    library="np",
)
_SHARED = BLOCK._replace(  # for arrays and for plain floats
    functions={name: f"_of.{name}" for name in ("sin", "cos", "sqrt")} | {"abs": "abs"},
    guard="_of.or_nan",
)


def render(program: Program) -> dict[str, str]:
    """The module."""
    return {f"{program.name}.py": module_text(program)}


def load(name: str, files: Mapping[str, str]) -> ModuleType:
    """The module itself."""
    return loaded.load(name, files)


def module_text(
    program: Program,
    template: str = TEMPLATE,
    *,
    compute: str = "_compute",
    at_once: str = "",
    empty: str = "np.empty(whole, dtype)",
    block: python.Statements = BLOCK,
    **more: object,
) -> str:
    """The text of a module, in a template that may extend this one and needs more.

    `compute` is the function there that computes all orientations, `at_once` that of each kernel
    which is tried first, `empty` a new array for results, and `block` how functions of arrays are
    written.
    """
    kernels = list(map(_fitted, program.kernels))
    has_unwrap = bool(program.continuity) and template == TEMPLATE
    unwrap = [unwrap_text(program)] if has_unwrap else []
    exports = [f"{kernel.name}{twin}" for kernel in kernels for twin in ("", "_scalar")]
    exports += ["unwrap"] if unwrap else []
    return (
        resources.environment()
        .get_template(template)
        .render(
            about=docstring(_about(program, is_plain=template == TEMPLATE)),
            imports=f"from math import {', '.join(sorted(_imports(kernels)))}\n",
            exports=python.lines(f'"{name}",' for name in sorted(exports)),
            components=python.components(program),
            functions=[_function(kernel, at_once, block) for kernel in kernels],
            has_shared=any(map(_is_shared, kernels)),
            has_parts=any(kernel.parts for kernel in kernels),
            helpers="".join(f"\n\n{text}" for text in (*_helpers(kernels, block), *unwrap)),
            compute=compute,
            empty=empty,
            **more,
        )
    )


def _imports(kernels: Sequence[Kernel]) -> set[str]:
    """What the module needs of `math`, most of it in the scalar twins."""
    functions = functions_of(kernels)
    named = functions.intersection(FUNCTIONS) - {"abs", "eps"}
    series = {"sqrt", "tan"} if functions.difference(FUNCTIONS) else set()
    has_nan = any(kernel.gives_nan for kernel in kernels)
    shared = {"sin", "cos", "sqrt"} if any(map(_is_shared, kernels)) else set()
    return {"prod", *named, *series, *shared, *(["nan"] if has_nan else [])}


def _helpers(kernels: Sequence[Kernel], block: python.Statements) -> list[str]:
    """The functions behind guards and series, if the kernels need them."""
    environment = resources.environment()
    found = []
    has_guards = any(kernel.guards for kernel in kernels)
    if has_guards:
        found.append(environment.get_template("numpy/divisors.py").render())
    if block is BLOCK and any(map(_is_shared, kernels)):
        template = environment.get_template("numpy/shared.py.jinja")
        found.append(template.render(has_guards=has_guards))
    if last_order(kernels) >= 0:
        table = python.series_entries(kernels)
        series = f"{{\n{table}\n}}" if table else "{}"
        found.append(environment.get_template("numpy/series.py.jinja").render(series=series))
    return found + python.helpers(kernels, "numpy")


def _is_shared(kernel: Kernel) -> bool:
    """Whether floats take the function of arrays, lest a long one be written twice."""
    values = [assignment.value for assignment in kernel.assignments]
    called = {value.function for value in values if isinstance(value, Call)}
    has_choice = any(isinstance(value, Choice) for value in values)
    return len(values) > _LONG and called <= {*_SHARED.functions} and not has_choice


def needs_eps(kernel: Kernel) -> bool:
    """Whether its values depend on the eps of the result's type."""
    return bool(kernel.guards) or "eps" in functions_of([kernel])


def _fitted(kernel: Kernel) -> Kernel:
    """The kernel in lines that fit: a scalar twin's assignments and the rows of its outputs."""
    depth = 1 + max(map(len, kernel.parts)) if kernel.parts else len(kernel.shape)
    deepest = 8 + 4 * depth
    return narrowed(kernel, infix, line=WIDTH - 8, output=WIDTH - deepest - len(","))


def _function(kernel: Kernel, at_once: str, statements: python.Statements) -> dict[str, str]:
    """The pieces of text that stand for one kernel in the template."""
    block, scalar = f"_{kernel.name}", f"{kernel.name}_scalar"
    results = kernel.parts or (kernel.shape,)
    shape = str(kernel.parts or kernel.shape)
    floats = [f"{name}: float" for argument in kernel.arguments for name in argument.components]
    numbers = f"_in_a_row({scalar})" if kernel.parts else scalar
    given = [block, numbers, str(kernel.shape), "out", "threads", *python.passed(kernel, "np")]
    margin = 4 if _is_shared(kernel) else 8
    points = [_row(argument.components, margin) for argument in kernel.arguments]
    nesting = " and ".join(_NESTING[len(each)] for each in results)
    twin = [f"`{kernel.name}` of one orientation; floats to {nesting}."]
    return {
        "signature": bracketed(
            0,
            f"def {kernel.name}(",
            python.parameters(kernel, *OPTIONS),
            f") -> {python.returned(kernel)}:",
        ),
        "about": docstring(python.about_function(kernel), indent=4),
        "body": _body(kernel, given, at_once.format(kernel.name)),
        "ufunc": python.ufunc(kernel),
        "scalar_signature": bracketed(0, f"def {scalar}(", floats, f") -> {_type(results)}:"),
        "scalar_about": docstring(twin, indent=4),
        "scalar_body": _scalar_body(kernel, [block, shape, *points]),
        "block": _block(kernel, statements),
    }


def _type(results: Sequence[Sequence[int]]) -> str:
    """The type of a value in floats, or of two."""
    each = list(map(_floats, results))
    if len(each) < 2:
        return each[0]
    line = f"tuple[{', '.join(each)}]"
    return line if len(line) <= WIDTH - len(") -> :") else exploded(0, "tuple[", each, "]")


def _floats(shape: Sequence[int]) -> str:
    """The type of one value in floats: tuple[float, float, float]."""
    if not shape:
        return "float"
    inner = _floats(shape[1:])
    spelled = ", ".join([inner] * shape[0])
    return f"tuple[{spelled if len(spelled) <= _SPELLED else f'{inner}, ...'}]"


def _body(kernel: Kernel, arguments: Sequence[str], at_once: str) -> str:
    """The call that computes the result; several results are parts of one array.

    `at_once` is a function that may give the result, or None, with less ado.
    """
    result = "both" if kernel.parts else "result"
    lines = [bracketed(4, f"{result} = _apply(", arguments, ")")]
    if at_once and not any(argument.is_matrix for argument in kernel.arguments):
        vectors = [argument.name for argument in kernel.arguments]
        lines = [
            f"    {result} = None",
            "    if threads == 1:",
            bracketed(8, f"{result} = {at_once}(", [*vectors, "out"], ")"),
            f"    if {result} is None:",
            bracketed(8, f"{result} = _apply(", arguments, ")"),
        ]
    elif not kernel.parts:
        return bracketed(4, "return _apply(", arguments, ")")
    parts = [result, *map(str, kernel.parts)]
    returned = bracketed(4, "return _parted(", parts, ")") if kernel.parts else "    return result"
    return "\n".join([*lines, returned])


def _scalar_body(kernel: Kernel, given: Sequence[str]) -> str:
    """The statements of the scalar function, and its fallback where floats raise an error."""
    if _is_shared(kernel):
        return bracketed(4, "return _of_floats(", given, ")")
    return "\n".join(
        [
            "    try:",
            *_scalar_lines(kernel),
            _scalar_return(kernel),
            "    except (ValueError, ZeroDivisionError):",
            bracketed(8, "return _exceptional(", given, ")"),
        ]
    )


def _scalar_lines(kernel: Kernel) -> Iterator[str]:
    for name, value in kernel.statements:
        is_eps = isinstance(value, Call) and value.function == "eps"
        yield f"        {name} = {2.0**-52!r}" if is_eps else _SCALAR.text(name, value)


def _block(kernel: Kernel, statements: python.Statements = BLOCK) -> str:
    """The function of arrays with the components on their first axis.

    An output that is a component is a copy, since writing results may change the arguments.
    """
    names = Names([*kernel.components, *(a.name for a in kernel.assignments)])
    vectors = [names.fresh(argument.name) for argument in kernel.arguments]
    parts = kernel.components
    outputs = [
        f"+{output.text}" if isinstance(output, Name) and output.text in parts else infix(output)
        for output in kernel.outputs
    ]
    head, more = "_", [f"{statements.eps}=None"] if statements.eps and needs_eps(kernel) else []
    if statements is BLOCK and _is_shared(kernel):
        head, statements, more = "_of.", _SHARED, ["_of=None"]
    lines = [bracketed(0, f"def _{kernel.name}(", [*vectors, *more], "):")]
    lines += ["    _of = _of or _ARRAYS"] if statements is _SHARED else []
    for vector, argument in zip(vectors, kernel.arguments, strict=True):
        lines += _unpacked(vector, argument.components, kernel.used)
    lines += _block_lines(kernel, statements, head)
    return "\n".join([*lines, _tuple(4, "return ", outputs)])


def _unpacked(vector: str, components: Sequence[str], used: Container[str]) -> list[str]:
    """The components of an array; to index a few costs half of what unpacking does."""
    if len(components) > python.MANY:
        return list(_in_lines(vector, components, used))
    found = {name: f"{vector}[{k}]" for k, name in enumerate(components) if name in used}
    line = f"    {', '.join(found)} = {', '.join(found.values())}"
    if len(line) <= WIDTH:
        return [line] if found else []
    return [f"    {name} = {place}" for name, place in found.items()]


def _in_lines(vector: str, components: Sequence[str], used: Container[str]) -> Iterator[str]:
    """Neighbours together, as many as a line has room for: a1, a2, a3 = q[1:4]"""
    first, together = 0, ""
    for k, name in enumerate([*components, ""]):
        place = f"[{first}:{k}]" if k > first + 1 else f"[{first}]"
        line = f"    {together} = {vector}{place}"
        if together and (name not in used or len(f"{line}, {name}0") > WIDTH):
            yield line
            together = ""
        if name in used:
            first, together = (k, name) if not together else (first, f"{together}, {name}")


def _block_lines(kernel: Kernel, statements: python.Statements, head: str) -> Iterator[str]:
    """The assignments on arrays, the sines and the cosines of several angles in one call."""
    together = _gathered(kernel)
    for name, value in kernel.statements:
        call = value if isinstance(value, Call) and value.function in ("sin", "cos") else None
        if call is None or len(kernel.sines[call.argument]) < 2:
            yield statements.text(name, value)
        elif name in together:
            angles = together[name]
            names = [kernel.sines[angle][part] for part in ("sin", "cos") for angle in angles]
            given = [angle.text for angle in angles]
            yield bracketed(4, f"{', '.join(names)} = {head}sin_cos(", given, ")")
        if call is not None and call.function == "cos" and name in kernel.delicate:
            yield bracketed(4, f"{name} = {head}sharp(", [name, call.argument.text], ")")


def _gathered(kernel: Kernel) -> dict[str, list[Name]]:
    """Angles whose sines and cosines are taken in one call, by the name of their first sine.

    Neighbours of one vector, as many as a line has room for; not with a cosine that divides,
    which is taken anew.
    """
    vectors = {name: a.name for a in kernel.arguments for name in a.components}
    found: dict[str, list[Name]] = {}
    last, room = "", 0
    for angle, pair in kernel.sines.items():
        if len(pair) < 2:
            continue
        is_alone = angle.text not in vectors or pair["cos"] in kernel.delicate
        vector = "" if is_alone else vectors[angle.text]
        needed = len(", ".join(pair.values())) + len(", ")
        if not vector or vector != last or needed > room:
            first = min(pair.values(), key=[*kernel.calls].index)
            found[first], room = [], WIDTH - len("     = _of.sin_cos(")
        found[first].append(angle)
        last, room = vector, room - needed
    return found


def _scalar_return(kernel: Kernel) -> str:
    outputs = list(map(infix, kernel.outputs))
    if kernel.parts:
        first, second = kernel.parts
        place = prod(first)
        both = [_nested(outputs[:place], first, 8), _nested(outputs[place:], second, 8)]
        return _tuple(8, "return ", both)
    if not kernel.shape:
        return f"        return {outputs[0]}"
    return _tuple(8, "return ", _parts(outputs, kernel.shape, 8))


def _nested(items: Sequence[str], shape: Sequence[int], margin: int) -> str:
    """Numbers in the tuples of a shape, as an item of brackets that open at a margin."""
    if len(shape) < 2:
        return _row(items, margin) if shape else items[0]
    return _tuple(margin + 4, "", _parts(items, shape, margin + 4)).lstrip()


def _parts(items: Sequence[str], shape: Sequence[int], margin: int) -> list[str]:
    """The same without the outermost brackets."""
    size = prod(shape[1:])
    rows = (items[start : start + size] for start in range(0, len(items), size))
    return [_nested(row, shape[1:], margin) for row in rows]


def _row(items: Sequence[str], margin: int = 8) -> str:
    """One row of a matrix: in a line if it fits, else an entry a line."""
    line, margin = tuple_of(items), margin + 4
    return line if len(line) <= WIDTH - margin - len(",") else _tuple(margin, "", items).lstrip()


def _tuple(indent: int, head: str, items: Sequence[str]) -> str:
    if len(items) == 1:
        return f"{' ' * indent}{head}({items[0]},)"
    return exploded(indent, f"{head}(", items, ")")


def _about(program: Program, *, is_plain: bool) -> list[remarks.Paragraph]:
    """The paragraphs of the module's docstring; in a plain module NumPy takes the sines."""
    has_sines = is_plain and any(kernel.sines for kernel in program.kernels)
    return remarks.about_module(
        program,
        "functions of NumPy arrays",
        python.ARGUMENTS,
        python.about_arguments(program),
        "Leading axes broadcast; inputs need not be contiguous. If the columns of an argument have "
        "names (data frames, structured arrays, mappings), these decide, not the order. The result "
        "is float32 if every argument is float32, else float64; integers are converted to float64. "
        "`out`, an array of "
        "the result's shape and dtype, is filled and returned; it may overlap the arguments. "
        "`threads` sets the number of worker threads (about 4 MB each). No warnings are issued. "
        "Each function has a scalar version `..._scalar` for one orientation in plain floats, and "
        "an attribute `signature`, its signature as a generalised ufunc.",
        *([_BY_SIZE] if has_sines else []),
        has_unwrap=is_plain,
    )
