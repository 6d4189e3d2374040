"""Planetary gear trains: speeds, torques and losses; assembly of their planets."""
