"""What Pilothouse offers to ROS, as plain values: services, and topics in both directions.

Nothing here needs ROS. `service/ros/gateway.py` offers it in a ROS 2 graph, `api/rosbridge` to
WebSocket clients that speak rosbridge.
"""
