"""Waypoint tasks of the vehicle."""

from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Path, Query, Request, Response

from api.http.body_parsing import InvalidBodyError
from api.http.dependencies import ActorDep, SupervisorDep, WorkerDep
from api.http.kept_requests import KeptDep
from api.http.request_body import limits_of, read_body
from api.http.route_policy import Permission, policy
from api.http.schemas.path_preview import PathPreviewJson
from api.http.schemas.tasks import (
    Controller,
    TaskJson,
    TasksJson,
    WaypointsJson,
)
from api.http.task_jobs import (
    PostedTask,
    TaskOptions,
    encode_waypoints,
    preview_posted,
    read_posted_task,
)
from domain.actor import Actor
from domain.errors import FarStartError, InvalidValueError, UnknownControllerError, UnknownTaskError
from domain.inputs import CancelTaskRequest, TaskRequest
from domain.paths.headings import Heading
from domain.tracking.trackers import TRACKERS
from service.files.csv_columns import column_names
from service.files.driving_block import DEFAULT_CONTROLLER, DEFAULT_SPEED_MPS
from service.numpy_loading import numpy_loaded
from service.worker import Jobs

router = APIRouter(prefix="/tasks", tags=["drive"])

_MAX_BYTES_HERE = 4_096
_MAX_POINTS_HERE = 500
"""Up to these limits the job takes less than 5 ms, and is not worth sending to the worker."""

_BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {"schema": {"$ref": "#/components/schemas/TaskBody"}},
            "text/csv": {"schema": {"type": "string"}},
        },
    }
}


async def _csv_options(
    request: Request,
    controller: Annotated[
        Controller | None,
        Query(description=f"Of a CSV: the path tracker, by default {DEFAULT_CONTROLLER}"),
    ] = None,
    speed_mps: Annotated[
        float | None,
        Query(
            allow_inf_nan=False,
            description=f"Of a CSV: the cruise speed, by default {DEFAULT_SPEED_MPS} m/s",
        ),
    ] = None,
    start_index: Annotated[
        int | None, Query(ge=0, description="Of a CSV: index of the first waypoint, from 0")
    ] = None,
    heading: Annotated[
        Heading | None,
        Query(description="Of a CSV: unit of its headings, by default the one that fits the path"),
    ] = None,
    columns: Annotated[
        str | None,
        Query(
            max_length=2_000,
            description="Of a CSV: names of its columns, such as `s,x,y,yaw`; `_` is any other",
        ),
    ] = None,
) -> TaskOptions | None:
    """Return the options for a CSV; None: the body is JSON, and holds them itself."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind == "text/csv":
        return TaskOptions(
            controller or DEFAULT_CONTROLLER,
            DEFAULT_SPEED_MPS if speed_mps is None else speed_mps,
            start_index or 0,
            heading,
            None if columns is None else _names_in(columns),
        )
    named = {"controller": controller, "speed_mps": speed_mps, "start_index": start_index}
    more = {"heading": heading, "columns": columns}
    given = [name for name, value in {**named, **more}.items() if value is not None]
    if given:
        message = f"{given[0]} in the query is for a CSV (Content-Type: text/csv)"
        raise InvalidBodyError.at("", InvalidValueError(message))
    return None


def _names_in(columns: str) -> tuple[str, ...]:
    """Return the names in `?columns=`.

    Raises:
        InvalidBodyError: They do not say where x and y are.
    """
    try:
        return column_names(columns)
    except InvalidValueError as error:
        message = f"query columns: {error.message}"
        raise InvalidBodyError.at("", InvalidValueError(message)) from error


TaskPath = Annotated[str, Path(description="Its id, as in `Location` of `POST /tasks`")]
CsvOptionsDep = Annotated[TaskOptions | None, Depends(_csv_options)]


@router.post("", status_code=HTTPStatus.CREATED, response_model=TaskJson, openapi_extra=_BODY)
@policy(Permission.OPERATE)
async def post_task(
    request: Request,
    csv: CsvOptionsDep,
    supervisor: SupervisorDep,
    worker: WorkerDep,
    kept: KeptDep,
    actor: ActorDep,
) -> Response:
    """Submit a task along waypoints; it replaces the current task.

    The waypoints are JSON, or CSV (`Content-Type: text/csv`): `x,y[,yaw]` in m and rad, or with a
    header or a `#` line that names the columns, separated by commas, semicolons, tabs or blanks.
    Headings that fit the path in no unit are rejected until `?columns=` or `?heading=` says what
    they are. If there are holds, for example because of an error, the task is accepted and waits.
    """
    raw = await read_body(request, limits_of(request).waypoints_bytes)
    posted = await _read(raw, csv, worker)
    with faults_in_body():
        identity = (await kept.submit(task_request(posted, actor))).task
    if identity is None:
        raise RuntimeError("a task was taken and has no id")
    task = TaskJson.of(supervisor.core.driving.task(identity), supervisor.clock)
    headers = {"Location": f"/tasks/{task.id}"}
    return Response(task.model_dump_json(), HTTPStatus.CREATED, headers, "application/json")


def task_request(posted: PostedTask, actor: Actor) -> TaskRequest:
    """Return the request to drive what was posted."""
    return TaskRequest(posted.path, posted.start_index, posted.controller, posted.speed_mps, actor)


@contextmanager
def faults_in_body() -> Iterator[None]:
    """Say where in the body a task is that the core rejects.

    Raises:
        InvalidBodyError: The task cannot be driven.
    """
    try:
        yield
    except FarStartError:
        # Passed on unchanged: it holds the waypoints at which the task could start instead.
        raise
    except InvalidValueError as error:
        raise InvalidBodyError.at(error.pointer, error) from error
    except UnknownControllerError as error:
        raise InvalidBodyError.at("controller", error) from error


@router.post("/preview", response_model=PathPreviewJson, openapi_extra=_BODY)
@policy(Permission.OBSERVE)
async def preview_task(
    request: Request, csv: CsvOptionsDep, supervisor: SupervisorDep, worker: WorkerDep
) -> Response:
    """Check waypoints and preview their path; nothing is started."""
    raw = await read_body(request, limits_of(request).waypoints_bytes)
    state = supervisor.core.driving.vehicle.state
    pose = None if state is None else state.pose
    content = await worker.call(preview_posted, raw, csv, pose, supervisor.approach_limits)
    return Response(content, media_type="application/json")


@router.get("")
@policy(Permission.OBSERVE)
async def list_tasks(supervisor: SupervisorDep) -> TasksJson:
    """List the tasks that are kept, the newest first."""
    tasks = supervisor.core.driving.tasks()
    items = [TaskJson.of(view, supervisor.clock) for view in tasks]
    return TasksJson(items=items, controllers=list(TRACKERS))


@router.get("/current")
@policy(Permission.OBSERVE)
async def get_current_task(supervisor: SupervisorDep) -> TaskJson:
    """Show the current task, which is driven or held."""
    view = supervisor.core.driving.current_task
    if view is None:
        raise UnknownTaskError("task", "current", (), hint="there is none now; see GET /tasks")
    return TaskJson.of(view, supervisor.clock)


@router.delete("/current", status_code=HTTPStatus.NO_CONTENT, response_class=Response)
@policy(Permission.STOP)
async def cancel_task(kept: KeptDep, actor: ActorDep) -> None:
    """Cancel the current task and stop; succeeds also if there is none."""
    await kept.submit(CancelTaskRequest(actor))


@router.get("/{task}")
@policy(Permission.OBSERVE)
async def get_task(task: TaskPath, supervisor: SupervisorDep) -> TaskJson:
    """Show one task, also one that has ended."""
    return TaskJson.of(supervisor.core.driving.task(task), supervisor.clock)


@router.get("/{task}/waypoints", response_model=WaypointsJson)
@policy(Permission.OBSERVE)
async def get_waypoints(
    task: Annotated[str, Path(description="Its id, or `current`")],
    supervisor: SupervisorDep,
    worker: WorkerDep,
    max_points: Annotated[
        int | None, Query(ge=2, description="Most waypoints, evenly spread; by default all")
    ] = None,
) -> Response:
    """Return the waypoints of a task."""
    driving = supervisor.core.driving
    if task == "current":
        view = driving.current_task
        task = task if view is None else view.id
    waypoints = driving.path_of(task).waypoints
    shown = min(len(waypoints), max_points or len(waypoints))
    if shown <= _MAX_POINTS_HERE:
        content = encode_waypoints(waypoints, max_points)
    else:
        content = await worker.call(encode_waypoints, waypoints, max_points)
    return Response(content, media_type="application/json")


async def _read(raw: bytes, csv: TaskOptions | None, worker: Jobs) -> PostedTask:
    await numpy_loaded()
    if len(raw) <= _MAX_BYTES_HERE:
        return read_posted_task(raw, csv)
    return await worker.call(read_posted_task, raw, csv)
