"""Results, explanations and comparisons on a terminal."""
