"""Replays what was recorded: gives a fresh core the same inputs, and compares all that follows.

The core has no clock and no chance in it. If anything else follows than what was recorded, then the
program changed since, or the record did.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import TypeAlias

from domain.commands import (
    ActAlone,
    AnswerOrder,
    AskFacts,
    AskParameters,
    AskRelease,
    AskTransition,
    Command,
    Drive,
    PreemptGoal,
    SendGoal,
    StartProcess,
    StopProcess,
    TellReaction,
    TellStops,
)
from domain.errors import PilothouseError
from domain.events.event import RecordedEvent
from domain.kept import Keeping
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.timebase import Instant
from service.checkpoint import core_of_checkpoint
from service.codec.codec import COMMANDS, EVENTS, KEEPINGS, Codec, Record
from service.codec.names import NAMES
from service.codec.recorded_step import RecordedStep, recorded_step
from service.files.model_file import read_model
from service.files.robot_file import read_robot_file
from service.onboard_parts import make_onboard
from service.recorded_pieces import Piece
from service.storage.journal import Boot


@dataclass(frozen=True, slots=True)
class Difference:
    """The first thing that does not follow as it was recorded."""

    step: int
    """Number of the step in the record."""
    at: Instant
    given: str
    """Name of the input."""
    event: int | None
    """Id of the event that differs; None: all events of the step are the same."""
    expected: str
    """What was recorded, in words."""
    came: str
    """What followed now, in words."""

    @property
    def words(self) -> str:
        """Return the difference in one sentence for an operator."""
        where = f"step {self.step} ({self.given})"
        return f"{where}: recorded was {self.expected}, but now came {self.came}"


@dataclass(frozen=True, slots=True)
class Replayed:
    """The end of a replay."""

    steps: int
    """How many steps were the same."""
    last_event: int | None
    """Id of the last event; None: there was none."""
    difference: Difference | None
    """None: everything followed as it was recorded."""


def core_of_boot(boot: Boot) -> Onboard:
    """Return the core of a run as it was before its first input.

    Raises:
        InvalidModelError: This release cannot read the model of the run.
        InvalidRobotFileError: Nor its robot file.
    """
    model = read_model(boot.model).model
    return make_onboard(model, read_robot_file(boot.robot, model), boot.started_at)


def replay(onboard: Onboard, steps: Iterable[RecordedStep], first: int = 1) -> Replayed:
    """Give a core what was recorded, up to the first difference.

    Args:
        onboard: In the state in which the recorded core was; it is driven on.
        steps: What was recorded after that, in order.
        first: Number of the first of them.
    """
    done, last_event = 0, None
    for number, step in enumerate(steps, first):
        difference = replay_step(onboard, step, number)
        if difference is not None:
            return Replayed(done, last_event, difference)
        done += 1
        if step.events:
            last_event = step.events[-1].id
    return Replayed(done, last_event, None)


def replay_piece(piece: Piece, version: str) -> Replayed:
    """Replay a piece of a record in a core of its own.

    Args:
        piece: Its steps are read as the replay goes on.
        version: This release of Pilothouse.

    Raises:
        PilothouseError: The core cannot be made again, or the record is broken.
    """
    return replay(core_of_piece(piece, version), piece.steps, piece.first)


def core_of_piece(piece: Piece, version: str) -> Onboard:
    """Return the core as it was before the first step of a piece.

    Args:
        piece: Of a record.
        version: This release of Pilothouse.

    Raises:
        PilothouseError: The core cannot be made again.
    """
    if piece.state is None:
        return core_of_boot(piece.boot)
    return core_of_checkpoint(piece.state, version)


def replay_step(onboard: Onboard, step: RecordedStep, number: int) -> Difference | None:
    """Give a core one recorded input; return what differs.

    Args:
        onboard: In the state in which the recorded core was; it is driven on.
        step: What was recorded.
        number: Of the step.
    """
    taken = _take_step(onboard, step, number)
    if isinstance(taken, Difference):
        return taken
    return _difference(step, number, taken)


def show_step(onboard: Onboard, step: RecordedStep, number: int) -> Outputs | Difference:
    """Give a core one recorded input; return what followed, or what of it differs.

    Other than `replay_step` it compares no checksum of views, and is faster for that.

    Args:
        onboard: In the state in which the recorded core was; it is driven on.
        step: What was recorded.
        number: Of the step.
    """
    taken = _take_step(onboard, step, number)
    if isinstance(taken, Difference):
        return taken
    if taken.events == step.events and taken.commands == step.commands:
        return taken
    # A NaN does not equal itself.
    return _difference(step, number, taken) or taken


def _take_step(onboard: Onboard, step: RecordedStep, number: int) -> Outputs | Difference:
    """Give a core one recorded input; return what followed, or that it is rejected.

    Args:
        onboard: In the state in which the recorded core was; it is driven on.
        step: What was recorded.
        number: Of the step.
    """
    handle = onboard.take_in if step.is_late else onboard.handle
    try:
        return handle(step.given, step.at)
    except PilothouseError as error:
        found = (None, "that it is accepted", f"a rejection: {error.message}")
        return Difference(number, step.at, NAMES[type(step.given)], *found)


def _difference(step: RecordedStep, number: int, outputs: Outputs) -> Difference | None:
    found = _compared(step, recorded_step(step.at, step.given, step.is_late, outputs))
    return None if found is None else Difference(number, step.at, NAMES[type(step.given)], *found)


_Found: TypeAlias = tuple[int | None, str, str]
"""Id of the event that differs if any, what was recorded, and what came."""


def _compared(recorded: RecordedStep, came: RecordedStep) -> _Found | None:
    """Return the first difference: of events, then of commands, of what is kept, and of views."""
    events = _first_unequal(EVENTS, recorded.events, came.events)
    if events is not None:
        event = events[0] or events[1]
        return event.id if event else None, *_in_words(EVENTS, _event_words, events)
    commands = _first_unequal(COMMANDS, recorded.commands, came.commands)
    if commands is not None:
        return None, *_in_words(COMMANDS, _command_words, commands)
    kept = _first_unequal(KEEPINGS, recorded.kept, came.kept)
    if kept is not None:
        return None, *_in_words(KEEPINGS, _kept_words, kept)
    if recorded.views is not None and recorded.views != came.views:
        return None, "a change of other views", "the change of these"
    return None


_Pair: TypeAlias = tuple[Record | None, Record | None]
"""What was recorded and what came; None stands for what is missing."""


def _first_unequal(
    codec: Codec[Record], recorded: Sequence[Record], came: Sequence[Record]
) -> _Pair[Record] | None:
    """Return the first pair of values whose records differ.

    Values are compared as records, since 1 equals 1.0 and True, and NaN does not equal itself.
    """
    for one, other in zip_longest(recorded, came):
        if one is None or other is None or codec.encode(one) != codec.encode(other):
            return one, other
    return None


def _in_words(
    codec: Codec[Record], words_of: Callable[[Record], str], pair: _Pair[Record]
) -> tuple[str, str]:
    """Return both in words; with all their fields where the words are the same."""
    expected, came = ("nothing" if value is None else words_of(value) for value in pair)
    if expected == came:
        expected, came = ("" if v is None else codec.encode(v).decode() for v in pair)
    return expected, came


def _event_words(recorded: RecordedEvent) -> str:
    return f"event {recorded.id} {recorded.kind} ({recorded.event.words})"


def _command_words(command: Command) -> str:
    match command:
        case Drive(command=drive):
            return f"drive at {drive.speed_mps!r} m/s, {drive.steering_angle_rad!r} rad"
        case AskTransition(node=node, transition=transition):
            return f"{node} is asked to {transition}"
        case AskParameters(node=node, values=values):
            return f"{node} is asked to set {', '.join(values)}"
        case AskFacts(node=node):
            return f"{node} is asked for its state"
        case SendGoal(goal=goal) | PreemptGoal(goal=goal):
            return f"{type(command).__name__} {goal}"
        case TellStops(stops=stops):
            return f"other computers are told of {len(stops)} stops"
        case AskRelease(computer=computer, stops=ids):
            return f"{computer} is asked to release {', '.join(ids)}"
        case AnswerOrder(node=node, accepted=accepted):
            return f"the supervisor is told that {node} {'accepts' if accepted else 'rejects'}"
        case TellReaction(reaction=reaction, state=state):
            return f"the supervisor is told that reaction {reaction} is {state}"
        case StartProcess(node=node):
            return f"the process of {node} is started"
        case StopProcess(node=node):
            return f"the process of {node} is stopped"
        case ActAlone(autonomous=autonomous):
            return f"this device {'acts' if autonomous else 'no longer acts'} on its own"


def _kept_words(keeping: Keeping) -> str:
    verb = "forgotten" if keeping.value is None else "kept"
    return f"{NAMES[keeping.kind]} {keeping.name} is {verb}".replace("  ", " ")
