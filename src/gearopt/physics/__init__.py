"""The laws of gears, written once in plain numpy text; they know no optimisation."""
