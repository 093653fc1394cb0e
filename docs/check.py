"""What must hold of the built documentation: `python docs/check.py build/docs [--all]`.

Links inside the site lead somewhere, a page has at most 300 kB, axe-core finds no fault, and every
word of the texts is known to hunspell or to `docs/words.txt`. Exits with 1 and prints every fault.
Needs Chromium and hunspell. axe looks at one page of each kind, or at all, which takes minutes.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).parents[1]
MOST_BYTES = 300_000
WIDTH = 1100  # pixels
KINDS = (  # a page of each
    "index",
    "search",
    "tutorials/from_r_to_omega",
    "reference/kernels",
    "reference/rosetta",
    "gallery_solids",
    "literature/bodies",
)
_STYLE = re.compile(r'<link [^>]*href="([^"?]+\.css)[^"]*"[^>]*>')
_SCRIPT = re.compile(r"<script.*?</script>", re.DOTALL)
_SIDEBARS = re.compile(r"<aside.*?</aside>", re.DOTALL)
_NO_PROSE = re.compile(
    r"^```.*?^```|^\$\$.*?^\$\$|`[^`]*`|\$[^$]*\$|<[^>]*>|\]\([^)]*\)|https?://\S+|--?[a-z-]+|\.[a-z]+\b",
    re.DOTALL | re.MULTILINE,
)


class _Page(HTMLParser):
    """The links of a page, and what they may lead to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            if name == "id" or (name == "name" and tag == "a"):
                self.places.add(value or "")


@cache
def page(path: Path) -> _Page:
    return _Page(path)


def pages(site: Path) -> list[Path]:
    """The pages that Sphinx made, without the notes and live pages of the gallery."""
    return [p for p in sorted(site.rglob("*.html")) if "gallery" not in p.relative_to(site).parts]


def broken_links(site: Path) -> Iterator[str]:
    """Links to files or places that are not there."""
    for path in pages(site):
        for link in page(path).links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            if not target.is_file():
                yield f"{path.relative_to(site)}: no file {link}"
            elif target.suffix == ".html" and not has_place(target, unquote(parts.fragment)):
                yield f"{path.relative_to(site)}: no place {link}"


def has_place(path: Path, fragment: str) -> bool:
    return not fragment or fragment in page(path).places


def too_large(site: Path) -> Iterator[str]:
    for path in pages(site):
        if (size := path.stat().st_size) > MOST_BYTES:
            yield f"{path.relative_to(site)}: {size} bytes, at most {MOST_BYTES}"


def inaccessible(site: Path, shown: Sequence[Path]) -> Iterator[str]:
    """What axe-core finds on these pages, with their styles and without scripts."""
    sys.path.insert(0, str(ROOT / "tests"))
    from helpers.browser import chromium

    with TemporaryDirectory() as folder, chromium(Path(folder)) as tab:
        for number, path in enumerate(shown):
            html = self_contained(path)
            html = _SIDEBARS.sub("", html) if number else html  # one look at the sidebar is enough
            file = Path(folder) / "page.html"
            file.write_text(html, encoding="utf-8")
            tab.open(file, WIDTH)
            yield from (f"{path.relative_to(site)}: {fault}" for fault in tab.faults())


def self_contained(path: Path) -> str:
    """A page with its style sheets inside."""

    def style(match: re.Match[str]) -> str:
        sheet = path.parent / match[1]
        return f"<style>{sheet.read_text(encoding='utf-8')}</style>" if sheet.is_file() else ""

    return _SCRIPT.sub("", _STYLE.sub(style, path.read_text(encoding="utf-8")))


def texts() -> list[Path]:
    """What is written by hand for readers."""
    return [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]


def misspelt(files: Iterable[Path]) -> Iterator[str]:
    """Words that neither hunspell nor the word list knows."""
    known = set((ROOT / "docs" / "words.txt").read_text(encoding="utf-8").split())
    for path in files:
        text = _NO_PROSE.sub(" ", path.read_text(encoding="utf-8"))
        found = set(re.findall(r"[^\W\d_]+(?:['’][^\W\d_]+)?", text)) - known
        words = sorted(word for word in found if word[1:] == word[1:].lower())  # not JSON, NumPy
        unknown = set(_unknown(words))
        yield from (f"{path.relative_to(ROOT)}: {word}" for word in words if word in unknown)


def _unknown(words: list[str]) -> list[str]:
    done = subprocess.run(
        ["hunspell", "-l", "-d", "en_US", "-i", "utf-8"],
        input="\n".join(words),
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


def main(site: Path, *, looks_at_all: bool) -> int:
    shown = pages(site) if looks_at_all else [site / f"{name}.html" for name in KINDS]
    checks = [broken_links(site), too_large(site), misspelt(texts())]
    checks += [inaccessible(site, shown[k : k + 8]) for k in range(0, len(shown), 8)]
    faults = [fault for check in checks for fault in check]
    print(*faults, f"{len(faults)} faults on {len(pages(site))} pages", sep="\n")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), looks_at_all="--all" in sys.argv))
