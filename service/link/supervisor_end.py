"""The link at the supervisor: the devices as a backend of their nodes and signals."""

import asyncio

from domain.commands import NodeCommand
from domain.inputs import BackendStatus, Input
from service.link.end import LinkEnd
from service.ports import Deliver


class SupervisorEnd(LinkEnd):
    """Both a `NodeBackend` of the nodes of all devices, and the `ComputersLink` of the supervisor.

    It delivers a negative `NodeAnswer` to a command for a node whose device is not connected.
    """

    async def run(self, deliver: Deliver) -> None:
        """Exchange messages with the devices, and deliver what follows, until cancelled."""
        # A device that is not there is no failure of what reaches them all.
        deliver(BackendStatus(available=True))
        await super().run(deliver)

    def note(self, given: Input, /) -> None:
        """Do nothing: no device follows what the supervisor learnt."""


class RemoteNodes:
    """A `NodeBackend` of the nodes of all devices that only sends: another task runs the link."""

    def __init__(self, end: SupervisorEnd) -> None:
        """Prepare.

        Args:
            end: Whose `run` delivers what the devices tell.
        """
        self._end = end

    async def run(self, deliver: Deliver) -> None:
        """Wait until cancelled."""
        await asyncio.get_running_loop().create_future()

    def send(self, command: NodeCommand, /) -> None:
        """Send a command to the device of its node."""
        self._end.send(command)
