"""The entry point: `gearopt` and `python -m gearopt`."""

import io
import sys


def main() -> None:
    """Run the command line; an interrupt, even while it is still loading, is no traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # an ASCII terminal has no cubic millimetre
    try:
        from gearopt.cli import run

        run()
    except KeyboardInterrupt:
        print("gearopt: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
