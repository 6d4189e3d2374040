"""The command line. Exit codes: 0 solved, 2 bad input, 3 proven infeasible, 4 nothing found."""

import sys

from typer.main import get_command

# Importing registers the commands.
from gearopt.cli import answering, trading  # noqa: F401

# isort: split
from gearopt.cli import authoring, exporting, machine_commands, materials, reporting  # noqa: F401
from gearopt.cli.app import app, told
from gearopt.cli.names import fill
from gearopt.cli.writing import tolerant_of_closed_pipe
from gearopt.errors import GearoptError

ORDER = (
    "new",
    "solve",
    "rate",
    "explain",
    "pareto",
    "check",
    "compare",
    "report",
    "import_",
    "export",
    "materials",
    "schema",
    "doctor",
    "bench",
)
app.registered_commands.sort(key=lambda c: ORDER.index(getattr(c.callback, "__name__", "")))


def run() -> None:
    """Run a command; errors on purpose become a line each and exit code 2.

    A reader that leaves (`gearopt ... | head`) changes neither what is done nor the exit code.
    """
    sys.stdout, sys.stderr = (
        tolerant_of_closed_pipe(sys.stdout),
        tolerant_of_closed_pipe(sys.stderr),
    )
    try:
        try:
            command = get_command(app)
            if "--help" in sys.argv:
                fill(command)
            command(prog_name="gearopt")
        finally:
            print(end="", flush=True)  # a full disk is reported here, not at the end of Python
    except GearoptError as wrong:
        print(told(wrong), file=sys.stderr)
        sys.exit(2)
