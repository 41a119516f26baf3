"""A real robot: nodes, signals and vehicle of a ROS 2 graph.

`link.py` is the only module of the project that imports rclpy; all others here talk to the port in
`graph.py`, and run without ROS.
"""
