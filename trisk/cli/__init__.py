"""What the commands of `trisk` do."""
