"""All that is checked in each step of a world."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from domain.errors import PilothouseError
from domain.inputs import Input
from domain.link.messages import Message
from domain.link.outputs import LinkOutputs, Sending
from domain.timebase import Instant, seconds
from tests.support.network_world.lease_oracle import LeaseOracle
from tests.support.network_world.order_oracle import OrderOracle
from tests.support.network_world.processes import Process, Step
from tests.support.network_world.stop_oracle import StopOracle

if TYPE_CHECKING:
    from tests.support.network_world.world import World

LOOK_EVERY = seconds(0.05)


@dataclass
class Answer:
    """Whether a request was refused."""

    refusal: PilothouseError | None = None


class Oracles:
    """Passes on what is seen to those that judge it."""

    def __init__(self, world: "World") -> None:
        self._world = world
        self.orders = OrderOracle()
        self.stops = StopOracle()
        self.lease = LeaseOracle(world.story.arrangement)
        self.runs: list[Process] = []
        """All processes that there were."""
        self._look_at: Instant = 0

    def began(self, process: Process) -> None:
        self.runs.append(process)
        self.orders.began(process)
        self.stops.began(process)
        self.lease.began(process)

    def sent(self, process: Process, sending: Sending) -> None:
        self.orders.sent(process, sending)
        self.stops.sent(process, sending)
        self.lease.sent(process, sending)

    def told(self, process: Process, inputs: tuple[Input, ...]) -> None:
        self.orders.told(process, inputs)
        self.lease.told(process, inputs)

    def heard(self, process: Process, message: Message, outputs: LinkOutputs) -> None:
        self.orders.heard(process, message, outputs.inputs)

    def read(self, process: Process, message: Message) -> None:
        self.stops.read(process, message)
        self.lease.read(process, message)

    def took(self, process: Process, step: Step) -> None:
        self.orders.took(process, step)
        self.stops.took(process, step)

    @contextmanager
    def asked(self, process: Process, request: Input) -> Iterator[Answer]:
        """See a request, and then whether it was refused."""
        answer = Answer()
        self.stops.asked(process, request)
        self.orders.asking(process, request)
        yield answer
        if answer.refusal is not None:
            self.orders.refused(process)

    def look(self) -> None:
        """Look at what each process shows, every now and then."""
        now = self._world.now
        self.stops.look()
        if now < self._look_at:
            return
        self._look_at = now + LOOK_EVERY
        for computer, process in self._world.running:
            if computer.asleep_until < now:
                self.lease.look(process, now)
