"""The command line. Exit codes: 0 solved, 2 bad input, 3 proven infeasible, 4 nothing found."""

import sys

# Importing registers the commands, in the order of --help.
from gearopt.cli import solving  # noqa: F401

# isort: split
from gearopt.cli import explaining  # noqa: F401

# isort: split
from gearopt.cli import comparing, files, machine, reporting  # noqa: F401
from gearopt.cli.app import app
from gearopt.errors import GearoptError


def run() -> None:
    """Run a command; errors on purpose become one message and exit code 2."""
    try:
        app()
    except GearoptError as wrong:
        print(f"gearopt: {wrong}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:  # `gearopt ... | head`
        sys.stderr.close()
        sys.exit(0)
