"""`python -m rigidsym` is the command `rigidsym`."""

import sys

from rigidsym_command import main

if __name__ == "__main__":
    sys.exit(main("run"))
