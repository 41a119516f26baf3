"""Waypoint tasks: what is driven, what holds it, and where the vehicle is.

Read `task_planner.py` first. Following a path is the work of `domain.navigation`.
"""
