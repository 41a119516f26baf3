"""What the page shows before it is connected: the frames with which the stream would begin."""

from api.streaming.client_input import TOPICS
from api.streaming.stream_server import StreamServer

_ALL = frozenset(TOPICS)


async def first_frames(server: StreamServer) -> str | None:
    """Return `hello` and the newest complete `state` frame, as a JSON array.

    Returns:
        None if a token is required, since the page itself needs none, or before the first frame.
    """
    if server.access.required:
        return None
    await server.encoder.prepare(_ALL)
    frame = server.supervisor.frames.complete()
    if frame is None:
        return None
    state = server.encoder.frame(frame, 0, _ALL).decode()
    return f"[{server.encoder.hello(_ALL)},{state}]"
