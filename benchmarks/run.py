"""All figures in one run: `python benchmarks/run.py [NAME...] [--json FILE]`.

Without names every benchmark runs. Results go to standard output, progress to standard error.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

# Started as a file, Python looks for modules in this folder alone.
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

if TYPE_CHECKING:
    from benchmarks.measure import Settings
    from benchmarks.report import Report

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs" / "reference"
PAGES = {  # what --docs writes into
    "rosetta": DOCS / "rosetta.md",
    "kernels": DOCS / "measured.md",
    "sizes": ROOT / "README.md",
}
NAMES = (
    "derivation",
    "form",
    "cold_start",
    "kernels",
    "sizes",
    "accuracy",
    "bounds",
    "motion",
    "rosetta",
    "certificates",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the chosen benchmarks and print each as soon as it is done."""
    from benchmarks.measure import Settings
    from benchmarks.report import machine, summary

    given = _parser().parse_args(arguments)
    print("  ".join(f"{name} {value}" for name, value in machine().items()), flush=True)
    settings = Settings(given.repeats, given.size, given.samples, given.fresh)
    reports = {}
    for name in given.names or NAMES:
        reports[name] = run(name, settings)
        print(f"\n\n{reports[name].text()}", flush=True)
    if len(reports) > 1:
        print(f"\n\n{summary(reports)}")
    if given.docs:
        for name, report in reports.items():
            if report.documented is not None:
                write_table(PAGES[name], name, report.documented.markdown())
    if given.json:
        plain = {name: asdict(report) for name, report in reports.items()}
        whole = {"schema": 1, "machine": machine(), "benchmarks": plain}
        given.json.write_text(json.dumps(whole, indent=1, ensure_ascii=False) + "\n", "utf-8")
    return 0


def write_table(path: Path, name: str, text: str) -> None:
    """Put a table between the marks of a benchmark; raises ValueError where there are none."""
    marks = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    before, begin, rest = path.read_text(encoding="utf-8").partition(marks[0])
    _, end, after = rest.partition(marks[1])
    if not (begin and end):
        raise ValueError(f"{path}: no lines {marks[0].strip()} and {marks[1].strip()}")
    path.write_text(f"{before}{begin}{text}{end}{after}", encoding="utf-8")


def run(name: str, settings: Settings) -> Report:
    """One benchmark by name; imported here, so that one needs not what another needs."""
    module, _, function = {"sizes": "kernels.sizes"}.get(name, f"{name}.run").partition(".")
    report: Report = getattr(import_module(f"benchmarks.{module}"), function)(settings)
    return report


def _parser() -> argparse.ArgumentParser:
    from benchmarks.measure import Settings

    usual = Settings()
    parser = argparse.ArgumentParser(prog="benchmarks/run.py", description=__doc__)
    parser.add_argument("names", nargs="*", type=_name, metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the results there too")
    for option, default, about in (
        ("--repeats", None, "of each measurement, instead of its own number"),
        ("--size", None, "orientations in the largest batch of the kernels, likewise"),
        ("--samples", usual.samples, "orientations of each kind whose errors are taken"),
    ):
        parser.add_argument(option, type=_count, default=default, metavar="N", help=about)
    parser.add_argument(
        "--docs", action="store_true", help="put the tables into README.md and docs/reference"
    )
    parser.add_argument("--fresh", action="store_true", help="survey SymPy's forms anew (minutes)")
    return parser


def _name(text: str) -> str:
    if text not in NAMES:
        raise argparse.ArgumentTypeError(f"{text!r} is not one of {', '.join(NAMES)}")
    return text


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number above zero")
    return int(text)


if __name__ == "__main__":
    sys.exit(main())
