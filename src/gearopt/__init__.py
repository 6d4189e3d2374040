"""gearopt."""
