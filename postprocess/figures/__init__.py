"""Maps and figures of runs."""
