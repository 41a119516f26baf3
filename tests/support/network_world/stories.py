"""Stories made by chance: what happens to which computer when, all from one number."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from random import Random
from typing import TypeAlias

from domain.actor import Actor
from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import (
    EmergencyStopRequest,
    Input,
    ModeRequest,
    ParametersRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.simulation.network import PERFECT, Wire
from domain.simulation.node_settings import Fault
from domain.timebase import seconds
from tests.support.models import BASE
from tests.support.network_world.happenings import (
    Ask,
    Crash,
    Happening,
    Newcomer,
    NewcomerEnds,
    NodeFault,
    Sleep,
    Start,
    Store,
    WireChanges,
)
from tests.support.network_world.robots import ARRANGEMENTS, MODEL, Arrangement

ADA = Actor("ada", "http", "10.0.0.7")
TRANSITIONS = tuple(t for t in Transition if t is not Transition.SHUTDOWN)
"""Without the one from which there is no way back."""
TROUBLE_S = 8.0
"""How long things go wrong; then the network is whole, and all runs."""
GOOD_WIRE = Wire(delay=seconds(0.002), jitter=seconds(0.003))
FAR_WIRE = replace(GOOD_WIRE, delay=seconds(0.03))
LENGTHS_S = (0.2, 0.45, 0.6, 1.0, 1.4, 1.6, 1.9, 2.2, 3.0, 4.5)
"""Of a trouble: around the limits of the lease, and far from them."""

Dated: TypeAlias = tuple[float, Happening]
"""When it happens, in s since the start, and what."""


@dataclass(frozen=True)
class Story:
    """What happens in one run."""

    seed: int
    """Of the chance in the network, and of all else that the happenings leave open."""
    arrangement: Arrangement
    happenings: tuple[Dated, ...]
    wire: Wire = GOOD_WIRE
    """All wires while nothing is wrong with them."""

    def __str__(self) -> str:
        """Return the story as text, a happening a line."""
        lines = (f"  {at:7.3f}  {happening}" for at, happening in self.happenings)
        return "\n".join((f"story {self.seed}: {self.arrangement}; {self.wire}", *lines))


def story_of(seed: int) -> Story:
    """Return the story that belongs to a number; the same for ever."""
    rng = Random(seed)
    arrangement = rng.choice(ARRANGEMENTS)
    teller = _Teller(rng, arrangement, rng.choice((GOOD_WIRE, GOOD_WIRE, FAR_WIRE, PERFECT)))
    happenings = [(0.0, happening) for happening in teller.beginning()]
    for _ in range(rng.randrange(4, 16)):
        chapter = rng.choices(teller.chapters, teller.weights)[0]
        happenings += chapter(round(rng.uniform(0.1, TROUBLE_S - 1.0), 3))
    in_time = [dated for dated in happenings if dated[0] < TROUBLE_S]
    return Story(seed, arrangement, tuple(sorted(in_time, key=lambda d: d[0])), teller.wire)


def newcomer_of(name: ComputerName) -> ComputerName:
    """Return where the network finds a second computer of a name."""
    return ComputerName(f"{name}#2")


class _Teller:
    """Makes chapters: some happenings that belong together, such as a cut and its end."""

    def __init__(self, rng: Random, arrangement: Arrangement, wire: Wire) -> None:
        self.rng = rng
        self.arrangement = arrangement
        self.wire = wire
        self.devices = tuple(arrangement.devices)
        self.computers = (SUPERVISOR, *self.devices)
        table: Sequence[tuple[int, Callable[[float], list[Dated]]]] = (
            (6, self.request),
            (5, self.cut),
            (3, self.request_into_a_cut),
            (3, self.request_that_is_held_up),
            (2, self.partition),
            (3, self.weather),
            (4, self.crash),
            (2, self.sleep),
            (3, self.stop),
            (2, self.stop_during_a_change),
            (2, self.release),
            (2, self.node_fault),
            (1, self.newcomer),
        )
        self.weights = [weight for weight, _ in table]
        self.chapters = [chapter for _, chapter in table]

    def beginning(self) -> Iterator[Happening]:
        """Yield who starts at once; the others come later, or when the trouble is over."""
        for computer in self.rng.sample(self.computers, len(self.computers)):
            if self.rng.random() < 0.9:
                yield Start(computer)

    def request(self, at: float) -> list[Dated]:
        """Ask for something, usually where it belongs."""
        where = SUPERVISOR if self.rng.random() < 0.8 else self.rng.choice(self.devices)
        return [(at, Ask(where, self._request()))]

    def _request(self) -> Input:
        part = self.rng.choice(MODEL.parts)
        match self.rng.randrange(6):
            case 0:
                return TransitionRequest(part, self.rng.choice(TRANSITIONS), ADA)
            case 1:
                speed = self.rng.choice((0.25, 1.0))
                return ParametersRequest(BASE, {"max_speed": speed, "controller": "PID"}, ADA)
            case _:
                return ModeRequest(part, self.rng.choice(MODEL.modes_of(part)), ADA)

    def cut(self, at: float) -> list[Dated]:
        """Cut the wires between two computers, one of them or both."""
        one, other = self.rng.sample(self.computers, 2)
        ways = [(one, other), (other, one)] if self.rng.random() < 0.6 else [(one, other)]
        return self._cut(at, ways)

    def request_into_a_cut(self, at: float) -> list[Dated]:
        """Ask for something just when its command does not get through, or only afterwards."""
        device = self.rng.choice(self.devices)
        ways = self.rng.choice(
            ([(SUPERVISOR, device), (device, SUPERVISOR)], [(SUPERVISOR, device)])
        )
        cut = replace(self.wire, is_cut=True, keeps=self.rng.random() < 0.8)
        end = at + self.rng.choice((0.6, 1.4, 1.6, 1.9, 2.2, 3.0))
        return [
            *((at, WireChanges(*way, cut)) for way in ways),
            (at + self.rng.uniform(0.0, 1.4), Ask(SUPERVISOR, self._request_of(device))),
            *((end, WireChanges(*way, self.wire)) for way in ways),
        ]

    def request_that_is_held_up(self, at: float) -> list[Dated]:
        """Ask for something, of which the network makes a secret until a cut is over."""
        device = self.rng.choice(self.devices)
        there, back = (SUPERVISOR, device), (device, SUPERVISOR)
        slow = replace(self.wire, delay=seconds(self.rng.choice((1.0, 2.5, 4.0))))
        cut = replace(self.wire, is_cut=True)
        end = at + self.rng.choice((0.6, 1.6, 1.9))
        return [
            (at, WireChanges(*there, slow)),
            (at, Ask(SUPERVISOR, self._request_of(device))),
            *((at + 0.01, WireChanges(*way, cut)) for way in (there, back)),
            *((end, WireChanges(*way, self.wire)) for way in (there, back)),
        ]

    def _request_of(self, device: ComputerName) -> Input:
        node = self.rng.choice(self.arrangement.devices[device].nodes)
        return ModeRequest(node, self.rng.choice(MODEL.modes_of(node)), ADA)

    def partition(self, at: float) -> list[Dated]:
        """Cut all wires between some computers and the others."""
        some = set(self.rng.sample(self.computers, self.rng.randrange(1, len(self.computers))))
        ways = [way for way in permutations(self.computers, 2) if len(some & set(way)) == 1]
        return self._cut(at, ways)

    def _cut(self, at: float, ways: list[tuple[ComputerName, ComputerName]]) -> list[Dated]:
        cut = replace(self.wire, is_cut=True, keeps=self.rng.random() < 0.5)
        end = at + self.rng.choice(LENGTHS_S)
        began = [(at, WireChanges(*way, cut)) for way in ways]
        return [*began, *((end, WireChanges(*way, self.wire)) for way in ways)]

    def weather(self, at: float) -> list[Dated]:
        """Let a wire lose, delay, repeat and disorder what it carries."""
        one, other = self.rng.sample(self.computers, 2)
        bad = Wire(
            delay=seconds(self.rng.choice((0.0, 0.01, 0.2, 0.6))),
            jitter=seconds(self.rng.choice((0.0, 0.05, 0.3))),
            loss=self.rng.choice((0.0, 0.3, 0.7)),
            duplication=self.rng.choice((0.0, 0.3)),
            duplicate_delay=seconds(self.rng.choice((0.02, 1.0, 3.0))),
        )
        ways = self.rng.choice(([(one, other)], [(one, other), (other, one)]))
        end = at + self.rng.choice(LENGTHS_S)
        began = [(at, WireChanges(*way, bad)) for way in ways]
        return [*began, *((end, WireChanges(*way, self.wire)) for way in ways)]

    def crash(self, at: float) -> list[Dated]:
        """Kill a process, and start it again with the store that it had, an old one or none."""
        who = self.rng.choice(self.computers)
        store = self.rng.choices(list(Store), (6, 2, 2))[0]
        down_s = self.rng.choice((0.05, *LENGTHS_S))
        return [(at, Crash(who)), (at + down_s, Start(who, store))]

    def sleep(self, at: float) -> list[Dated]:
        """Let a process do nothing for a while."""
        return [(at, Sleep(self.rng.choice(self.computers), self.rng.choice(LENGTHS_S)))]

    def stop(self, at: float) -> list[Dated]:
        """Press an emergency stop, and often release it somewhere."""
        pressed = Ask(self.rng.choice(self.computers), EmergencyStopRequest(True, "smoke", ADA))
        after_s = self.rng.choice(LENGTHS_S)
        return [(at, pressed), *(self.release(at + after_s) if self.rng.random() < 0.7 else ())]

    def stop_during_a_change(self, at: float) -> list[Dated]:
        """Press a stop at a device, of which its supervisor may not know while it activates."""
        device = self.rng.choice(self.devices)
        way = (device, SUPERVISOR)
        pressed_at = at + self.rng.uniform(0.0, 0.7)
        node = self.rng.choice(self.arrangement.devices[device].nodes)
        pressed = EmergencyStopRequest(True, "a hand", ADA)
        cut = replace(self.wire, is_cut=self.rng.random() < 0.7)
        return [
            (at, Ask(SUPERVISOR, TransitionRequest(node, Transition.CLEANUP, ADA))),
            (at + 0.7, Ask(SUPERVISOR, ModeRequest(node, MODEL.modes_of(node)[0], ADA))),
            (at + 0.7, WireChanges(*way, cut)),
            (pressed_at + 0.7, Ask(device, pressed)),
            (at + 2.0, WireChanges(*way, self.wire)),
        ]

    def release(self, at: float) -> list[Dated]:
        """Release all stops that are seen somewhere."""
        where = self.rng.choice((SUPERVISOR, *self.computers))
        return [(at, Ask(where, EmergencyStopRequest(False, "looked", ADA)))]

    def node_fault(self, at: float) -> list[Dated]:
        """Break a node for a while."""
        node = self.rng.choice(list(MODEL.nodes))
        broken = NodeFault(node, self.rng.choice(list(Fault)))
        return [(at, broken), (at + self.rng.choice(LENGTHS_S), NodeFault(node, None))]

    def newcomer(self, at: float) -> list[Dated]:
        """Start a second process of one name for a while."""
        name = self.rng.choice(self.computers)
        end = at + self.rng.choice(LENGTHS_S)
        told: list[Dated] = [(at, Newcomer(name)), (end, NewcomerEnds(name))]
        if self.rng.random() < 0.5:
            pressed = EmergencyStopRequest(True, "there is another one", ADA)
            told.append((self.rng.uniform(at, end), Ask(newcomer_of(name), pressed)))
        return told
