"""Mathematics as MathML by the printer of the notes, and reference pages made from the code."""

from __future__ import annotations

from html import escape
from typing import Any

import from_code
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from rigidsym.notes.formats.mathml import mathml


def inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext(), node.astext()))
    raise nodes.SkipNode


def display(translator: Any, node: nodes.math_block) -> None:
    latex = node.astext()
    label = f' id="{escape(node["label"])}"' if node.get("label") else ""
    formula = mathml(latex, latex, is_display=True)
    translator.body.append(f'<div class="formula" tabindex="0"{label}>{formula}</div>\n')
    raise nodes.SkipNode


class FromCode(SphinxDirective):
    """`{from-code} NAME`: the Markdown that the function of this name in from_code.py returns."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        text = getattr(from_code, self.arguments[0])()
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (inline, None), (display, None))
    app.add_directive("from-code", FromCode)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
