"""`python -m rigidsym` is the command `rigidsym`."""

import sys

from rigidsym.commands.cli import run

if __name__ == "__main__":
    sys.exit(run())
