"""The link over zenoh, between peers without a broker; the only module that imports it.

What zenoh calls back, on threads of its own, only hands messages over: to declare or to publish
there would freeze the interpreter. What is sent goes out on the event loop's thread, which takes a
few microseconds, and 0.1 ms at most where a computer takes nothing; only what is long has a thread.
Nothing is sent again by us: what the connection does not carry is dropped and counted.
"""

import asyncio
import json
import logging
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import count

import zenoh
from zenoh.handlers import Callback

from domain.computers import SUPERVISOR, ComputerName
from service.call_thread import CallThread
from service.link.certificates import Certificates, check_certificates
from service.link.endpoints import Endpoints
from service.link.intake import Intake
from service.link.long_messages import LongMessages
from service.link.port import MAX_MESSAGE_BYTES, DeliverMessage, LinkCounts
from service.link.zenoh_settings import (
    BEAT,
    MESSAGE,
    at_any_port,
    check_endpoints,
    configuration,
    key,
    looking_at,
    over_tls,
)

_AGAIN_S = 1.0
"""Between two attempts to listen."""
_CLOSE_S = 3.0
_WATCH_S = 1.0
_TWICE_S = 1.0
"""Who was heard in a newer session so lately is not heard in an older one as well."""
_GIVE_UP_S = 5.0
"""After so long without a word of the supervisor a new session is opened; zenoh takes less to
connect again, if it does."""

_log = logging.getLogger(__name__)


class ZenohLink:
    """A `Link` over zenoh."""

    def __init__(
        self,
        name: ComputerName,
        others: Sequence[ComputerName],
        endpoints: Endpoints,
        certificates: Certificates | None = None,
        *,
        insecure: bool = False,
    ) -> None:
        """Prepare; nothing is opened before `run`.

        Args:
            name: Of this computer.
            others: All other computers of the robot.
            endpoints: Where it listens, and where it finds others.
            certificates: By which the computers know each other; None: by what they say.
            insecure: Whether to do without certificates in a network.

        Raises:
            InvalidValueError: Somebody else could speak on the link, or the certificates are not
                good.
        """
        check_endpoints(endpoints, certificates, insecure=insecure)
        if certificates is not None:
            check_certificates(certificates, name)
        self._name = name
        self._others = tuple(others)
        self._endpoints = endpoints
        self._configuration = configuration(name, others, endpoints, certificates)
        self._intake = Intake(others, time.monotonic)
        self._sessions: tuple[_Session, ...] = ()
        """One, or two for a while; the newest one last. Also read on threads of zenoh."""
        self._opened: list[_Session] = []
        """All that are not closed."""
        self._numbers = count()
        self._takes_tls = False
        self._unsent = 0

    async def run(self, deliver: DeliverMessage) -> None:
        """Deliver messages until cancelled; a port that is not free is tried again for ever."""
        self._intake.open(deliver)
        thread = CallThread("zenoh")
        try:
            self._sessions = (await self._open(thread, self._open_first),)
            while True:
                await asyncio.sleep(_WATCH_S)
                if self._name != SUPERVISOR and self._endpoints.connect:
                    await self._watch(thread)
        finally:
            self._sessions = ()
            self._intake.close()
            # In the thread, so that what is being opened meanwhile is closed as well.
            closing = thread.run(self._close_all)
            thread.end()
            await asyncio.wait((closing,), timeout=_CLOSE_S)

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Send a message, and return at once."""
        if to not in self._others or len(message) > MAX_MESSAGE_BYTES:
            self._unsent += 1
            return
        heard = [session for session in self._sessions if to in session.heard]
        # Where it was heard last; who was not heard yet may be at the other end of any.
        chosen = [max(heard, key=lambda one: one.heard[to])] if heard else self._sessions
        for session in chosen:
            self._unsent += not session.send(to, message, may_be_lost=may_be_lost)

    def counts(self) -> LinkCounts:
        """Return what was dropped since the link was made."""
        counts = self._intake.counts()
        return LinkCounts(counts.received, counts.unknown, self._unsent)

    # --- sessions --------------------------------------------------------------------------------

    async def _open(self, thread: CallThread, open_one: "Callable[[], _Session]") -> "_Session":
        told = ""
        while True:
            try:
                return await thread.run(open_one)
            except zenoh.ZError as error:
                if str(error) != told:
                    told = str(error)
                    listening = ", ".join(self._endpoints.listen)
                    _log.error("link: cannot listen at %s: %s", listening, error)
            await asyncio.sleep(_AGAIN_S)

    async def _watch(self, thread: CallThread) -> None:
        """Open a new session where zenoh may have ceased to look for the supervisor.

        It does so for ever when a connection is lost in the very moment in which it was made, as
        happens where packets are lost. The session before is kept while anybody is heard in it
        alone: so devices hear each other also while the supervisor is down.
        """
        now, newest = time.monotonic(), self._sessions[-1]
        self._keep(one for one in self._sessions if one is newest or one.is_used(now))
        if now - newest.heard.get(SUPERVISOR, newest.opened_at) < _GIVE_UP_S:
            return
        self._keep((newest,) if newest.is_used(now) else self._sessions[:-1])
        self._sessions += (await self._open(thread, self._open_again),)

    def _keep(self, kept: "Iterable[_Session]") -> None:
        """Close all sessions but these."""
        before, self._sessions = self._sessions, tuple(kept)
        for session in before:
            if session not in self._sessions:
                self._opened.remove(session)
                # In a thread of its own: where packets are lost, it takes 10 s.
                threading.Thread(target=session.close, name="closing zenoh", daemon=True).start()

    def _open_first(self) -> "_Session":
        return self._open_with(self._configuration)

    def _open_again(self) -> "_Session":
        """Open one more session; at another port, if the one before still has that.

        It takes TLS in place of QUIC, and the one after it QUIC again: one connection of QUIC that
        is not completed keeps zenoh from accepting any other for half a minute (zenoh#2719).
        """
        self._takes_tls = not self._takes_tls
        configured = dict(self._configuration)
        if self._takes_tls:
            configured["connect"] = looking_at(map(over_tls, self._endpoints.connect))
        try:
            return self._open_with(configured)
        except zenoh.ZError:
            configured["listen"] = {"endpoints": [*map(at_any_port, self._endpoints.listen)]}
            return self._open_with(configured)

    def _open_with(self, configured: Mapping[str, object]) -> "_Session":
        opened = zenoh.open(zenoh.Config.from_json5(json.dumps(configured)))
        session = _Session(opened, next(self._numbers))
        self._opened.append(session)
        session.declare(self._name, self._others, self._take_in)
        return session

    def _close_all(self) -> None:
        for session in self._opened:
            session.close()
        self._opened.clear()

    def _take_in(
        self, session: "_Session", sender: ComputerName, message: bytes, *, may_be_lost: bool
    ) -> None:
        """Take a message in, unless it comes in a newer session, too; on threads of zenoh."""
        now = session.heard[sender] = time.monotonic()
        for newer in self._sessions:
            if newer.number > session.number and now - newer.heard.get(sender, 0.0) < _TWICE_S:
                return
        session.used_at = now
        self._intake.take_in(sender, message, may_be_lost=may_be_lost)


class _Session:
    """An open session of zenoh."""

    def __init__(self, session: zenoh.Session, number: int) -> None:
        self.number = number
        """Of a newer one it is higher."""
        self.opened_at = time.monotonic()
        self.heard: dict[ComputerName, float] = {}
        """When each computer was heard in this session."""
        self.used_at = 0.0
        """When a message of it was taken in."""
        self._session = session
        self._beats: dict[ComputerName, zenoh.Publisher] = {}
        self._messages: dict[ComputerName, zenoh.Publisher] = {}
        self._long = LongMessages(lambda to, message: _put(self._messages[to], message))

    def declare(
        self, name: ComputerName, others: Sequence[ComputerName], take_in: Callable[..., None]
    ) -> None:
        """Say what is received and what is sent; `take_in` is called on threads of zenoh."""
        for other in others:
            self._beats[other] = self._publisher(key(other, name, BEAT), is_beat=True)
            self._messages[other] = self._publisher(key(other, name, MESSAGE), is_beat=False)
            for kind in (BEAT, MESSAGE):
                expected = key(name, other, kind)
                take = partial(take_in, self, other, may_be_lost=kind == BEAT)
                # Direct: with a thread in between, what waits for it would have no bound, and it
                # would keep the process from ending.
                handler = Callback(partial(_hand_over, expected, take), indirect=False)
                self._session.declare_subscriber(expected, handler)

    def is_used(self, now: float) -> bool:
        """Tell whether anybody was heard in this session alone, not long ago."""
        return now - self.used_at < _GIVE_UP_S

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> bool:
        """Send a message; False: it was dropped."""
        if may_be_lost:
            return _put(self._beats[to], message)
        if self._long.concern(to, message):
            return self._long.send(to, message)
        return _put(self._messages[to], message)

    def close(self) -> None:
        """Close the session; what cannot be told to the others any more is left."""
        self._long.end()
        with suppress(zenoh.ZError):
            self._session.close()  # type: ignore[no-untyped-call]

    def _publisher(self, key_expression: str, *, is_beat: bool) -> zenoh.Publisher:
        reliability = zenoh.Reliability
        return self._session.declare_publisher(
            key_expression,
            congestion_control=zenoh.CongestionControl.DROP,
            # Not express: each message would take a place of its own in a queue of few.
            express=False,
            priority=zenoh.Priority.REAL_TIME if is_beat else zenoh.Priority.DATA,
            reliability=reliability.BEST_EFFORT if is_beat else reliability.RELIABLE,
        )


def _put(publisher: zenoh.Publisher, message: bytes) -> bool:
    """Publish; False: the session is closed."""
    try:
        publisher.put(message)
    except zenoh.ZError:
        return False
    return True


def _hand_over(key_expression: str, take: Callable[[bytes], None], sample: zenoh.Sample) -> None:
    """Take a message in; called on a thread of zenoh.

    One whose key has a wildcard would count as one of every sender.
    """
    if str(sample.key_expr) == key_expression:
        take(sample.payload.to_bytes())
