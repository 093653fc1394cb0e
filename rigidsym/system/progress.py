"""Progress of long work: a bar on standard error, if that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from rigidsym.errors import printable

Progress = Callable[[float], None]  # receives the share done, from 0 to 1
_DRAWING = ContextVar("a bar is drawn", default=False)


def is_drawing() -> bool:
    """Whether a bar is on the terminal now."""
    return _DRAWING.get()


@contextmanager
def bar(label: str) -> Iterator[Progress | None]:
    """A bar while the work goes on; None without a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn

    text = TextColumn("{task.description}", markup=False)
    with _drawn(text, BarColumn(), TaskProgressColumn(), TimeRemainingColumn()) as shown:
        task = shown.add_task(printable(label), total=1.0)
        yield lambda share: shown.update(task, completed=share)


@contextmanager
def counter(total: int) -> Iterator[Callable[[str], None]]:
    """A bar that counts tasks; the function it gives is called with the name of each task."""
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn

    text = TextColumn("{task.description:<28}", markup=False)
    with _drawn(text, BarColumn(), MofNCompleteColumn()) as shown:
        task = shown.add_task("", total=total, completed=-1)
        yield lambda name: shown.update(task, description=name, advance=1)


@contextmanager
def _drawn(*columns: Any) -> Iterator[Any]:
    from rich.console import Console
    from rich.progress import Progress as Bar

    token = _DRAWING.set(True)
    try:
        with Bar(*columns, console=Console(stderr=True), transient=True) as shown:
            yield shown
    finally:
        _DRAWING.reset(token)
