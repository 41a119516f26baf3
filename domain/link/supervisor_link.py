"""The supervisor's end of the link: all devices, each with its lease, its session and its facts."""

from collections.abc import Mapping

from domain.commands import AskRelease, LinkCommand, NodeCommand, TellStops
from domain.computers import SUPERVISOR, ComputerName, Incarnation
from domain.inputs import NodeAnswer
from domain.link.drops import Drop, Drops
from domain.link.gathering import Gathering
from domain.link.messages import Beat, Message, Report, Terms
from domain.link.outputs import LinkOutputs
from domain.link.passing_on import PassingOn
from domain.link.peer import Heard, Own, Peer, Said
from domain.link.peers import Peers
from domain.link.remote_device import RemoteDevice
from domain.link.settings import LinkSettings, Owned
from domain.state_and_mode import PartName
from domain.timebase import Instant


class SupervisorLink:
    """Deterministic: messages, commands of the core and time in; messages and inputs out.

    `now` never decreases from call to call. Whatever is due happens before what is called for.
    """

    def __init__(
        self,
        terms: Terms,
        devices: Mapping[ComputerName, Owned],
        incarnation: Incarnation,
        start: Instant,
        settings: LinkSettings | None = None,
    ) -> None:
        """Begin without having heard of any device; the first beats are due at once.

        Args:
            terms: What a device must agree on.
            devices: What belongs to each device; no node belongs to two.
            incarnation: Of this process; random.
            start: The current time.
            settings: Times of the link.
        """
        settings = settings or LinkSettings()
        own = Own(SUPERVISOR, incarnation, terms)
        self.drops = Drops()
        self.peers = Peers(own, settings, devices, (), self._says, start)
        self._passing_on = PassingOn(self.peers)
        self._devices = {
            name: RemoteDevice(self.peers[name], own, owned, settings, start)
            for name, owned in devices.items()
        }
        self._missed_at: Instant | None = start + settings.lost
        """When devices that were not heard yet count as missing; None: they do."""
        self._owners: dict[PartName, RemoteDevice] = {
            node: self._devices[name] for name, owned in devices.items() for node in owned.nodes
        }

    def wake_at(self) -> Instant:
        """Return when something is due next."""
        beats = self.peers.wake_at()
        return beats if self._missed_at is None else min(beats, self._missed_at)

    def pass_time(self, now: Instant) -> LinkOutputs:
        """Do all that is due up to `now`."""
        gathering = Gathering()
        self._catch_up(now, gathering)
        return gathering.take()

    def hear(self, sender: ComputerName, message: Message, now: Instant) -> LinkOutputs:
        """Take a message of another computer.

        Args:
            sender: As the transport knows it; what says that it is from somebody else is dropped.
            message: What it says.
            now: When it arrived.
        """
        gathering = Gathering()
        self._catch_up(now, gathering)
        if message.sender != sender or sender == SUPERVISOR:
            self.drops.count(Drop.SENDER)
        elif isinstance(message, Beat):
            self._hear_beat(message, now, gathering)
        elif isinstance(message, Report) and sender in self._devices:
            if not self._devices[sender].take_report(message, now, gathering):
                self.drops.count(Drop.OLD)
        else:
            self.drops.count(Drop.UNEXPECTED)
        if sender in self._devices:
            self._devices[sender].tell_status(now, gathering)
        return gathering.take()

    def tell(self, command: NodeCommand | LinkCommand, now: Instant) -> LinkOutputs:
        """Take a command of the core.

        A command for a node whose device is not connected is answered with no at once.
        """
        gathering = Gathering()
        self._catch_up(now, gathering)
        if isinstance(command, TellStops | AskRelease):
            self.peers.tell(command, now, gathering)
        elif isinstance(command, NodeCommand):
            device = self._owners.get(command.node)
            if device is None:
                reason = "no device has such a node"
                gathering.give(NodeAnswer(command.request, command.node, False, reason))
            else:
                device.order(command, now, gathering)
        return gathering.take()

    def _catch_up(self, now: Instant, gathering: Gathering) -> None:
        if now < self.wake_at():
            return
        for peer in self.peers.pass_time(now):
            if peer.name in self._devices:
                self._devices[peer.name].lose()
        if self._missed_at is not None and now >= self._missed_at:
            self._missed_at = None
        for device in self._devices.values():
            device.tell_status(now, gathering)
        self.peers.beat_if_due(now, gathering)

    def _hear_beat(self, beat: Beat, now: Instant, gathering: Gathering) -> None:
        found = self.peers.hear(beat, now, gathering)
        if found is None:
            self.drops.count(Drop.SENDER)
            return
        peer, heard = found
        if heard is Heard.NOTHING:
            self.drops.count(Drop.OLD)
        elif peer.name in self._devices:
            self._devices[peer.name].take_beat(beat, now, gathering)

    def _says(self, peer: Peer, now: Instant) -> Said:
        device = self._devices.get(peer.name)
        if device is None:
            return Said()
        return device.says()._replace(passed_on=self._passing_on.beat_says(peer, now))
