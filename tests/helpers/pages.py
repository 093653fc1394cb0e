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
from rigidsym.page.functions import OF_THE_FIGURE
from rigidsym.pipeline import motion_of as motion_of_spec, read_file, read_spec
from rigidsym.system import resources

LONG = "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5) z(a_6)"  # more turns than a figure has arcs for
CHAINS = (
    "z(phi) x(theta) [0,b,c](psi)",
    "z(phi/2) x(theta) z(psi/3)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
    LONG,
)
FILES = {
    "passive": '[rotation]\nsequence = "z(heading) y(elevation) x(bank)"\npassive = true',
    "own": """
        [rotation]
        matrix = [["cos(a)", "-sin(a)", "0"], ["sin(a)", "cos(a)", "0"], ["0", "0", "1"]]
        coordinates = ["a"]
        """,
    "top": """
        [rotation]
        sequence = "z(phi) x(theta) z(psi) y(alpha0)"
        [parameters]
        A = { positive = true, about = "a moment", unit = "kg m^2" }
        [body]
        principal_moments = ["A", "A", "2*A"]
        """,
}
OTHERS = (*PARAMETRISATIONS, *CHAINS, *FILES)


@cache
def motion_of(name: str) -> rs.Motion:
    """A rotation, a file of this module, or a shipped derivation."""
    if name in FILES:
        return motion_of_spec(read_spec(FILES[name], source=f"{name}.toml", name=name))
    if name in resources.names("derivations", ".toml"):
        (spec,) = read_file(name).singles()
        return motion_of_spec(spec)
    return derive(name, only=OF_THE_FIGURE if name == LONG else ())


@cache
def page_of(name: str) -> str:
    return motion_of(name).page()


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


def note_in(html: str) -> str:
    """The note in a page or a file, without the buttons that copy."""
    text = re.sub(r'\n?<p class="copy".*?</p>', "", html)
    (main,) = re.findall(r'<main id="content">.*</main>', text, re.DOTALL)
    return main
