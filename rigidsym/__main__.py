"""`python -m rigidsym` is the command `rigidsym`."""

from rigidsym.commands.cli import main

if __name__ == "__main__":
    main()
