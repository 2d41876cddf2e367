"""Parallel functions in forked processes, such as those of a `multiprocessing.Pool`."""

import ctypes
import os

import numba


def use_one_thread() -> None:
    """Make parallel functions work in a process that has just been forked, in which they use one thread.

    The threads of the parent do not exist here. GNU's OpenMP would wait for them, and numba ends the process before
    that; a team of one thread waits for nobody. Results do not depend on the number of threads.
    """
    try:
        layer = numba.threading_layer()
    except ValueError:  # nothing ran in parallel before the fork
        return
    if layer == "omp":
        from numba.np.ufunc import omppool  # type: ignore[attr-defined]

        # Tells the layer that it belongs to this process now.
        ctypes.CFUNCTYPE(None, ctypes.c_int)(omppool.launch_threads)(1)
        numba.set_num_threads(1)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=use_one_thread)
