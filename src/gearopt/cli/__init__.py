"""The command line. Exit codes: 0 solved, 2 bad input, 3 proven infeasible, 4 nothing found."""

import sys

# Importing registers the commands, in the order of --help.
from gearopt.cli import answering  # noqa: F401

# isort: split
from gearopt.cli import files, reporting  # noqa: F401
from gearopt.cli.app import app, told
from gearopt.cli.writing import patient
from gearopt.errors import GearoptError


def run() -> None:
    """Run a command; errors on purpose become a line each and exit code 2.

    A reader that leaves (`gearopt ... | head`) changes neither what is done nor the exit code.
    """
    sys.stdout, sys.stderr = patient(sys.stdout), patient(sys.stderr)
    try:
        try:
            app()
        finally:
            print(end="", flush=True)  # a full disk is reported here, not at the end of Python
    except GearoptError as wrong:
        print(told(wrong), file=sys.stderr)
        sys.exit(2)
