"""What goes wrong in setting up and in running a simulation."""


class SetupError(ValueError):
    """A request for a run is wrong; the message says what, which value and what to do."""


class RunError(RuntimeError):
    """The run itself failed; the message says when, where and why. What was written before stays readable."""
