"""Waypoint tasks, holds, and the state of the vehicle.

Read `task_planner.py` first. `domain.navigation` follows the path.
"""
