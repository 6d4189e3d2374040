"""The tables of a drive file."""
