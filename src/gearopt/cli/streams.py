"""Standard output and error whose reader may leave: `gearopt ... | head` is no error."""

import io
from typing import TextIO

from gearopt.errors import GearoptError


class _Patient(io.FileIO):
    """A raw stream that drops what nobody reads; an interface of `io`.

    It has state because a disk that is full is told once: what is written after that is dropped.
    """

    refused = False

    def write(self, data: "io.ReadableBuffer") -> int:  # type: ignore[name-defined]
        """Write; GearoptError where the system refuses, unless it is that the reader has left."""
        if not self.refused:
            try:
                return super().write(data)
            except BrokenPipeError:
                self.refused = True
            except OSError as odd:
                self.refused = True
                raise GearoptError(f"the output cannot be written ({odd.strerror})") from odd
        return memoryview(data).nbytes


def patient(stream: TextIO) -> TextIO:
    """A standard stream that a closed pipe does not disturb; other streams as they are."""
    buffer = getattr(stream, "buffer", None)
    raw = getattr(buffer, "raw", buffer)
    if not isinstance(stream, io.TextIOWrapper) or not isinstance(raw, io.FileIO):
        return stream
    stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(_Patient(raw.fileno(), "wb", closefd=False)),
        encoding=stream.encoding,
        errors=stream.errors,
        line_buffering=stream.line_buffering or stream.write_through,
    )
