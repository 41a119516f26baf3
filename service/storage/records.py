"""Steps and kept values as the log and the state hold them."""

from typing import Final

from domain.kept import Kept
from domain.outbox import Outputs
from service.codec.codec import COMMANDS, EVENTS, INPUTS, KEPT
from service.codec.codec import KEEPINGS as CHANGES
from service.codec.errors import CodecError
from service.codec.names import NAMES
from service.storage.journal import Step

_SEPARATOR: Final = b"\t"
"""JSON writes it as an escape."""
_COMMAND, _EVENT, _CHANGE = b"c", b"e", b"k"
"""First byte of an output."""
_FEWEST_PIECES: Final = 3


def step_to_line(step: Step) -> bytes:
    """Return a step as one line: time, lateness and input, then what followed.

    Raises:
        CodecError: A text in it holds half a surrogate pair.
    """
    line = b"%d\t%d\t%b" % (step.at, step.is_late, INPUTS.encode(step.given))
    outputs = step.outputs
    if not (outputs.commands or outputs.events or outputs.kept):
        return line
    pieces = [line]
    pieces += [_COMMAND + COMMANDS.encode(command) for command in outputs.commands]
    pieces += [_EVENT + EVENTS.encode(event) for event in outputs.events]
    pieces += [_CHANGE + CHANGES.encode(change) for change in outputs.kept]
    return _SEPARATOR.join(pieces)


def step_from_line(line: bytes) -> Step:
    """Return the step of a line; of its outputs, what is written: commands, events and changes.

    Raises:
        CodecError: It is no such line.
    """
    at, is_late, given, *pieces = _pieces(line)
    commands = tuple(COMMANDS.decode(piece[1:]) for piece in pieces if piece[:1] == _COMMAND)
    events = tuple(EVENTS.decode(piece[1:]) for piece in pieces if piece[:1] == _EVENT)
    kept = tuple(CHANGES.decode(piece[1:]) for piece in pieces if piece[:1] == _CHANGE)
    outputs = Outputs(commands, events, kept=kept)
    return Step(int(at), INPUTS.decode(given), is_late == b"1", outputs)


def kind_name(kind: type[Kept]) -> str:
    """Return the stable name of a kind of kept values."""
    return NAMES[kind]


def kept_to_text(value: Kept) -> bytes:
    """Return a kept value as JSON.

    Raises:
        CodecError: A text in it holds half a surrogate pair.
    """
    return KEPT.encode(value)


def kept_from_text(text: bytes) -> Kept:
    """Return a value that this or another version kept.

    Raises:
        CodecError: It is no such value.
    """
    return KEPT.decode(text)


def _pieces(line: bytes) -> list[bytes]:
    pieces = line.split(_SEPARATOR)
    if len(pieces) < _FEWEST_PIECES or not pieces[0].lstrip(b"-").isdigit():
        raise CodecError("not a step of the log")
    return pieces
