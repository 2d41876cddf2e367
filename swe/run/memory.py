"""Memory that setting up has freed, given back."""

import ctypes
from contextlib import suppress


def return_freed_memory() -> None:
    """Hand freed memory back to the system where the C library is GNU's, which keeps much of it otherwise.

    Setting up a run frees many arrays of up to 32 MB, a kilobyte for every cell; the allocator would hold them as long
    as the run lasts.
    """
    with suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)
