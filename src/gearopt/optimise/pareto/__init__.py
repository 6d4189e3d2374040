"""Pareto fronts of problems with several objectives: found, proven, measured, and picked from."""
