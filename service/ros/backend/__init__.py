"""A real robot: nodes, signals and vehicle of a ROS 2 graph.

All modules here use the port in `graph/graph.py` and run without ROS; `graph/link.py` is the only
module of the project that imports rclpy.
"""
