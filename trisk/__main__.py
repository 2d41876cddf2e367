"""Run the command line as `python -m trisk`."""

from trisk.main import main

main()
