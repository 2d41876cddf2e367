"""What processes do in agreement: one result, or one error, for all. Only modules that mpi4py is needed for use it."""

from collections.abc import Callable
from typing import cast

from mpi4py import MPI

from swe.parallel.processes import Result

Outcome = tuple[Result | None, Exception | None]
"""What an action returned, and the error that it raised."""


def on_first(communicator: MPI.Intracomm, action: Callable[[], Result]) -> Result:
    """See `swe.parallel.processes.Processes`; result or error go to the others in a message."""
    own = _outcome(action) if communicator.rank == 0 else None
    return _result(communicator.bcast(own), own)


def together(communicator: MPI.Intracomm, action: Callable[[], Result]) -> Result:
    """See `swe.parallel.processes.Processes`; if several raise errors, all raise that of the lowest rank."""
    result, error = own = _outcome(action)
    error = next(filter(None, communicator.allgather(error)), None)
    return _result((result, error), own)


def _outcome(action: Callable[[], Result]) -> Outcome[Result]:
    """What `action` returns, and the error that it raises."""
    try:
        return action(), None
    except Exception as error:
        return None, error


def _result(shared: Outcome[Result], own: Outcome[Result] | None) -> Result:
    """The result that processes share; raises their error, or this one's `own`, which still knows where it arose."""
    result, error = shared
    if error is not None:
        raise (own[1] if own is not None and own[1] is not None else error)
    return cast(Result, result)
