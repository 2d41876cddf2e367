"""What commands show: progress bars, tables, and the streams these go to."""
