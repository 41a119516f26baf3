"""The simulated robot: nodes with times and faults, and mock signals, advanced like the core."""
