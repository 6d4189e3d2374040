"""The rating of a drive: its tables and checks, gears from tables, rows of the result."""
