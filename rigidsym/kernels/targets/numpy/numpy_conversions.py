"""Conversions as NumPy functions: each formula once on arrays and once on plain floats."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from string import Template

from rigidsym.kernels.conversions.conversions import ConversionProgram, Formula
from rigidsym.kernels.conversions.formulas import MATRIX, QUATERNION
from rigidsym.kernels.conversions.unwrap import ChainUnwrapping, Unwrapping
from rigidsym.kernels.targets.numpy.function import OPTIONS, Additions, Function
from rigidsym.kernels.targets.text.layout import WIDTH, bracketed, docstring, exploded
from rigidsym.system import resources

_HELPERS = "kernels_numpy_conversions.jinja"
_UNWRAP = "kernels_unwrap_{}.jinja"
_ARRAYS = {
    "sqrt": "np.sqrt",
    "atan2": "np.arctan2",
    "hypot": "np.hypot",
    "sin": "np.sin",
    "cos": "np.cos",
    "pick": "np.where",
    "wrapped": "_wrapped",
    "tiny": "_tiny(far)",
    "reach": "_reach(far)",
    "nan": "np.nan",
    "pi": "np.pi",
}
_NUMPY = {  # words of the templates that libraries of NumPy's kind share
    "np": "np",
    "running_maximum": "np.maximum.accumulate",
    "root": "np.sqrt",
    "is_whole": "not gap.any()",
}
_FLOATS = {name: name for name in ("sqrt", "atan2", "hypot", "sin", "cos")} | {
    "pick": "_pick",
    "wrapped": "_wrapped_float",
    "tiny": "_TINY",
    "reach": "_REACH",
    "nan": "nan",
    "pi": "pi",
}
_OF_MATH = frozenset({"sqrt", "atan2", "hypot", "sin", "cos", "nan", "pi"})
_GIVEN = {  # what an argument is passed on as
    "matrix": "_entries(matrix)",
    "kept": "np.zeros({}, np.float32) if kept is None else kept",
}
_SHAPES = {
    "p": "(..., 4)",
    "matrix": "(..., 3, 3)",
    "q": "(..., n)",
    "parameters": "(..., k)",
    "kept": "(..., {})",
}
_CALLED = re.compile(r"\$(\w+)")


def additions(program: ConversionProgram, shape: str) -> Additions:
    """The text of all formulas and of `unwrap`; `shape` is that of the coordinates, "(3,)"."""
    formulas, unwrapping = program.formulas, program.unwrapping
    exports = [name for f in formulas for name in (f.name, f"{f.name}_scalar")]
    called = {name for f in formulas for text in _texts(f) for name in _CALLED.findall(text)}
    return Additions(
        functions=tuple(_function(formula, shape) for formula in formulas),
        exports=tuple(exports) + (("unwrap",) if unwrapping else ()),
        components=components(formulas),
        imports=frozenset(called & _OF_MATH),
        helpers=_helpers(unwrapping) if exports else "",
        remarks=program.remarks,
    )


def _helpers(unwrapping: Unwrapping | None) -> str:
    template = resources.environment().get_template(_HELPERS)
    texts = [template.render(has_unwrap=unwrapping is not None, **_NUMPY)]
    if unwrapping is not None:
        texts.append(unwrap_text(unwrapping, _ARRAYS, _NUMPY))
    return "\n\n".join(texts)


def unwrap_text(
    unwrapping: Unwrapping, spelling: Mapping[str, str], library: Mapping[str, str]
) -> str:
    """`unwrap` and what it needs, on the arrays of a library that has NumPy's functions."""
    template = resources.environment().get_template(_UNWRAP.format(unwrapping.kind))
    numbers = {name: repr(number) for name, number in unwrapping.numbers.items()}
    chain = _chain(unwrapping.chain, spelling) if unwrapping.chain else {}
    about = docstring(_about_unwrap(unwrapping), indent=4)
    return template.render(about=about, **numbers, **chain, **library)


def _about_unwrap(unwrapping: Unwrapping) -> list[str | Sequence[str]]:
    rows = [("q", "(m, ..., n)  the samples on the first axis"), ("returns", "(m, ..., n)")]
    if unwrapping.chain and unwrapping.chain.constants:
        rows.insert(1, ("parameters", "(..., k)"))
    width = max(len(name) for name, _ in rows)
    return [
        "The coordinates along a trajectory, continuous from sample to sample.",
        [f"  {name:<{width}}  {text}" for name, text in rows],
        *unwrapping.remarks,
        "The first sample stays as it is. A sample with NaN is passed over.",
    ]


def _chain(unwrapping: ChainUnwrapping, spelling: Mapping[str, str]) -> dict[str, str | bool]:
    """The pieces of `unwrap` for turns about any axes."""
    lines = [(name, f"samples[..., {place}]") for name, place in unwrapping.samples]
    if unwrapping.used:
        lines.append(("parameters", '_checked("parameters", parameters)'))
    lines += [(name, f"parameters[..., {place}]") for name, place in unwrapping.used]
    lines += unwrapping.lines
    followed = "_followed(angles)"
    before = ""
    if unwrapping.is_triangle:
        before = (
            "angles = _without_poles(angles, base, apart, together)\n    "
            "near, far = (cos_near, sin_near), (cos_far, sin_far)\n    "
            "angles = _nearest(angles, base, near, far)\n    "
        )
    placed = [(f"columns[{place}]", value) for place, value in unwrapping.placed]
    return {
        "signature": "q, parameters" if unwrapping.constants else "q",
        "known": "\n".join(assigned(4, name, spelled(v, spelling)) for name, v in lines),
        "angles": "\n".join(f"        {angle}," for angle in unwrapping.angles),
        "followed": f"{before}{_named(unwrapping.turns)} = {followed}",
        "placed": "\n".join(assigned(4, name, value) for name, value in placed),
        "is_triangle": unwrapping.is_triangle,
    }


def _named(names: Sequence[str]) -> str:
    return f"({names[0]},)" if len(names) == 1 else ", ".join(names)


def components(formulas: Sequence[Formula]) -> tuple[str, ...]:
    """Lines of the table of arguments for what is no vector of the derivation."""
    used = {argument for formula in formulas for argument in formula.arguments}
    lines = []
    if "p" in used:
        lines.append(f'"p": ({_quoted(QUATERNION)}),')
    if "matrix" in used:
        lines.append(f'"matrix": ({_quoted(MATRIX)}),')
    kept = next((formula.kept for formula in formulas if formula.kept), ())
    if kept:
        lines.append(f'"kept": ({_quoted(kept)},),')
    return tuple(lines)


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f'"{name}"' for name in names)


def _texts(formula: Formula) -> Iterator[str]:
    yield from (value for _, value in formula.lines)
    yield from formula.outputs


def _function(formula: Formula, shape: str) -> Function:
    name = formula.name
    block, scalar = f"_{name}", f"{name}_scalar"
    inputs = formula.inputs or ("*components",)
    result = _shape(formula, shape)
    passed = [f"{a}={_GIVEN.get(a, a)}".format(len(formula.kept)) for a in formula.arguments]
    given = ["kept=None" if a == "kept" else a for a in formula.arguments]
    needed = [f"{i}=0.0" if i in formula.kept else i for i in inputs]
    return Function(
        signature=bracketed(0, f"def {name}(", [*given, "*", *OPTIONS], "):"),
        about=docstring(about_formula(formula), indent=4),
        body=bracketed(
            4, "return _apply(", [block, scalar, result, "out", "threads", *passed], ")"
        ),
        scalar_signature=bracketed(0, f"def {scalar}(", needed, "):"),
        scalar_about=f"`{name}` of one orientation; floats to a tuple.",
        scalar_body="\n".join(_body(formula, 8, _FLOATS)),
        exceptional=bracketed(8, "return _exceptional(", [block, result, *inputs], ")"),
        block_signature=bracketed(0, f"def {block}(", inputs, "):"),
        block_body="\n".join(_body(formula, 4, _ARRAYS)),
        ufunc=f'{name}.signature = "{ufunc(formula, shape)}"',
    )


def _shape(formula: Formula, shape: str) -> str:
    return "(4,)" if formula.name == "quaternion" else shape


def ufunc(formula: Formula, shape: str) -> str:
    """The signature as a generalised ufunc; `shape` is that of the coordinates, "(3,)"."""
    counts = {a: f"({len(names) or 'k'})" for a, names in formula.components.items()}
    sizes = counts | {"matrix": "(3,3)", "q": shape.replace(",)", ")")}
    inputs = ",".join(sizes[argument] for argument in formula.arguments)
    return f"{inputs}->({len(formula.outputs)})"


def about_formula(formula: Formula) -> list[str | Sequence[str]]:
    """The paragraphs of a function's docstring."""
    unit = f"  in {formula.unit}" if formula.unit else ""
    result = f"(..., {len(formula.outputs)})"
    shapes = [(a, _SHAPES[a].format(len(formula.kept))) for a in formula.arguments]
    rows = [*shapes, ("returns", result + unit)]
    width = max(len(name) for name, _ in rows)
    return [
        formula.about,
        [f"  {name:<{width}}  {text}" for name, text in rows],
        *formula.remarks,
        "Raises TypeError for a dtype and ValueError for a shape that it cannot take.",
    ]


def _body(formula: Formula, indent: int, spelling: dict[str, str]) -> Iterator[str]:
    if not formula.inputs:
        yield _matrix_line(indent, is_float=spelling is _FLOATS)
    for names, value in formula.lines:
        yield assigned(indent, names, spelled(value, spelling))
    outputs = [spelled(output, spelling) for output in formula.outputs]
    if len(outputs) == 1:
        yield f"{' ' * indent}return ({outputs[0]},)"
    else:
        yield exploded(indent, "return (", outputs, ")")


def _matrix_line(indent: int, *, is_float: bool) -> str:
    """The rotation matrix from the coordinates, by the function that stands beside this one."""
    if is_float:
        rows = ", ".join(f"({', '.join(MATRIX[k : k + 3])})" for k in (0, 3, 6))
        return bracketed(indent, f"{rows} = rotation_matrix_scalar(", ["*components"], ")")
    return bracketed(indent, f"{', '.join(MATRIX)} = _rotation_matrix(", ["*components"], ")")


def spelled(text: str, spelling: Mapping[str, str]) -> str:
    """A line of a formula in the words of a target."""
    return Template(text).substitute(spelling)


def assigned(indent: int, names: str, value: str) -> str:
    """One assignment; what is too wide is a call, and stands with an argument a line."""
    line = f"{' ' * indent}{names} = {value}"
    if len(line) <= WIDTH:
        return line
    if "(" not in value:
        return _broken_sum(indent, names, value)
    head, _, inside = value.partition("(")
    return bracketed(indent, f"{names} = {head}(", _arguments(inside[:-1]), ")")


def _broken_sum(indent: int, names: str, value: str) -> str:
    margin = " " * indent
    terms = re.split(r" (?=[-+] )", value)
    body = "\n".join(f"{margin}    {term}" for term in terms)
    return f"{margin}{names} = (\n{body}\n{margin})"


def _arguments(inside: str) -> list[str]:
    """The arguments of a call, whose own calls may hold commas."""
    found, depth, start = [], 0, 0
    for place, character in enumerate(inside):
        depth += (character == "(") - (character == ")")
        if character == "," and not depth:
            found.append(inside[start:place].strip())
            start = place + 1
    return [*found, inside[start:].strip()]
