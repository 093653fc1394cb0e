"""Pages, made once, and what they carry, spelt by other lines than those of the page itself."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
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
    """Texts to copy, words on poles, and blocks of the note."""
    (data,) = re.findall(r"^const \{ stage, .*?\} = (.*);$", page, re.MULTILINE)
    return json.loads(spelt(json.loads(data)["packed"]))


def spelt(packed: Mapping[str, Any]) -> str:
    """The text that was packed."""
    words = dict(enumerate(packed["words"]))
    for first, second in zip(*[iter(_symbols(packed["rules"]))] * 2, strict=True):
        words[len(words)] = words[first] + words[second]
    return "".join(words[symbol] for symbol in _symbols(packed["symbols"]))


def _symbols(text: str) -> list[int]:
    """A symbol is two digits to the base 92, the first of which is #."""
    digits = [ord(letter) - ord("#") for letter in text]
    return [92 * high + low for high, low in zip(digits[::2], digits[1::2], strict=True)]


def note_in(page: str) -> str:
    """The note of a page as the browser has it after the script, without the buttons that copy."""
    blocks = carried(page)["blocks"]
    whole = re.sub(
        r'<p class="packed" data-packed="(\d+)">.*?</p>', lambda m: blocks[int(m[1])], page
    )
    return main_of(re.sub(r'\n?<p class="copy".*?</p>', "", whole))


def main_of(html: str) -> str:
    """The note in a file; whether a paragraph may be the last of a printed page is all one."""
    (main,) = re.findall(r'<main id="content">.*</main>', html, re.DOTALL)
    return main.replace('<p class="lead">', "<p>")


def copied(page: str, language: str) -> dict[str, str]:
    """label: what a button copies."""
    return {name: texts[language] for name, texts in carried(page)["copies"].items()}
