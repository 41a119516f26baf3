"""What `WS /rosbridge` speaks: rosbridge v2 in JSON, over what `service.ros.interface` offers.

The protocol is ROSBRIDGE_PROTOCOL.md of RobotWebTools/rosbridge_suite; the route itself is in
`api/rosbridge/route.py`.
"""
