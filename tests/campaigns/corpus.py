"""`rigidsym compare` on public code: `python tests/campaigns/corpus.py --clones DIR`.

`corpus.toml` lists files of public repositories with the lines and kinds of the formulas in them,
as a reader labelled them: blocks of lines with sines, arc tangents or products were picked by a
text search and read. DIR/OWNER/NAME is a clone of a repository; missing ones are cloned from
GitHub. The files are read at the listed commit and never stored here.

A table of recall by kind and by language is printed, every formula that was missed, and every
finding without a label, which a person should look at. The exit code is 1 if a formula is called
wrong that is not labelled so, or if one labelled wrong is called right.

With `--mutations N`, only one file of each repository is read. Its formulas that are recognised as
right are changed N times, each in one place, and compared again: all changes should be found, and
the repair of most named.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from random import Random

import numpy as np
import sympy as sp

from rigidsym.tools.compare.comparison import Comparison, identified
from rigidsym.tools.compare.quantities import evaluated, sample
from rigidsym.tools.compare.search import FormulaInFile, search

CORPUS = Path(__file__).with_name("corpus.toml")
NEAR = 14  # lines between a label and an entry of a finding


@dataclass(frozen=True)
class Label:
    """A formula as a reader sees it."""

    line: int
    kind: str
    is_wrong: bool

    @classmethod
    def of(cls, text: str) -> Label:
        line, kind, *remark = text.split()
        return cls(int(line), kind, remark == ["wrong"])


def files(clones: Path) -> Iterator[tuple[str, str, bytes, list[Label]]]:
    """(repository, path, text, labels) of each file."""
    for repository in tomllib.loads(CORPUS.read_text())["repository"]:
        name, commit = repository["name"], repository["commit"]
        clone = clones / name
        if not clone.exists():
            url = f"https://github.com/{name}"
            command = ["git", "clone", "--quiet", "--filter=blob:none", "--no-checkout", url, clone]
            subprocess.run(command, check=True)
        for path, labels in repository["files"].items():
            show = ["git", "-C", clone, "show", f"{commit}:{path}"]
            text = subprocess.run(show, check=True, capture_output=True).stdout
            yield name, path, text, [Label.of(label) for label in labels]


def findings(path: str, text: bytes) -> list[FormulaInFile]:
    """What `compare` recognises in a file."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / Path(path).name
        copy.write_bytes(text)
        return [each for each in search(copy) if each.comparison is not None]


def distance(label: Label, finding: FormulaInFile) -> int:
    return min(abs(line - label.line) for line in finding.formula.lines)


def fits(label: Label, finding: FormulaInFile) -> bool:
    comparison = finding.comparison
    if comparison is None or distance(label, finding) > NEAR:
        return False
    kind = comparison.found.quantity if comparison.found else ""
    return kind.removesuffix("_body").removesuffix("_space") == label.kind


def matched(
    labels: list[Label], recognised: list[FormulaInFile]
) -> list[tuple[Label, FormulaInFile | None]]:
    """Each label with its finding; of several, pairs that agree first, then the nearest ones."""

    def is_other(i: int, j: int) -> bool:
        comparison = recognised[j].comparison
        return comparison is None or comparison.is_equal == labels[i].is_wrong

    places = ((i, j) for i in range(len(labels)) for j in range(len(recognised)))
    fitting = [(i, j) for i, j in places if fits(labels[i], recognised[j])]
    fitting.sort(key=lambda pair: (is_other(*pair), distance(labels[pair[0]], recognised[pair[1]])))
    pairs: dict[int, int] = {}
    for i, j in fitting:
        if i not in pairs and j not in pairs.values():
            pairs[i] = j
    return [(label, recognised[pairs[i]] if i in pairs else None) for i, label in enumerate(labels)]


def renamed(entry: sp.Expr, names: dict[sp.Expr, sp.Expr], random: Random) -> sp.Expr:
    """An entry with one of its names replaced in one place."""
    if entry in names:
        return names[entry]
    places = [k for k, part in enumerate(entry.args) if part.free_symbols & names.keys()]
    place = random.choice(places)
    part = renamed(entry.args[place], names, random)
    return entry.func(*entry.args[:place], part, *entry.args[place + 1 :])


def mutant(formula: sp.ImmutableMatrix, random: Random) -> tuple[str, sp.ImmutableMatrix]:
    """(kind, formula with one change) of an entry with a name in it, or of two entries."""
    places = list(product(*map(range, formula.shape)))
    place, other = random.sample([p for p in places if formula[p].free_symbols], 2)
    entry, turned = formula[place], {sp.sin: sp.cos, sp.cos: sp.sin}
    term = random.choice(sp.Add.make_args(entry))
    names = sorted(entry.free_symbols, key=str), sorted(formula.free_symbols, key=str)
    exchanged = dict([list(map(random.choice, names))])
    kinds = {"sign": entry - 2 * term, "factor": entry + term}
    kinds["index"] = renamed(entry, exchanged, random)
    for turn in random.sample(
        sorted(entry.atoms(*turned), key=str), 1 if entry.has(*turned) else 0
    ):
        kinds["sine and cosine"] = entry.xreplace({turn: turned[turn.func](*turn.args)})
        kinds["angle"] = entry.xreplace({turn: turn.func(2 * turn.args[0])})
    kind = random.choice([*kinds, "order", *["transpose"] * (formula.rows == formula.cols)])
    changed = formula.T.as_mutable() if kind == "transpose" else formula.as_mutable()
    if kind == "order":
        changed[place], changed[other] = changed[other], changed[place]
    elif kind in kinds:
        changed[place] = kinds[kind]
    return kind, changed.as_immutable()


def are_same(one: sp.MatrixBase, other: sp.MatrixBase) -> bool:
    """Whether two formulas have the same values: first by symbols, else at 20 points."""
    if (one - other).expand().is_zero_matrix:
        return True
    values = [evaluated(each, dict(sample(sp.Matrix([*one, *other])))) for each in (one, other)]
    return bool(np.isclose(*values, rtol=1e-9, equal_nan=True).all())


def mutations(right: list[tuple[str, Comparison]], count: int) -> None:
    """Print how many of so many changes are found, and of how many the repair is named.

    A change that makes a formula equal to another quantity, such as a transpose, needs no repair.
    """
    random, numbers = Random(1775), Counter[str]()
    repositories: dict[str, list[Comparison]] = {}
    for name, comparison in right:
        repositories.setdefault(name, []).append(comparison)
    while numbers["changes"] < count:
        original = random.choice(repositories[random.choice(sorted(repositories))])
        kind, changed = mutant(original.formula, random)
        if are_same(changed, original.formula):
            continue
        comparison = identified(changed, is_in_program=True)
        each = [comparison, *comparison.others]
        is_named = comparison.is_equal or any(
            are_same(one.repairs[-1].formula, original.formula) for one in each if one.repairs
        )
        is_other = comparison.is_reflection or comparison.found is not None
        numbers.update({"changes": 1, "named": is_named, "found": is_other})
        if not is_named:
            print(f"{kind}: {changed.tolist()}: {comparison.text()}", flush=True)
    print(dict(numbers))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clones", type=Path, required=True, metavar="DIR")
    parser.add_argument("--only", default="", metavar="TEXT", help="repositories with this name")
    parser.add_argument("--mutations", type=int, default=0, metavar="N", help="changes to be found")
    options = parser.parse_args()
    known, all_labels = Counter[str](), Counter[str]()
    faults: list[str] = []
    right: list[tuple[str, Comparison]] = []
    names: list[str] = []
    for name, path, text, labels in files(options.clones):
        if options.only not in name or (options.mutations and name in names):
            continue
        names.append(name)
        open_findings = findings(path, text)
        for label, finding in matched(labels, open_findings):
            keys = (label.kind, Path(path).suffix)
            all_labels.update(keys)
            if finding is None:
                print(f"missed: {name} {path}:{label.line} {label.kind}", flush=True)
                continue
            known.update(keys)
            open_findings.remove(finding)
            is_equal = finding.comparison is not None and finding.comparison.is_equal
            if is_equal and finding.comparison:
                right.append((name, finding.comparison))
            if is_equal == label.is_wrong:
                faults.append(f"{name} {path}: {finding}")
        for finding in open_findings:
            comparison = finding.comparison
            print(f"without a label: {name} {path}:{str(finding).partition(':')[2]}", flush=True)
            if comparison and not (comparison.is_equal or comparison.is_reflection):
                faults.append(f"{name} {path}: {finding}")
    mutations(right, options.mutations)
    for key in sorted(all_labels):
        print(f"{key:32} {known[key]:4} of {all_labels[key]:4}")
    total, count = sum(all_labels.values()) // 2, sum(known.values()) // 2
    print(f"recognised {count} of {total} ({count / max(total, 1):.0%})")
    for fault in faults:
        print(f"FAULT: {fault}")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
