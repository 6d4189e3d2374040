"""The entry point: `gearopt` and `python -m gearopt`."""

import gc
import io
import os
import sys

LOADED = 200_000  # objects between two collections: what is loaded is kept, looking takes time


def main() -> None:
    """Run the command line; an interrupt, even while it is still loading, is no traceback."""
    try:
        import signal

        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, leave)
    except KeyboardInterrupt:
        leave()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # an ASCII terminal has no cubic millimetre
    gc.set_threshold(LOADED)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads cost more
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # sought in all that is installed
    try:
        from gearopt.cli import run

        run()
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is done but the flushing


def leave(*signalled: object) -> None:
    """End at once with one line; an exception could be raised in a callback, printed and lost."""
    try:
        os.write(2, b"gearopt: interrupted\n")
    finally:
        os._exit(130)


if __name__ == "__main__":
    main()
