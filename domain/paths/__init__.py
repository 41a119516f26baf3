"""Waypoints as geometry: length, curvature, where a vehicle is along them, and how fast to go."""
