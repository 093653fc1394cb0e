"""The command `rigidsym`, also as `python -m rigidsym`; an interrupt among imports is caught."""

import sys
from importlib import import_module


def main(entry: str = "main") -> int:
    """Call a function of `rigidsym.commands.cli`; returns its exit code."""
    try:
        return int(getattr(import_module("rigidsym.commands.cli"), entry)())
    except KeyboardInterrupt:
        sys.stderr.write("rigidsym: interrupted\n")
        return 130  # as of a process that SIGINT ends


if __name__ == "__main__":
    sys.exit(main("run"))
