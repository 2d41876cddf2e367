"""Errors and warnings raised while a simulation is set up and run."""

import signal


class InputError(ValueError):
    """The request for a run is invalid; the message says what is wrong, which value, and what to do."""


SetupError = InputError
"""Its name in earlier versions."""


class SetupWarning(UserWarning):
    """The run as requested is unlikely to do what is wanted; the message suggests a value that would."""


class RunError(RuntimeError):
    """The run itself failed; the message says when, where and why. Output already written stays readable."""


class RunStopped(Exception):  # noqa: N818
    """A run was asked to stop and did so between two steps; the message says when, and where its checkpoint is."""

    def __init__(self, message: str, cause: signal.Signals) -> None:
        super().__init__(message)
        self.signal = cause
