"""The services and topics that Pilothouse offers to ROS, as plain values.

Nothing here needs ROS. `service/ros/gateway.py` offers them in a ROS 2 graph, `api/rosbridge` to
WebSocket clients that speak the rosbridge protocol.
"""
