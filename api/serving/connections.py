"""All connections: how many there may be, who makes room for a new one, and who is too slow."""

import asyncio
import errno
import socket
from collections import OrderedDict
from collections.abc import Callable, Sequence

from api.serving.closings import Closings
from api.serving.intake import Dispensable, Intake

ACCEPTED_PER_TURN = 64
_LOOK_EVERY_S = 1.0
_RETRY_S = 0.1
_OUT_OF_DESCRIPTORS = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)


class Connections:
    """Accepts connections, and closes those that must make room or are too slow.

    When there are as many as there may be, the oldest without a complete request or a token is
    closed for a new one, so that nobody can keep others out by just connecting.
    """

    def __init__(self, most: int, closings: Closings) -> None:
        """Start without connections.

        Args:
            most: Connections at the same time.
            closings: Counts those that are closed.
        """
        self._most = most
        self._closings = closings
        self._open: OrderedDict[Intake, None] = OrderedDict()
        self._tasks: set[asyncio.Task[object]] = set()
        self._timer: asyncio.TimerHandle | None = None
        self._listeners: Sequence[socket.socket] = ()

    def __len__(self) -> int:
        return len(self._open)

    def opened(self, intake: Intake) -> None:
        """Note a new connection."""
        self._open[intake] = None

    def closed(self, intake: Intake) -> None:
        """Note that a connection has ended."""
        self._open.pop(intake, None)

    def start(self, listeners: Sequence[socket.socket], make: Callable[[], Intake]) -> None:
        """Begin to accept.

        Args:
            listeners: Sockets that listen.
            make: Makes the protocol of a connection.
        """
        self._loop = asyncio.get_running_loop()
        self._listeners = listeners
        self._make = make
        for listener in listeners:
            listener.setblocking(False)
            self._loop.add_reader(listener, self._accept, listener)
        self._timer = self._loop.call_later(_LOOK_EVERY_S, self._look)

    def stop(self) -> None:
        """Accept no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        for listener in self._listeners:
            self._loop.remove_reader(listener)
        self._listeners = ()

    def make_room(self) -> bool:
        """Close the oldest connection that may be closed; return whether there was one."""
        for dispensable in (Dispensable.AT_ONCE, Dispensable.IF_NEEDED):
            for intake in self._open:
                if intake.inner.dispensable is dispensable:
                    self._close(intake, "full")
                    return True
        return False

    def _accept(self, listener: socket.socket) -> None:
        for _ in range(ACCEPTED_PER_TURN):
            try:
                client, address = listener.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:
                self._cannot_accept(listener, error)
                return
            if len(self._open) + len(self._tasks) >= self._most and not self.make_room():
                self._closings.note("full", str(address[0]))
                client.close()
                continue
            connecting = self._loop.create_task(self._connect(client))
            self._tasks.add(connecting)
            connecting.add_done_callback(self._tasks.discard)

    async def _connect(self, client: socket.socket) -> None:
        try:
            client.setblocking(False)
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            await self._loop.connect_accepted_socket(self._make, client)
        except OSError:
            # It has gone already.
            client.close()

    def _cannot_accept(self, listener: socket.socket, error: OSError) -> None:
        """Wait a moment instead of trying in each turn, and make room meanwhile."""
        if error.errno in _OUT_OF_DESCRIPTORS:
            self.make_room()
        self._closings.note("full", error.strerror or str(error))
        self._loop.remove_reader(listener)
        self._loop.call_later(_RETRY_S, self._listen_again, listener)

    def _listen_again(self, listener: socket.socket) -> None:
        if listener in self._listeners:
            self._loop.add_reader(listener, self._accept, listener)

    def _look(self) -> None:
        """Close whoever is too slow."""
        now = self._loop.time()
        self._timer = self._loop.call_later(_LOOK_EVERY_S, self._look)
        for intake in tuple(self._open):
            reason = intake.inner.overdue(now)
            if reason is not None:
                self._close(intake, reason)

    def _close(self, intake: Intake, reason: str) -> None:
        peer = intake.raw.get_extra_info("peername")
        self._closings.note(reason, str(peer[0]) if peer else "unknown")
        # Not by `close`, which waits until everything was read.
        self._open.pop(intake, None)
        intake.raw.abort()
