"""Strain wave gearing posed as optimisation: shares of the load, design, cutter."""
