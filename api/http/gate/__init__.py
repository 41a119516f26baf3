"""What every request passes before a route sees it, and every answer on its way out.

Plain ASGI, so that it holds for WebSocket handshakes as well, and costs little.
"""
