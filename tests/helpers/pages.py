"""Pages, made once, and the data that they carry."""

from __future__ import annotations

import json
import re
from functools import cache
from typing import Any

import rigidsym as rs
from helpers.elements import odd_model
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.motion import derive
from rigidsym.page.functions import SHOWN
from rigidsym.pipeline import read_file
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system import resources

NAME = "euler_zxz_intrinsic"
LONG = "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5) z(a_6)"  # more turns than a figure has arcs for
CHAINS = (
    "davenport",
    "goldstein",
    "z(phi/2) x(theta) z(psi/3)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
    LONG,
)
OTHERS = (*PARAMETRISATIONS, *CHAINS)


@cache
def motion_of(rotation: str) -> rs.Motion:
    return derive(rotation, only=SHOWN if rotation == LONG else ())


@cache
def page_of(rotation: str) -> str:
    return motion_of(rotation).page()


def shipped() -> dict[str, DerivationSpec]:
    """Every shipped derivation, one rotation each."""
    files = map(read_file, resources.names("derivations", ".toml"))
    return {single.name: single for file in files for single in file.singles()}


def odd_page() -> str:
    """The page of a rotation whose words hold markup."""
    return derive(odd_model()).page()


def carried(page: str) -> dict[str, Any]:
    """The data that the script of a page carries."""
    (data,) = re.findall(r"^const page = (.*);$", page, re.MULTILINE)
    return json.loads(data)


def script_of(page: str) -> str:
    (script,) = re.findall(r'<script type="module">(.*)</script>', page, re.DOTALL)
    return script


def note_in(page: str) -> str:
    """The note of a page, without the buttons that copy."""
    return main_of(re.sub(r'\n?<p class="copy".*?</p>', "", page))


def main_of(html: str) -> str:
    """The note in a file."""
    (main,) = re.findall(r'<main id="content">.*</main>', html, re.DOTALL)
    return main
