"""What the commands show: bars of progress, tables, and the streams that they go to."""
