"""The tables of a servo file."""
