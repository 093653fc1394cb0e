"""The languages that kernels can be printed in: one folder each.

The folder LANGUAGE/ holds

- `__init__.py` with `TARGET`, which describes the language and what loading its modules needs;
- `printer.py` with `RESERVED`, the names that no variable may have, `render(program)`, which
  gives the texts of the files by name, the main one first, and `load(name, files)`, which makes a
  Python module of them. It is imported when the target is asked for. `render` also takes the
  `options` of its `TARGET` by name.

The folders here are those of the package, their templates are in templates/LANGUAGE/; `register`
adds a folder from anywhere.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Protocol, cast

from rigidsym.errors import KernelError, offer

if TYPE_CHECKING:
    from rigidsym.kernels.ir import Program

_DEFAULT = "numpy"
_REMOVED = {"degrees": "angles are in radians; convert them with np.radians and np.degrees"}


@dataclass(frozen=True, kw_only=True, slots=True)
class Target:
    """One language that kernels are printed in; printing needs nothing, loading may."""

    about: str
    ending: str  # of the main file, after the name of the derivation
    package: str = ""  # of Python, which the extra of the target's name installs
    programs: tuple[str, ...] = ()  # one of these is enough
    stands_alone: bool = True  # whether the main file needs no other
    has_single: bool = True  # whether its functions also compute in single precision
    options: Mapping[str, tuple[str | bool, ...]] = field(default_factory=dict)  # defaults first

    @property
    def missing(self) -> str:
        """What loading needs and is not installed here; empty if nothing is missing."""
        if self.package and find_spec(self.package) is None:
            return f"the package {self.package}"
        if self.programs and not any(map(shutil.which, self.programs)):
            return f"one of {', '.join(self.programs)}"
        return ""


class Printer(Protocol):
    """The contents of a target's printer.py."""

    RESERVED: frozenset[str]

    def render(self, program: Program, **options: str | bool) -> Mapping[str, str]: ...

    def load(self, name: str, files: Mapping[str, str]) -> ModuleType: ...


_KNOWN: dict[str, Target] = {}
TARGETS: Mapping[str, Target] = MappingProxyType(_KNOWN)  # the default first


def register(folder: Path) -> None:
    """Add the language of a folder such as /home/me/fortran, under the folder's name.

    Raises KernelError if there is a target of this name or if the folder is not one of a target.
    """
    name = folder.name
    if name in TARGETS:
        raise KernelError(f"a target named {name} exists already")
    if missing := [f for f in ("__init__.py", "printer.py") if not (folder / f).is_file()]:
        raise KernelError(f"{folder} is not the folder of a target: no {' and no '.join(missing)}")
    spec = spec_from_file_location(
        f"{__name__}.{name}", folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise KernelError(f"{folder / '__init__.py'} cannot be imported")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    if not isinstance(getattr(module, "TARGET", None), Target):
        raise KernelError(f"{folder / '__init__.py'} defines no TARGET of the class Target")
    sys.modules[spec.name] = module
    _KNOWN[name] = module.TARGET


def check_target(target: str) -> None:
    """Raises KernelError, naming the known targets, if this is none of them."""
    if target not in TARGETS:
        raise KernelError(f"no target {target!r}; there is {', '.join(TARGETS)}")


def check_options(target: str, options: Mapping[str, str | bool]) -> None:
    """Raises KernelError for an option that the target does not have, or another value of it."""
    check_target(target)
    known = TARGETS[target].options
    for name, value in options.items():
        if name not in known:
            substitute = _REMOVED.get(name) or offer(name, ("conversions", "derivatives", *known))
            raise KernelError(f"{target} has no option {name}; {substitute}")
        if not any(type(value) is type(each) and value == each for each in known[name]):
            choices = ", ".join(map(repr, known[name]))
            raise KernelError(f"{target}, {name}: expected one of {choices}, got {value!r}")


def printer(target: str) -> Printer:
    """The printer of a target; raises KernelError if there is none of this name."""
    check_target(target)
    return cast(Printer, import_module(f"{__name__}.{target}.printer"))


def _register_shipped() -> None:
    names = (path.parent.name for path in Path(__file__).parent.glob("*/printer.py"))
    for name in sorted(names, key=lambda name: (name != _DEFAULT, name)):
        _KNOWN[name] = import_module(f"{__name__}.{name}").TARGET


_register_shipped()
