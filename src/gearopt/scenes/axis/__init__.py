"""The parts of a servo axis: its ratio, its train, tolerances, stiffness and box."""
