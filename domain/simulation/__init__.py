"""The simulated robot: nodes with durations and faults, a vehicle, and mock signals."""
