"""Repairs of an impossible problem, sensitivities of a possible one."""
