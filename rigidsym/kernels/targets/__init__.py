"""The languages that kernels can be printed in: one file each, LANGUAGE.py.

It holds `RESERVED`, the names that no variable may have, and `render(program)`, which gives the
texts of the files by name, the main one first, and takes the `options` of its `Target` by name. It
is imported when the target is asked for. `TARGETS` describes all languages; their templates are in
templates/LANGUAGE/.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from rigidsym.errors import KernelError, MissingExtra, offer


@dataclass(frozen=True, kw_only=True, slots=True)
class Target:
    """One language that kernels are printed in; printing needs nothing, loading may."""

    package: str = ""  # of Python, which the extra of the target's name installs
    is_compiled: bool = False  # by a C compiler, into a Python module
    stands_alone: bool = True  # whether the main file needs no other
    options: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # defaults first

    @property
    def missing(self) -> str:
        """What loading needs and is not installed here; empty if nothing is missing."""
        if self.package and find_spec(self.package) is None:
            return f"the package {self.package}"
        if self.is_compiled:
            from rigidsym.kernels.targets.compiling import missing

            return missing()
        return ""


TARGETS: dict[str, Target] = {  # the default first
    "numpy": Target(),
    "c": Target(
        stands_alone=False, is_compiled=True, options={"lean": ("none", "double", "float")}
    ),
    "javascript": Target(),
    "jax": Target(package="jax"),
    "numba": Target(package="numba"),
}


def check_options(target: str, options: Mapping[str, str | bool]) -> None:
    """Raises KernelError for an unknown target, an option it does not have, or another value."""
    if target not in TARGETS:
        raise KernelError(f"no target {target!r}; {offer(target, TARGETS, listed=True)}")
    known = TARGETS[target].options
    for name, value in options.items():
        if name not in known:
            offered = offer(name, ("conversions", "derivatives", *known))
            raise KernelError(f"{target} has no option {name}; {offered}")
        if value not in known[name]:
            raise KernelError(f"{name}: expected {' or '.join(known[name])}, got {value!r}")


def printer(target: str) -> ModuleType:
    """The printer of a target."""
    return import_module(f"{__name__}.{target}")


def load(target: str, name: str, files: Mapping[str, str]) -> ModuleType:
    """A Python module of the files, the main one first.

    Raises MissingExtra if its package is not installed, and KernelError for JavaScript.
    """
    if TARGETS[target].package and TARGETS[target].missing:
        raise MissingExtra(f"the target {target}", target)
    main = Path(next(iter(files)))
    if main.suffix == ".mjs":
        raise KernelError(f"{main} runs in browsers and in Node, not in Python; write it to a file")
    if main.suffix == ".c":
        from rigidsym.kernels.targets.compiling import build, load_built

        return load_built(f"{name}_c", files, lambda folder: build(folder / main))
    from rigidsym.kernels.loaded import load as load_files

    return load_files(main.stem, files)
