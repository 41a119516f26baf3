"""The link to ROS 2: `graph.py` is the port; `link.py` is the only module that imports rclpy."""
