"""Settings of Sphinx: `sphinx-build -W docs build/docs`; neither it nor readers need a network."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]

from rigidsym.version import __version__  # noqa: E402  (found by the path above)

project = "rigidsym"
author = "the rigidsym authors"
copyright = "2026, the rigidsym authors"
release = version = __version__
language = "en"

extensions = ["myst_parser", "extension"]
myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_theme_options = {"top_of_page_buttons": []}
html_copy_source = html_show_sourcelink = False
html_title = f"rigidsym {version}"
html_extra_path = ["derivation.schema.json"]
if (built := Path(__file__).parents[1] / "build" / "gallery").is_dir():
    html_extra_path.append(str(built))
exclude_patterns = ["_build"]

html_static_path = ["_static"]
html_css_files = ["notes.css"]
html_math_renderer = "mathml"
html_show_sphinx = False
