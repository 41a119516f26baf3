"""The link at a device: what its core takes in is told to the supervisor."""

from typing import Protocol

from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    Input,
    NodeReport,
    Readings,
    SourceFault,
)
from domain.link.messages import Told
from domain.timebase import Instant
from service.clock import Clock
from service.link.end import LinkEnd, Machine
from service.link.port import Link
from service.link.status import LinkStatus


class DeviceMachine(Machine, Protocol):
    """What decides at a device: `DeviceLink`."""

    def note(self, told: Told, now: Instant, /) -> None:
        """Learn what the device knows of its nodes and signals; `wake_at` tells when it is sent."""
        ...


class DeviceEnd(LinkEnd):
    """The `ComputersLink` of a device."""

    def __init__(
        self, machine: DeviceMachine, link: Link, clock: Clock, status: LinkStatus
    ) -> None:
        """Prepare; nothing is sent before `run`. The arguments are those of `LinkEnd`."""
        super().__init__(machine, link, clock, status)
        self._device = machine

    def note(self, given: Input, /) -> None:
        """Tell the supervisor what the core of this device took in, from whomever it came.

        Answers of nodes are left out: the core answers for them, by the number of the supervisor.
        """
        if isinstance(given, _TOLD):
            self._device.note(given, self._clock.now())
            self._alarm.check()


_TOLD = (NodeReport, Readings, SourceFault, ErrorReport, CheckpointReport)
