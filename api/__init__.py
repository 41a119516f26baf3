"""The edge: HTTP, WebSocket, JSON and the command line. It decides nothing.

Requests become values of `domain`, are handed to `service`, and what comes back becomes JSON or an
RFC 9457 problem. Only the composition root names concrete adapters.

Read `command_line` first for how a process starts, then `robot_app` and `routes`.
"""
