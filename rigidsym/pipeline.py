"""The page to read first: how a rotation becomes kernels and notes.

    1. read     a rotation or a derivation file -> DerivationSpec     text, models, spec
    2. derive   DerivationSpec -> Motion, steps with their proofs      mechanics
    3. print    Motion -> Output, the content of each file             kernels, notes, page
    4. write    Output -> files in DIR/NAME/                           commands

Every stage but the last is pure: it reads what it is given and writes nothing, so that `check`
compares the files of an Output with those on disk.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigidsym.errors import BodyError, ModelError, RequestError, SpecError, offer
from rigidsym.mechanics.derivation import Proof
from rigidsym.motion import DEFAULT, Motion, derive
from rigidsym.notes.formats import FORMATS
from rigidsym.notes.formats.record import record
from rigidsym.spec.derivation_spec import PAGE as PAGE, PDF as PDF, DerivationSpec, spec_for
from rigidsym.spec.faults import fault_at
from rigidsym.system import resources
from rigidsym.system.records import NamedTuple

if TYPE_CHECKING:
    from rigidsym.mechanics.conversions.conversions import Conversions


class Output(NamedTuple):
    """One derivation and the text files that are printed from it."""

    spec: DerivationSpec
    motion: Motion
    conversions: Conversions | None  # if they were asked for
    files: Mapping[str, str]  # name -> content, for the folder motion.name; the record comes last
    uncovered: tuple[str, ...] = ()  # quantities that a certificate was asked for, in vain

    @property
    def name(self) -> str:
        return self.motion.name

    @property
    def proofs(self) -> tuple[Proof, ...]:
        """All proofs, including those of the conversions."""
        return (*self.motion.proofs, *(self.conversions.proofs if self.conversions else ()))

    @property
    def record_text(self) -> str:
        return self.files[f"{self.name}.json"]

    def joined_by(self, more: Mapping[str, str]) -> Output:
        """The output with more files, which its record describes as well."""
        data = json.loads(self.record_text)
        files = {name: self.files[name] for name in data["files"]}
        return self._replace(files=_with_record(data, {**files, **more}))


def output_of(spec: DerivationSpec) -> Output:
    """Stages 2 and 3 for the specification of one rotation."""
    motion = motion_of(spec)
    conversions = motion.conversions if spec.conversions else None
    files = _with_record(record(motion, spec.to_data(), conversions), dict(_printed(motion, spec)))
    return Output(spec=spec, motion=motion, conversions=conversions, files=files)


def _with_record(data: Mapping[str, Any], files: Mapping[str, str]) -> dict[str, str]:
    """Files and, last, the record that knows them by their digests."""
    known = {name: digest(text.encode()) for name, text in files.items()}
    content = json.dumps({**data, "files": known}, indent=1, ensure_ascii=False) + "\n"
    return {**files, f"{data['name']}.json": content}


# 1. read


def read(source: str, **options: Any) -> DerivationSpec:
    """A derivation file, by path or shipped name, or else a rotation such as "ZXZ".

    `options` are those of `spec_for`; a derivation file takes none.
    """
    shipped = resources.names("derivations", ".toml")
    if source in shipped or Path(source).suffix in (".toml", ".json"):
        if options:
            raise RequestError(
                f"{source} is a derivation file; expected {', '.join(options)} in the file"
            )
        from rigidsym.spec.derivation_file import read_file  # with all that a file may hold

        return read_file(source)
    try:
        return spec_for(source, **options)
    except ModelError as error:
        if options or not source.isidentifier():
            raise
        near = offer(source, shipped, listed=True)
        raise ModelError(
            f"{error}\nor a derivation file, NAME.toml or a shipped one; {near}"
        ) from None


# 2. derive


def motion_of(spec: DerivationSpec) -> Motion:
    """The derivation of a specification with one rotation."""
    if len(spec.models) != 1:
        raise ModelError(f"{spec.name} has {len(spec.models)} rotations; expected one")
    (model,) = spec.models
    body = integrated(spec).body
    dynamics = spec.dynamics or {}
    motion = derive(model, only=spec.quantities, body=body, theory=spec.theory, **dynamics)
    notation = spec.notation or DEFAULT
    return replace(motion, name=spec.name, title=spec.title or motion.title, notation=notation)


def integrated(spec: DerivationSpec) -> DerivationSpec:
    """The specification with the mass distribution of its body integrated, for all its rotations.

    Raises SpecError, with the key, for an impossible body.
    """
    if spec.body is None:
        return spec
    from rigidsym.mechanics.mass.bodies import rigid_body

    try:
        return replace(spec, body=rigid_body(spec.body))
    except BodyError as error:
        fault = fault_at(("body", *error.place), str(error))
        raise SpecError(spec.source or spec.name, [fault]) from None


# 3. print


def _printed(motion: Motion, spec: DerivationSpec) -> Iterator[tuple[str, str]]:
    """(name, content) of each text file but the record."""
    for target in spec.kernels:
        module = motion.kernels(
            target,
            conversions=spec.conversions,
            derivatives=spec.derivatives,
            **spec.target_options.get(target, {}),
        )
        yield from module.files.items()
    if not spec.note:
        return
    note = motion.note(
        with_kernels="numpy" in spec.kernels, conversions=spec.conversions, style=spec.style
    )
    for ending in FORMATS:
        if ending in spec.note or (ending == "tex" and PDF in spec.note):
            yield f"{spec.name}.{ending}", note.render(ending)
    if PAGE in spec.note:
        from rigidsym.page.print_page import print_page

        yield page_name(spec.name), print_page(motion, note.document)


def digest(content: bytes) -> str:
    """By which a record knows a file."""
    return sha256(content).hexdigest()


def page_name(name: str) -> str:
    """The file of a derivation's page."""
    return f"{name}_{PAGE}.html"
