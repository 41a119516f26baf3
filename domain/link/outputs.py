"""What follows from a step of a link."""

from typing import NamedTuple

from domain.computers import ComputerName
from domain.inputs import Input
from domain.link.messages import Message


class Sending(NamedTuple):
    """A message, and to whom it goes.

    A beat may be lost; reports and orders are delivered in their order, or not at all.
    """

    to: ComputerName
    message: Message


class LinkOutputs(NamedTuple):
    """Messages to send, and inputs for the core, each in their order."""

    sendings: tuple[Sending, ...] = ()
    inputs: tuple[Input, ...] = ()


NOTHING = LinkOutputs()
