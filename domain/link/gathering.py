"""Gathers what follows from one step of a link."""

from domain.computers import ComputerName
from domain.inputs import Input
from domain.link.messages import Message
from domain.link.outputs import NOTHING, LinkOutputs, Sending


class Gathering:
    """Messages to send and inputs for the core, until they are taken."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self._sendings: list[Sending] = []
        self._inputs: list[Input] = []

    def send(self, to: ComputerName, message: Message) -> None:
        """Send a message to another computer."""
        self._sendings.append(Sending(to, message))

    def give(self, given: Input) -> None:
        """Give an input to the core."""
        self._inputs.append(given)

    def take(self) -> LinkOutputs:
        """Return all that was gathered, and begin anew."""
        if not self._sendings and not self._inputs:
            return NOTHING
        outputs = LinkOutputs(tuple(self._sendings), tuple(self._inputs))
        self._sendings, self._inputs = [], []
        return outputs
