"""What goes wrong in setting up and in running a simulation."""

import signal


class InputError(ValueError):
    """A request for a run is wrong; the message says what, which value and what to do."""


SetupError = InputError
"""The name of earlier versions."""


class SetupWarning(UserWarning):
    """A request for a run will hardly do what is wanted; the message says which value would."""


class RunError(RuntimeError):
    """The run itself failed; the message says when, where and why. What was written before stays readable."""


class RunStopped(Exception):  # noqa: N818
    """A run was asked to stop, and did so between two steps; the message says when, and where its checkpoint is."""

    def __init__(self, message: str, cause: signal.Signals) -> None:
        super().__init__(message)
        self.signal = cause
