"""Remedies and sensitivities of all kinds, in the numbers of their files."""
