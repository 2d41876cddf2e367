"""The error stream of the command, for progress and errors."""

from contextlib import suppress
from typing import Any, TextIO


class ErrorOutput:
    """An error stream whose loss (a full disk, a closed pipe or terminal) does not stop the work."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write `text` if possible."""
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream if possible."""
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        """Everything else comes from the stream."""
        return getattr(self._stream, name)
