"""Drives of one to several stages: sizing, whole teeth, ratings, layout, all at once."""
