"""A derivation as a module of functions: the way into this folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from rigidsym.errors import KernelError, offer
from rigidsym.kernels.lowering.derivatives import Asked, derivatives_of, read_requests
from rigidsym.kernels.lowering.lower import NO_CONVERSIONS, lower
from rigidsym.kernels.targets import TARGETS, check_options, load, printer
from rigidsym.mechanics.derivation import Derivation
from rigidsym.system.files import write_text
from rigidsym.system.records import Record


class KernelModule(Record, kw_only=True):
    """The functions of one derivation, as the text of one or more files."""

    name: str  # of the derivation
    target: str
    files: Mapping[str, str]  # file name -> text, the main file first

    def __repr__(self) -> str:
        """One line, for a prompt; `source` is the text itself."""
        return f"<KernelModule {self.name}, {self.target}: {', '.join(self.files)}>"

    @property
    def main(self) -> str:
        """The name of the main file: "euler_zxz_intrinsic.py"."""
        return next(iter(self.files))

    @property
    def source(self) -> str:
        """The text of the main file."""
        return self.files[self.main]

    def load(self) -> ModuleType:
        """The functions as a Python module, without writing the files.

        They are kept in the user's cache folder (XDG_CACHE_HOME), so that each source is compiled
        once, and other processes can unpickle the functions. Raises MissingTool or MissingExtra
        if a tool or package is not installed. A name that the module lacks is an AttributeError
        with the nearest one.
        """
        module = load(self.target, self.name, self.files)
        names = vars(module).get("__all__", [n for n in vars(module) if not n.startswith("_")])

        def lacking(name: str) -> Any:  # Python calls it for names that are not there
            raise AttributeError(
                f"{self.main} has no function {name}; {offer(name, names)}; "
                "conversions=True and derivatives=[...] add more",
                name=name,
            )

        vars(module).setdefault("__getattr__", lacking)
        return module

    def write(self, path: str | Path) -> Path:
        """Write the files, each whole or not at all, and return the path of the main one.

        If `path` is a folder, the files keep their names. Otherwise `path` names the main file; if
        that needs other files, a new folder.
        """
        place = Path(path)
        if TARGETS[self.target].stands_alone and not place.is_dir():
            return write_text(place, self.source)
        for name, text in self.files.items():
            write_text(place / name, text)
        return place / self.main


def generate(
    derivation: Derivation,
    target: str = "numpy",
    *,
    conversions: bool = False,
    derivatives: Asked = (),
    **options: str | bool,
) -> KernelModule:
    """The kernels of all quantities of a derivation, for one target.

    1. The printer of the target, with the names that its language reserves.
    2. The derivatives that are asked for, as expressions.
    3. All expressions lowered to kernels: single assignment, shared subexpressions, guards.
    4. The conversions, lowered likewise.
    5. The files, printed.

    `conversions` adds those between the coordinates, the unit quaternion and the matrix,
    `derivatives` those that are asked for: ["rotation_matrix by q"]. `options` are those of
    the target. Raises KernelError for an unknown target, option or derivative, for an expression
    that kernels cannot hold, and if no derived quantity depends on any input.
    """
    check_options(target, options)
    language = printer(target)
    asked = tuple(derivatives_of(derivation, read_requests(derivatives)))
    added = NO_CONVERSIONS
    if conversions:
        from rigidsym.mechanics.conversions.conversions import converted

        added = converted(derivation)
    program = lower(derivation, language.RESERVED, asked, added)
    if not program.kernels:
        derived = ", ".join(step.quantity.name for step in derivation.steps)
        raise KernelError(
            f"{derivation.name}: no function to write, since no quantity depends on an input: "
            f"{derived}; expected kernels = [], or another quantity"
        )
    files = language.render(program, **options)
    return KernelModule(name=program.name, target=target, files=files)
