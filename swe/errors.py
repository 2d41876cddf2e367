"""What goes wrong in setting up and in running a simulation."""

import signal


class SetupError(ValueError):
    """A request for a run is wrong; the message says what, which value and what to do."""


class SetupWarning(UserWarning):
    """A request for a run will hardly do what is wanted; the message says which value would."""


class RunError(RuntimeError):
    """The run itself failed; the message says when, where and why. What was written before stays readable."""


class RunStopped(KeyboardInterrupt):
    """A run was asked to stop, and did so after a step; the message says when, and whether it can go on."""

    def __init__(self, message: str, cause: signal.Signals) -> None:
        super().__init__(message)
        self.signal = cause
