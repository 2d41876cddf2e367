"""The command line, for the history of the files that commands write."""

import shlex
import sys

from mesh.safe_files import name_in_text


def command_line() -> str:
    """The command line as it was typed, for the history of files."""
    return name_in_text(shlex.join(["trisk", *sys.argv[1:]]))
