"""Geometry of waypoints: length, curvature, projection of a vehicle, and speed profile."""
