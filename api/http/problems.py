"""Answers to rejected and failed requests: problem documents (RFC 9457), from one table.

`STATUS_OF` maps each class of error to a status; `HttpError` is for errors of HTTP itself.
"""

from collections.abc import Mapping
from http import HTTPStatus

from fastapi import HTTPException
from fastapi.responses import Response

from api.http.access import ReadsOnlyError, UnauthorizedError
from api.http.body_parsing import (
    MAX_FAULTS,
    BodyTooLargeError,
    InvalidBodyError,
    MalformedBodyError,
    as_pointer,
)
from api.http.schemas.base import BlockerJson, FindingJson
from api.http.schemas.problem import BodyFault, Problem
from api.http.stop_asked import StopTakenError
from domain.conditions.lexer import ConditionSyntaxError
from domain.errors import (
    ActsElsewhereError,
    BackendUnavailableError,
    BlockedError,
    FarStartError,
    IllegalTransitionError,
    InvalidModelError,
    InvalidValueError,
    NotReportedError,
    OfflineError,
    OutdatedReadingError,
    OwnedBySupervisorError,
    PilothouseError,
    ProcessElsewhereError,
    RefusedError,
    ReservedHoldError,
    StorageDegradedError,
    TooManyHoldsError,
    UnknownChangeError,
    UnknownCheckpointError,
    UnknownControllerError,
    UnknownDeviceError,
    UnknownErrorNameError,
    UnknownEventError,
    UnknownModeError,
    UnknownNameError,
    UnknownParameterError,
    UnknownPartError,
    UnknownProcessError,
    UnknownReactionError,
    UnknownSignalError,
    UnknownTaskError,
)
from service.checkpoint import CheckpointError
from service.clock import Clock
from service.codec.errors import CodecError
from service.exported_record import InvalidExportError
from service.files.csv_table import InvalidWaypointsError
from service.files.robot_file import InvalidRobotFileError
from service.files.text_file import UnreadableFileError
from service.recorded_pieces import MomentNotRecordedError, NothingRecordedError
from service.replayed_robot import RecordingError, ReplayDiffersError
from service.ros.interface.task_services import NoWaypointFolderError
from service.start_task import StartTaskError
from service.worker import OutOfMemoryError, TooComplexError, WorkerBusyError, WorkerClosedError

STATUS_OF: Mapping[type[PilothouseError], HTTPStatus] = {
    PilothouseError: HTTPStatus.INTERNAL_SERVER_ERROR,
    MalformedBodyError: HTTPStatus.BAD_REQUEST,
    UnauthorizedError: HTTPStatus.UNAUTHORIZED,
    ReadsOnlyError: HTTPStatus.FORBIDDEN,
    BodyTooLargeError: HTTPStatus.REQUEST_ENTITY_TOO_LARGE,
    UnknownNameError: HTTPStatus.NOT_FOUND,
    UnknownPartError: HTTPStatus.NOT_FOUND,
    UnknownReactionError: HTTPStatus.NOT_FOUND,
    UnknownSignalError: HTTPStatus.NOT_FOUND,
    UnknownProcessError: HTTPStatus.NOT_FOUND,
    UnknownCheckpointError: HTTPStatus.NOT_FOUND,
    UnknownErrorNameError: HTTPStatus.NOT_FOUND,
    UnknownChangeError: HTTPStatus.NOT_FOUND,
    UnknownTaskError: HTTPStatus.NOT_FOUND,
    UnknownEventError: HTTPStatus.NOT_FOUND,
    UnknownDeviceError: HTTPStatus.NOT_FOUND,
    # Modes and parameters are named in bodies, not in paths.
    UnknownModeError: HTTPStatus.UNPROCESSABLE_ENTITY,
    UnknownParameterError: HTTPStatus.UNPROCESSABLE_ENTITY,
    UnknownControllerError: HTTPStatus.UNPROCESSABLE_ENTITY,
    InvalidValueError: HTTPStatus.UNPROCESSABLE_ENTITY,
    FarStartError: HTTPStatus.UNPROCESSABLE_ENTITY,
    ConditionSyntaxError: HTTPStatus.UNPROCESSABLE_ENTITY,
    InvalidWaypointsError: HTTPStatus.UNPROCESSABLE_ENTITY,
    InvalidBodyError: HTTPStatus.UNPROCESSABLE_ENTITY,
    StopTakenError: HTTPStatus.UNPROCESSABLE_ENTITY,
    CodecError: HTTPStatus.UNPROCESSABLE_ENTITY,
    CheckpointError: HTTPStatus.UNPROCESSABLE_ENTITY,
    InvalidExportError: HTTPStatus.UNPROCESSABLE_ENTITY,
    NothingRecordedError: HTTPStatus.NOT_FOUND,
    MomentNotRecordedError: HTTPStatus.NOT_FOUND,
    RecordingError: HTTPStatus.CONFLICT,
    ReplayDiffersError: HTTPStatus.CONFLICT,
    InvalidModelError: HTTPStatus.UNPROCESSABLE_ENTITY,
    TooComplexError: HTTPStatus.UNPROCESSABLE_ENTITY,
    OutOfMemoryError: HTTPStatus.UNPROCESSABLE_ENTITY,
    RefusedError: HTTPStatus.CONFLICT,
    NoWaypointFolderError: HTTPStatus.CONFLICT,
    IllegalTransitionError: HTTPStatus.CONFLICT,
    BlockedError: HTTPStatus.CONFLICT,
    OutdatedReadingError: HTTPStatus.CONFLICT,
    NotReportedError: HTTPStatus.CONFLICT,
    ReservedHoldError: HTTPStatus.CONFLICT,
    TooManyHoldsError: HTTPStatus.CONFLICT,
    OwnedBySupervisorError: HTTPStatus.CONFLICT,
    OfflineError: HTTPStatus.CONFLICT,
    ProcessElsewhereError: HTTPStatus.CONFLICT,
    ActsElsewhereError: HTTPStatus.CONFLICT,
    WorkerBusyError: HTTPStatus.TOO_MANY_REQUESTS,
    WorkerClosedError: HTTPStatus.SERVICE_UNAVAILABLE,
    BackendUnavailableError: HTTPStatus.SERVICE_UNAVAILABLE,
    StorageDegradedError: HTTPStatus.SERVICE_UNAVAILABLE,
    # Files are read before the service accepts requests.
    InvalidRobotFileError: HTTPStatus.INTERNAL_SERVER_ERROR,
    UnreadableFileError: HTTPStatus.INTERNAL_SERVER_ERROR,
    StartTaskError: HTTPStatus.INTERNAL_SERVER_ERROR,
}

MEDIA_TYPE = "application/problem+json"


class HttpError(HTTPException):
    """An error of HTTP itself, with its own code."""

    def __init__(self, status: HTTPStatus, code: str, detail: str, hint: str | None = None) -> None:
        super().__init__(status, detail)
        self.code = code
        self.hint = hint


def problem_of(error: PilothouseError, clock: Clock, instance: str = "") -> Problem:
    """Return the document for an error of the core or the service.

    Args:
        error: The error.
        clock: Converts the times of blockers.
        instance: Path of the request.
    """
    more: dict[str, object] = {}
    if error.hint:
        more["hint"] = error.hint
    if isinstance(error, BlockedError):
        more["blockers"] = [BlockerJson.of(blocker, clock) for blocker in error.blockers]
    if isinstance(error, FarStartError) and error.nearest is not None:
        more["available"] = [str(error.nearest[0])]
    if isinstance(error, IllegalTransitionError):
        more["available"] = [str(transition) for transition in error.available]
    if isinstance(error, InvalidModelError | InvalidWaypointsError):
        more["findings"] = [FindingJson.of(finding) for finding in error.findings[:MAX_FAULTS]]
    if isinstance(error, InvalidBodyError):
        more["errors"] = error.faults
    if isinstance(error, InvalidValueError):
        pointer = as_pointer(error.pointer)
        more["errors"] = [BodyFault(pointer=pointer, code=error.code, message=error.message)]
    title = (type(error).__doc__ or "").partition("\n")[0].partition(";")[0].rstrip(".")
    return make_problem(status_of(error), error.code, error.message, instance, title, more)


def status_of(error: PilothouseError) -> HTTPStatus:
    """Return the status of an error: that of its class, or of the nearest base class."""
    return next(STATUS_OF[kind] for kind in type(error).__mro__ if kind in STATUS_OF)


def make_problem(
    status: HTTPStatus,
    code: str,
    detail: str,
    instance: str,
    title: str = "",
    more: Mapping[str, object] | None = None,
) -> Problem:
    """Return a document.

    Args:
        status: HTTP status.
        code: Stable, UPPER_SNAKE.
        detail: Description of this occurrence.
        instance: Path of the request.
        title: Description of this kind of problem; empty: the phrase of the status.
        more: Further members.
    """
    members: dict[str, object] = {
        "type": f"urn:pilothouse:problem:{code.lower().replace('_', '-')}",
        "title": title or status.phrase,
        "status": status.value,
        "detail": detail,
        "instance": instance,
        "code": code,
        **(more or {}),
    }
    return Problem.model_validate(members)


def problem_response(problem: Problem, headers: Mapping[str, str] | None = None) -> Response:
    """Return the response with a document."""
    return Response(problem.as_json(), problem.status, headers, MEDIA_TYPE)
