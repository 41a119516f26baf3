"""Records of the core as bytes of JSON, and back."""

from typing import Generic, TypeVar, get_args

from domain.actor import Actor
from domain.commands import Command
from domain.events.event import RecordedEvent
from domain.inputs import Input
from domain.kept import Keeping, Kept
from domain.link.messages import Message
from service.codec.errors import CodecError
from service.codec.json_text import from_text, to_text
from service.codec.recorded_step import RecordedStep
from service.codec.records import Shapes

VERSION = 1
"""Of the format; whoever stores or sends records says with which version they were written."""
MAX_BYTES = 8 * 2**20
"""Largest size of one record; a path of most waypoints takes 3.2 MB."""
MAX_MESSAGE_BYTES = 2**20
"""Largest size of what one computer of a robot tells another, before it is packed."""
MAX_STEP_BYTES = 2**29
"""Largest size of a step; the first one of a run brings the paths of a hundred tasks back."""

Record = TypeVar("Record")

_SHAPES = Shapes()


class Codec(Generic[Record]):
    """Writes and reads the records of one kind, such as inputs.

    Each record is an object that names its class. Reading ignores unknown fields and fills in
    fields that have a default, so that records of other releases can be read.
    """

    def __init__(self, *kinds: type, most_bytes: int = MAX_BYTES) -> None:
        """Derive how the records are written and read.

        Args:
            kinds: Their classes; no other one is ever built.
            most_bytes: Largest size of a record that is read.
        """
        self._shape = _SHAPES.of_named(kinds)
        self._read = self._shape.checked()
        self._most_bytes = most_bytes

    def encode(self, value: Record) -> bytes:
        """Return a record as JSON.

        Raises:
            CodecError: It is of another class, or holds half a surrogate pair.
        """
        assert self._shape.write is not None
        return to_text(self._shape.write(value))

    def decode(self, text: bytes) -> Record:
        """Return the value that `encode` was given, or one of another release.

        Args:
            text: From anywhere, also from the network.

        Raises:
            CodecError: It is no such record; the message says what is wrong, and where.
        """
        record: Record = self._read(from_text(text, self._most_bytes))
        return record


def require_version(version: int) -> None:
    """Check that records of a version can be read.

    Raises:
        CodecError: A newer release wrote them.
    """
    if not 1 <= version <= VERSION:
        raise CodecError(f"records of version {version}; this release reads 1 to {VERSION}")


INPUTS: Codec[Input] = Codec(*get_args(Input))
COMMANDS: Codec[Command] = Codec(*get_args(Command))
EVENTS: Codec[RecordedEvent] = Codec(RecordedEvent)
KEPT: Codec[Kept] = Codec(*get_args(Kept))
KEEPINGS: Codec[Keeping] = Codec(Keeping)
ACTORS: Codec[Actor] = Codec(Actor)
MESSAGES: Codec[Message] = Codec(*get_args(Message), most_bytes=MAX_MESSAGE_BYTES)
STEPS: Codec[RecordedStep] = Codec(RecordedStep, most_bytes=MAX_STEP_BYTES)
