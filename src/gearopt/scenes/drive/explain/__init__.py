"""Remedies and sensitivities of a drive, in the numbers of its file; `answers` is the way in."""
