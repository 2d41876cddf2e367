"""What a run leaves on the disk: history, series, record and checkpoints."""
