"""A decorator that makes a function its own test."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rigidsym.motion import Motion
from rigidsym.tools.compare.comparison import compare


def checked(
    rotation: str | Motion, quantity: str
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Compare a function with a quantity of a rotation whenever it is called without arguments.

        @rigidsym.checked("ZYX", "rate_matrix_body")
        def test_rate_matrix(q): ...

    pytest calls tests without arguments; with arguments the function computes as before. A
    function that takes SymPy symbols is proved, another one is compared at random points.
    The comparison raises AssertionError, which says what is wrong.
    """

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        def test(*arguments: Any, **options: Any) -> Any:
            if arguments or options:
                return function(*arguments, **options)
            found = compare(function, rotation, quantity)
            if not found.is_equal:
                raise AssertionError(f"{function.__name__} is {found.text()}")
            return None

        test.__name__, test.__doc__ = function.__name__, function.__doc__
        test.__module__, test.__qualname__ = function.__module__, function.__qualname__
        return test

    return decorate
