"""Three computers of a robot press, release, forget and lose each other in any order.

The robot is stopped on each computer exactly while a stop is engaged there, or was when another one
was heard last; and nothing ends a stop but a release that names it. `make soak` runs 10,000
sequences, `make test` 100.
"""

import os
from collections import deque
from collections.abc import Collection

import hypothesis.strategies as st
from hypothesis import settings
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from domain.commands import AskRelease, Command, TellStops
from domain.computers import SUPERVISOR, ComputerName, DeviceState, PeerStop, StopId
from domain.inputs import DeviceStatus
from domain.kept import Kept
from tests.support.stopped_robot import ARM, BASE, Robot

NAMES = (SUPERVISOR, ARM, BASE)
COMPUTERS = st.sampled_from(NAMES)
PAIRS = st.sampled_from([(one, other) for one in NAMES for other in NAMES if one != other])
AWAY = (DeviceState.LOST, DeviceState.CONFLICT, DeviceState.NEVER_SEEN)

Store = tuple[tuple[Kept, ...], int]
"""What is kept, and the id of the next event."""


class Computers(RuleBasedStateMachine):
    """Three computers, and what is on its way between each two of them."""

    def __init__(self) -> None:
        super().__init__()
        self.now = 0
        self.runs = 0
        self.robots: dict[ComputerName, Robot] = {}
        self.own: dict[ComputerName, StopId | None] = dict.fromkeys(NAMES)
        """The stop that each computer has."""
        self.known: dict[tuple[ComputerName, ComputerName], set[StopId]] = {}
        """By a computer and another one, the stops of that as it was heard last."""
        self.sets: dict[tuple[ComputerName, ComputerName], deque[tuple[PeerStop, ...]]] = {}
        """By sender and receiver, sets of stops on their way."""
        self.asks: dict[tuple[ComputerName, ComputerName], deque[tuple[StopId, ...]]] = {}
        self.away: set[tuple[ComputerName, ComputerName]] = set()
        """By a computer and another one that it cannot hear."""
        self.stores: dict[ComputerName, list[Store]] = {name: [((), 1)] for name in NAMES}
        self.ever: set[StopId] = set()
        for one in NAMES:
            for other in NAMES:
                if one != other:
                    self.known[one, other] = set()
                    self.sets[one, other], self.asks[one, other] = deque(), deque()
        for name in NAMES:
            self._start(name, self.stores[name][0])

    # --- what people do --------------------------------------------------------------------------

    @rule(name=COMPUTERS, by=st.sampled_from(["ada", "bert"]))
    def press(self, name: ComputerName, by: str) -> None:
        had = self.own[name]
        self.robots[name].engage(by, "", self._later())
        self._send(name)
        self.own[name] = self._shown_own(name)
        assert self.own[name] is not None
        if had is not None:
            assert self.own[name] == had, "a repetition keeps the first"
            return
        assert self.own[name] not in self.ever, "an id is used once"
        self.ever.add(StopId(str(self.own[name])))

    @rule(name=COMPUTERS)
    def release_all(self, name: ComputerName) -> None:
        self._release(name, None)

    @precondition(lambda self: self.ever)
    @rule(name=COMPUTERS, data=st.data())
    def release_some(self, name: ComputerName, data: st.DataObject) -> None:
        ids = data.draw(st.lists(st.sampled_from(sorted(self.ever)), unique=True))
        self._release(name, tuple(ids))

    def _release(self, name: ComputerName, named: tuple[StopId, ...] | None) -> None:
        self.robots[name].release_named("cleo", "", self._later(), named)
        own = self.own[name]
        if own is not None and (named is None or own in named):
            self.own[name] = None
        asked = self._send(name)
        expected = {
            other: ids
            for other in NAMES
            if other != name and (name, other) not in self.away
            if (ids := self._named(self.known[name, other], named))
        }
        assert asked == expected, "only who can be heard is asked, and only for what was seen"

    def _named(
        self, stops: Collection[StopId], named: Collection[StopId] | None
    ) -> Collection[StopId]:
        return {stop for stop in stops if named is None or stop in named}

    # --- what is heard ---------------------------------------------------------------------------

    @rule(pair=PAIRS, skipped=st.integers(0, 3))
    def hear_stops(self, pair: tuple[ComputerName, ComputerName], skipped: int) -> None:
        """Hear which stops the first has on the second; a later message makes up for lost ones."""
        waiting, (sender, receiver) = self.sets[pair], pair
        while skipped and len(waiting) > 1:
            waiting.popleft()
            skipped -= 1
        if waiting:
            stops = waiting.popleft()
            self.robots[receiver].hear(sender, self._later(), *stops)
            self.known[receiver, sender] = {stop.id for stop in stops}
            self._send(receiver)

    @rule(pair=PAIRS, number=st.integers(0, 3), engaged=st.booleans())
    def hear_an_impostor(
        self, pair: tuple[ComputerName, ComputerName], number: int, *, engaged: bool
    ) -> None:
        """Hear on the second a stop of somebody who says that it is the first, or its end."""
        sender, receiver = pair
        stop = PeerStop(StopId(f"impostor-{number}"), "mallory", "", 0)
        stops, ended = ((stop,), ()) if engaged else ((), (stop.id,))
        self.robots[receiver].hear(sender, self._later(), *stops, ended=ended)
        known = self.known[receiver, sender]
        (known.add if engaged else known.discard)(stop.id)
        self._send(receiver)

    @rule(pair=PAIRS, twice=st.booleans(), lost=st.booleans())
    def hear_release(
        self, pair: tuple[ComputerName, ComputerName], *, twice: bool, lost: bool
    ) -> None:
        waiting, (sender, receiver) = self.asks[pair], pair
        if not waiting:
            return
        ids = waiting[0] if twice else waiting.popleft()
        if lost:
            return
        self.robots[receiver].hear_release(sender, self._later(), *ids)
        if self.own[receiver] in ids:
            self.own[receiver] = None
        self._send(receiver)

    @rule(pair=PAIRS, state=st.sampled_from(DeviceState))
    def notice(self, pair: tuple[ComputerName, ComputerName], state: DeviceState) -> None:
        """Notice on the first how the connection to the second is."""
        name, other = pair
        self.robots[name].connect(DeviceStatus(other, state), self._later())
        (self.away.add if state in AWAY else self.away.discard)(pair)
        if state in AWAY:
            self.asks[pair].clear()

    # --- what goes wrong -------------------------------------------------------------------------

    @rule(name=COMPUTERS, data=st.data())
    def restart(self, name: ComputerName, data: st.DataObject) -> None:
        """Start a computer again, maybe with an old store or with none."""
        self._start(name, data.draw(st.sampled_from(self.stores[name])))

    def _start(self, name: ComputerName, store: Store) -> None:
        others = tuple(other for other in NAMES if other != name)
        for pair in self.asks:
            # The link takes nothing of an earlier run, and nothing that was meant for one.
            if name in pair:
                self.asks[pair].clear()
            if pair[0] == name:
                self.sets[pair].clear()
        self.runs += 1
        robot = self.robots[name] = Robot(self._later(), others)
        robot.restore(*store[0], run=f"run{self.runs}", next_event=store[1])
        self._send(name)
        self.own[name] = self._shown_own(name)
        for other in others:
            view = robot.stop.view().stops
            self.known[name, other] = {stop.id for stop in view if stop.computer == other}
            # Until something is heard, nobody can be.
            self.away.add((name, other))
            robot.connect(DeviceStatus(other, DeviceState.NEVER_SEEN), self.now)

    @rule(name=COMPUTERS)
    def crash(self, name: ComputerName) -> None:
        """Start a computer again with what it kept last: it forgets no stop."""
        before = {stop.id for stop in self.robots[name].stop.view().stops}
        self._start(name, self.stores[name][-1])
        assert {stop.id for stop in self.robots[name].stop.view().stops} == before

    # --- what is so at any time ------------------------------------------------------------------

    @invariant()
    def a_computer_shows_what_it_has_and_what_it_heard(self) -> None:
        for name, robot in self.robots.items():
            view = robot.stop.view()
            own = {self.own[name]} - {None}
            others = {other: self.known[name, other] for other in NAMES if other != name}
            assert {stop.id for stop in view.stops if stop.computer is None} == own
            for other, ids in others.items():
                assert {stop.id for stop in view.stops if stop.computer == other} == ids
            assert view.engaged is bool(own or any(others.values()))
            assert not view.engaged or robot.health.is_stopped
            away = {other for one, other in self.away if one == name}
            assert set(view.not_heard) == (away if view.engaged else set())
            assert not set(view.waits_for) & away
            assert list(view.stops) == sorted(view.stops, key=lambda stop: stop.since)

    # --- inside ----------------------------------------------------------------------------------

    def _later(self) -> int:
        self.now += 10**9
        return self.now

    def _shown_own(self, name: ComputerName) -> StopId | None:
        view = self.robots[name].stop.view()
        return next((stop.id for stop in view.stops if stop.computer is None), None)

    def _send(self, name: ComputerName) -> dict[ComputerName, set[StopId]]:
        """Put on its way what a computer tells the others; return what it asks them to release."""
        robot = self.robots[name]
        commands: list[Command] = robot.commands
        asked = dict[ComputerName, set[StopId]]()
        for command in commands:
            if isinstance(command, TellStops):
                for other in NAMES:
                    if other != name:
                        self.sets[name, other].append(command.stops)
            else:
                assert isinstance(command, AskRelease)
                asked[command.computer] = set(command.stops)
                self.asks[name, command.computer].append(command.stops)
        self.stores[name].append((tuple(robot.store.values()), robot.outbox.next_event))
        del self.stores[name][:-4]
        return asked


SOAK = bool(os.environ.get("PILOTHOUSE_SOAK"))
Computers.TestCase.settings = settings(
    max_examples=10_000 if SOAK else 100, stateful_step_count=30, deadline=None
)
TestComputers = Computers.TestCase
