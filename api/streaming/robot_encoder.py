"""JSON text of the views and events of a robot; unchanged views are not encoded again."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar

from pydantic_core import to_json

from api.http.error_text import error_text
from api.http.part_text import part_text
from api.http.schemas.base import rfc3339, timestamp
from api.http.schemas.devices import DeviceJson, ThisDeviceJson
from api.http.schemas.health import EmergencyStopJson, StreamedSignalJson, SystemStateJson
from api.http.schemas.reactions import ReactionJson
from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson
from domain.actor import Actor
from domain.devices.device_view import DeviceView
from domain.devices.lead_view import LeadView
from domain.events.event import RecordedEvent
from domain.reactions.reaction_view import ReactionView
from domain.snapshot import (
    EmergencyStopView,
    ErrorView,
    HoldView,
    PartView,
    SignalView,
    SystemStateView,
    TaskView,
    VehicleView,
)
from domain.timebase import Instant
from service.storage.event_rows import plain
from service.storage.journal import StoredEvent
from service.supervisor import Supervisor

View = TypeVar("View")


class RobotEncoder:
    """Encodes views and events of one robot, for frames and for samples of a simulation."""

    def __init__(self, supervisor: Supervisor) -> None:
        """Start with empty caches.

        Args:
            supervisor: Provides clock, epoch and vehicle limits.
        """
        self._supervisor = supervisor
        self._clock = clock = supervisor.clock
        since = LatestCache[Instant](lambda at: timestamp(clock, at))
        """Most parts that deviate do so since the same moment, and so their errors."""
        self.parts = MemberCache[PartView](lambda view: part_text(view, since.text))
        self.signals = MemberCache[SignalView](
            lambda view: StreamedSignalJson.of(view, clock).model_dump_json()
        )
        self.errors = MemberCache[ErrorView](lambda view: error_text(view, since.text))
        self.reactions = MemberCache[ReactionView](
            lambda view: ReactionJson.of(view, clock).model_dump_json()
        )
        self.devices = MemberCache[DeviceView](
            lambda view: DeviceJson.of(
                view, supervisor.connection(view.device), clock
            ).model_dump_json()
        )
        self._holds = LatestCache[Mapping[str, HoldView]](self._encode_holds)
        self._moments = LatestCache[Instant](lambda at: timestamp(clock, at))
        """An input and what follows from it are at the same moment."""
        self._actors = LatestCache[Actor](lambda actor: to_json(actor.label).decode())
        self._epoch = to_json(supervisor.epoch).decode()
        self._emergency_stop = LatestCache[EmergencyStopView](
            lambda view: EmergencyStopJson.of(view, clock).model_dump_json()
        )

    def system_state(
        self, view: SystemStateView, seq: int, at: Instant, simulated: Sequence[str]
    ) -> str:
        """Return the system state.

        Args:
            view: The state.
            seq: Number of the frame.
            at: Time of the frame.
            simulated: The simulated pieces of the robot.
        """
        return SystemStateJson.of(view, seq, at, simulated, self._clock).model_dump_json()

    def task(self, view: TaskView | None) -> str:
        """Return a task; `null` for none."""
        return "null" if view is None else TaskJson.of(view, self._clock).model_dump_json()

    def vehicle(self, view: VehicleView) -> str:
        """Return pose, motion and last command of the vehicle."""
        limits = self._supervisor.core.driving.limits
        return VehicleJson.of(view, limits, self._clock).model_dump_json()

    def this_device(self, view: LeadView) -> str:
        """Return which device the service runs on, and whose word counts there."""
        return ThisDeviceJson.of(view, self._clock).model_dump_json()

    def holds(self, views: Mapping[str, HoldView]) -> str:
        """Return the holds by owner; encoded again only for another mapping."""
        return self._holds.text(views)

    def emergency_stop(self, view: EmergencyStopView) -> str:
        """Return the emergency stop; encoded again only for another view."""
        return self._emergency_stop.text(view)

    def event(self, event: RecordedEvent) -> str:
        """Return an `event` frame, which has the same form in `/events` and in simulations."""
        told = event.event
        actor, at = self._actors.text(event.actor), self._moments.text(event.at)
        return _event_text(self._epoch, at, event, actor, told.words, notable=told.notable)

    def stored_event(self, event: StoredEvent) -> str:
        """Return the same frame for an event that was written down."""
        # Of this run the clock knows better: it may have been set since.
        is_of_this_run = event.epoch == self._supervisor.epoch
        at = timestamp(self._clock, event.at) if is_of_this_run else rfc3339(event.wall_at)
        epoch, actor = to_json(event.epoch).decode(), to_json(event.actor).decode()
        return _event_text(epoch, at, event, actor, event.words, notable=event.notable)

    def _encode_holds(self, views: Mapping[str, HoldView]) -> str:
        return to_json(
            {name: HoldJson.of(view, self._clock) for name, view in views.items()}
        ).decode()


class MemberCache(Generic[View]):
    """Members of a JSON object, cached by name; a view is encoded again only if it changed.

    So a frame with 10,000 unchanged parts costs little more than joining strings. Entries are never
    removed, so this is only for names that are fixed by the model or the robot file.
    """

    def __init__(self, encode: Callable[[View], str]) -> None:
        self._encode = encode
        # Two plain dictionaries: a pair for each of 10,000 parts would be looked through by every
        # garbage collection.
        self._views: dict[str, View] = {}
        self._texts: dict[str, bytes] = {}

    def text(self, views: Mapping[Any, View]) -> str:
        """Return the object that holds these members."""
        return f"{{{self.members(views).decode()}}}"

    def members(self, views: Mapping[Any, View]) -> bytes:
        """Return these members without braces, as UTF-8.

        The text of 10,000 parts with one character beyond ASCII would be encoded for 5 ms.
        """
        self.learn(self.new_ones(views.items()))
        return b",".join([self._texts[name] for name in views])

    def new_ones(self, views: Iterable[tuple[str, View]]) -> Iterator[tuple[str, View]]:
        """Yield the members that are new or have changed."""
        known = self._views.get
        for name, view in views:
            if known(name) is not view:
                yield name, view

    def learn(self, views: Iterable[tuple[str, View]]) -> None:
        """Encode members and cache their text."""
        for name, view in views:
            self._views[name] = view
            self._texts[name] = b"%b:%b" % (to_json(name), self._encode(view).encode())


class LatestCache(Generic[View]):
    """Text of one view, cached until another view is encoded."""

    def __init__(self, encode: Callable[[View], str]) -> None:
        self._encode = encode
        self._known: tuple[View, str] | None = None

    def text(self, view: View) -> str:
        """Return the text of a view."""
        if self._known is None or self._known[0] is not view:
            self._known = (view, self._encode(view))
        return self._known[1]


def _event_text(
    epoch: str,
    at: str,
    event: RecordedEvent | StoredEvent,
    actor: str,
    words: str,
    *,
    notable: bool,
) -> str:
    """Return an `event` frame.

    Args:
        epoch: Of its run, as JSON.
        at: When it was, RFC 3339.
        event: The event.
        actor: Label of the actor, as JSON.
        words: What happened.
        notable: Whether a short list shows it.
    """
    cause = "null" if event.cause is None else event.cause
    head = (
        f'{{"type":"event","epoch":{epoch},"id":{event.id},"at":"{at}","kind":"{event.kind}",'
        f'"cause":{cause},"actor":{actor},'
    )
    rest = {"data": event.data, "words": words, "notable": notable}
    # A node may report a parameter that is NaN, which JSON cannot hold.
    return head + to_json(rest, inf_nan_mode="null", fallback=plain).decode()[1:]
