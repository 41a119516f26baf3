"""Pieces of a record as a folder of plain files: what somebody sends along with a bug report.

Each piece has a folder of its own: `run.json` says what the core was made of, `checkpoint` is there
unless the piece begins with the run, `steps.jsonl` has one step a line, as the log has them, and
`events.jsonl` the same events for people.
"""

from collections.abc import Iterator, Sequence
from datetime import datetime
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from domain.errors import PilothouseError
from domain.events.event import RecordedEvent
from domain.timebase import Instant
from service.clock import since_epoch, to_datetime
from service.codec.codec import MAX_STEP_BYTES, STEPS, VERSION, require_version
from service.codec.json_text import to_text
from service.codec.recorded_step import RecordedStep
from service.recorded_pieces import Piece
from service.storage.journal import Boot

_RUN, _CHECKPOINT, _STEPS, _EVENTS = "run.json", "checkpoint", "steps.jsonl", "events.jsonl"


class InvalidExportError(PilothouseError):
    """A folder that holds no exported piece, or a broken one."""

    code = "INVALID_EXPORT"


class _RunJson(BaseModel):
    """`run.json`."""

    model_config = ConfigDict(frozen=True)

    codec: int
    """Version of the steps."""
    run: int
    epoch: str
    version: str
    """Release of Pilothouse that recorded it."""
    started_at: Instant
    wall_at: datetime
    first_step: int
    model: str
    robot: str


def is_export(folder: Path) -> bool:
    """Tell whether a folder holds exported pieces."""
    return bool(_folders_in(folder))


def write_piece(piece: Piece, folder: Path) -> int:
    """Write a piece into a new folder inside a folder, which is made where needed.

    Returns:
        How many steps it has.

    Raises:
        FileExistsError: The piece is there already.
        OSError: It cannot be written.
    """
    inside = folder / f"run-{piece.run}-step-{piece.first}"
    inside.mkdir(parents=True)
    boot = piece.boot
    run = _RunJson(
        codec=VERSION,
        run=piece.run,
        epoch=boot.epoch,
        version=boot.version,
        started_at=boot.started_at,
        wall_at=boot.wall_at,
        first_step=piece.first,
        model=boot.model,
        robot=boot.robot,
    )
    (inside / _RUN).write_text(run.model_dump_json(indent=2) + "\n", encoding="utf-8")
    if piece.state is not None:
        (inside / _CHECKPOINT).write_bytes(piece.state)
    count = 0
    with (inside / _STEPS).open("wb") as steps, (inside / _EVENTS).open("wb") as events:
        for step in piece.steps:
            count += 1
            steps.write(STEPS.encode(step) + b"\n")
            for event in step.events:
                events.write(_for_people(event, boot) + b"\n")
    return count


def read_pieces(folder: Path) -> Iterator[Piece]:
    """Yield the pieces of a folder in the order of their steps.

    Raises:
        InvalidExportError: A piece is broken.
        CodecError: A step is broken, or a newer release wrote it.
        OSError: A file cannot be read.
    """
    runs = sorted(
        ((_run_of(inside), inside) for inside in _folders_in(folder)),
        key=lambda item: (item[0].run, item[0].first_step),
    )
    for run, inside in runs:
        checkpoint = inside / _CHECKPOINT
        yield Piece(
            run.run,
            Boot(run.epoch, run.version, run.started_at, run.wall_at, run.model, run.robot),
            checkpoint.read_bytes() if checkpoint.exists() else None,
            run.first_step,
            _steps_in(inside / _STEPS),
        )


def _folders_in(folder: Path) -> Sequence[Path]:
    return sorted(file.parent for file in folder.glob(f"*/{_RUN}"))


def _run_of(inside: Path) -> _RunJson:
    try:
        run = _RunJson.model_validate_json((inside / _RUN).read_bytes())
    except ValidationError as error:
        fault = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, fault["loc"]))
        raise InvalidExportError(f"{inside / _RUN}: {where}: {fault['msg']}") from error
    require_version(run.codec)
    return run


def _steps_in(file: Path) -> Iterator[RecordedStep]:
    with file.open("rb") as lines:
        while line := lines.readline(MAX_STEP_BYTES):
            yield STEPS.decode(line)


def _for_people(event: RecordedEvent, boot: Boot) -> bytes:
    at = to_datetime(since_epoch(boot.wall_at) + event.at - boot.started_at)
    shown = {
        "id": event.id,
        "at": at.isoformat(timespec="milliseconds"),
        "kind": event.kind,
        "words": event.event.words,
        "cause": event.cause,
        "actor": event.actor.label,
        "data": event.data,
    }
    return to_text(shown)
