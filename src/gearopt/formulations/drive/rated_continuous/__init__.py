"""Real-valued sizes of drives that ratings limit: search, bound, cells."""
