"""The bytes of files that a user names, none of which is read beyond a limit."""

import errno
import os
import stat
from pathlib import Path
from select import select

LARGEST_FILE = 1_000_000  # bytes of a problem file
LARGEST_KEPT = 100_000_000  # bytes of a kept result
PIPE_SECONDS = 10  # that a named pipe may take to bring its first byte
NO_WAIT = getattr(os, "O_NONBLOCK", 0)  # to open a pipe into which nobody writes; not on Windows


def first_bytes(path: str | Path, most: int) -> bytes:
    """Bytes of a file, of one that holds more than `most` bytes the first `most` + 1.

    Pipes and devices count as files. OSError where it cannot be read, or where nothing is written
    into a named pipe for PIPE_SECONDS; ValueError where the name is none.
    """
    begun, parts, left = os.open(path, os.O_RDONLY | NO_WAIT), list[bytes](), most + 1
    with open(begun, "rb", buffering=0) as file:
        if stat.S_ISFIFO(os.fstat(begun).st_mode):
            named = Path(path).resolve().is_fifo()
            if not select([file], [], [], PIPE_SECONDS if named else None)[0]:
                raise OSError(errno.ETIMEDOUT, f"nothing comes from this pipe in {PIPE_SECONDS} s")
        if NO_WAIT:
            os.set_blocking(begun, True)
        while left and (part := file.read(left)):
            parts.append(part)
            left -= len(part)
    return b"".join(parts)
