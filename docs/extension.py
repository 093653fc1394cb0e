"""Mathematics of the pages as MathML, and reference pages made from the code."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import Any

import from_code
from docutils import nodes
from math_core import LatexToMathML
from sphinx.application import Sphinx

_FROM_CODE = re.compile(r"^```\{from-code\} (\w+)\n```$", re.M)

_CONVERTER = LatexToMathML(fancy_error=False)


def mathml(latex: str, *, is_display: bool = False) -> str:
    """One formula, with its LaTeX for readers that do not know MathML."""
    element = _CONVERTER.convert_with_local_state(latex, displaystyle=is_display)
    return str(element).replace("<math", f'<math alttext="{escape(latex)}"', 1)


def inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def display(translator: Any, node: nodes.math_block) -> None:
    latex = node.astext()
    label = f' id="{escape(node["label"])}"' if node.get("label") else ""
    formula = mathml(latex, is_display=True)
    translator.body.append(f'<div class="formula" tabindex="0"{label}>{formula}</div>\n')
    raise nodes.SkipNode


def fill(_app: Sphinx, _page: str, source: list[str]) -> None:
    """Put the Markdown that `from_code.NAME()` returns in place of ```{from-code} NAME."""
    source[0] = _FROM_CODE.sub(lambda match: getattr(from_code, match[1])(), source[0])


_ACCESSIBLE = (  # what the theme leaves out, for readers with a keyboard or a screen reader
    ('<p class="caption" role="heading">', '<p class="caption" role="heading" aria-level="2">'),
    ('<aside class="sidebar-drawer">', '<aside class="sidebar-drawer" aria-label="Site">'),
    ('<aside class="toc-drawer">', '<aside class="toc-drawer" aria-label="On this page">'),
    ('<aside class="toc-drawer no-toc">', '<aside class="toc-drawer no-toc" aria-label="None">'),
    ("<pre>", '<pre tabindex="0">'),
    ('<div class="table-wrapper', '<div tabindex="0" class="table-wrapper'),
    ('<div id="search-results">', '<h1>Search</h1><div id="search-results">'),
)


def complete(app: Sphinx, _error: Exception | None) -> None:
    """Add what axe-core asks for to the pages, but not to the notes of the gallery."""
    for page in Path(app.outdir).rglob("*.html"):
        if "gallery" not in page.relative_to(app.outdir).parts:
            text = page.read_text(encoding="utf-8")
            for found, better in _ACCESSIBLE:
                text = text.replace(found, better)
            page.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    app.connect("source-read", fill)
    app.connect("build-finished", complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
