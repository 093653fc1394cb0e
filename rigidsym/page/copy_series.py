"""The functions c_k of n² for what is copied: their table once a page, for all that need it."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import fill

from rigidsym.algebra.series import FIRST_SERIES, series_of, taylor
from rigidsym.kernels.ir import Kernel
from rigidsym.kernels.targets.text import statements
from rigidsym.kernels.targets.text.python_layout import WIDTH
from rigidsym.system import resources

_TEMPLATES = {"python": "page/series.py.jinja", "c": "page/series.c.jinja"}


def orders_of(kernel: Kernel) -> list[int]:
    """The k of the functions c_k that a kernel calls."""
    orders = (call.order for call in statements.calls_of(kernel).values())
    return [order for order in orders if order is not None]


def series_for(kernels: Iterable[Kernel]) -> dict[str, str]:
    """language: text of the functions c_k; empty where no kernel calls them."""
    last = max((order for kernel in kernels for order in orders_of(kernel)), default=-1)
    if last < 0:
        return {}
    rows = [_row(order) for order in range(FIRST_SERIES, max(last, FIRST_SERIES) + 1)]
    environment = resources.environment()
    return {
        language: environment.get_template(template).render(
            rows=[
                {"order": order, "numbers": _wrapped(row)}
                for order, row in enumerate(rows, start=FIRST_SERIES)
            ],
            width=max(map(len, rows)),
        )
        for language, template in _TEMPLATES.items()
    }


def _row(order: int) -> list[float]:
    """The switch, c_{k-2}(0), and the coefficients."""
    series = series_of(order)
    return [float(n) for n in (series.switch, taylor(order - 2)[0], *series.coefficients)]


def _wrapped(numbers: Iterable[float]) -> str:
    margin = " " * 12
    text = ", ".join(map(repr, numbers))
    return fill(text, WIDTH, initial_indent=margin, subsequent_indent=margin)
