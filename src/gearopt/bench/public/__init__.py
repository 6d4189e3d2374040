"""Public problems with known optima, posed as a user poses a problem of their own."""
