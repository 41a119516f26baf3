"""The protocol of `WS /rosbridge`: rosbridge v2 in JSON.

It carries the services and topics of `service.ros.interface`.

The protocol is ROSBRIDGE_PROTOCOL.md of RobotWebTools/rosbridge_suite; the route itself is in
`api/rosbridge/route.py`.
"""
