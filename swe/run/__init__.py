"""The run: simulation, signals, progress and threads."""
