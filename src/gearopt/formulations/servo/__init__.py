"""A servo axis: its ratio, its two-stage train, its box, its tolerances."""
