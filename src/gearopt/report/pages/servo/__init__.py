"""Sections of the page of a servo train."""
