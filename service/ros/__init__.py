"""Pilothouse in a ROS 2 graph: the link, the robot behind it, and what is offered there."""
