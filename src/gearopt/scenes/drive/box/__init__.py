"""A drive's box: its gears laid out, described, and what to change where that is impossible."""
