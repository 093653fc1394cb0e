"""The picture of the README: a note beside its live page, from the program's own output.

    python docs/picture.py

needs Chromium, and writes docs/_static/rigidsym.png.
"""

from __future__ import annotations

import subprocess
import sys
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parents[1]))

import rigidsym as rs

PICTURE = Path(__file__).parent / "_static" / "rigidsym.png"
WIDTH, HEIGHT = 1300, 760
MOST_BYTES = 300_000
_SHEET = """<!doctype html><meta charset="utf-8"><style>
body {{ margin: 0; background: #c9ced6; }}
iframe {{
  position: absolute; top: 16px; border: 0; background: white;
  width: 800px; height: 930px; transform: scale(.785); transform-origin: 0 0;
}}
</style>{frames}"""


# What comes before the angular velocity would fill the picture; its section stays the third.
_SHORTER = """<style>
nav, section[aria-labelledby="section-1"], section[aria-labelledby="section-2"] { display: none; }
body { counter-reset: section 2; }
</style></head>"""


def sheet() -> str:
    motion = rs.derive("ZXZ")
    note = motion.note().html().replace("</head>", _SHORTER, 1)
    frames = [
        f'<iframe style="left: {left}px" srcdoc="{escape(html)}"></iframe>'
        for left, html in ((14, note), (658, motion.page()))
    ]
    return _SHEET.format(frames="".join(frames))


def main() -> None:
    with TemporaryDirectory() as folder:
        page = Path(folder) / "sheet.html"
        page.write_text(sheet(), encoding="utf-8")
        chromium = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
        options = [f"--window-size={WIDTH},{HEIGHT}", "--virtual-time-budget=5000"]
        subprocess.run(
            [*chromium, *options, f"--screenshot={PICTURE}", page.as_uri()],
            check=True,
            capture_output=True,
        )
    size = PICTURE.stat().st_size
    if size > MOST_BYTES:
        raise SystemExit(f"{PICTURE}: {size} bytes, at most {MOST_BYTES}")


if __name__ == "__main__":
    main()
