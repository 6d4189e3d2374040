"""A pair whose mesh vibrates least over a range of speeds."""
