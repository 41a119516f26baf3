"""Reactions: what sets another target in force than the requested one.

Source: D4.8 of micro-ROS, Annex 3; rules of micro-ROS system_modes.
"""
