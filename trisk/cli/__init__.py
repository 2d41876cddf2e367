"""The commands of `trisk`, one module each; packages are imported when a command needs them."""
