"""Spatial branch and bound for smooth text: columns, intervals, linear relaxations, certificate."""
