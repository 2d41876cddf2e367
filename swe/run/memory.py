"""Returns memory freed during set-up to the system."""

import ctypes
from contextlib import suppress


def return_freed_memory() -> None:
    """Return freed memory to the system if the C library is GNU's, which otherwise keeps much of it.

    Setting up a run frees many arrays of up to 32 MB, a kilobyte for every cell; the allocator would hold them as long
    as the run lasts.
    """
    with suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)
