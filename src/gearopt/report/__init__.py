"""Results for people: the terminal now."""
