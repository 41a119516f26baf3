"""An operator of the robot behind its HTTP interface."""

from collections.abc import Awaitable
from http import HTTPStatus
from typing import Any

import httpx

from domain.inputs import (
    AcknowledgeRequest,
    CancelTaskRequest,
    ChangeRequest,
    EmergencyStopRequest,
    ErrorReport,
    HoldRequest,
    Input,
    ModeRequest,
    Readings,
    ReleaseRequest,
    ShelveRequest,
    TaskRequest,
    TransitionRequest,
    UnshelveRequest,
)
from domain.state_and_mode import PartName
from domain.timebase import to_seconds
from tests.support.http_robot import HttpRobot
from tests.support.operator_verbs import OperatorVerbs


class HttpOperator(OperatorVerbs[Awaitable[Any], Awaitable[str], Awaitable[None]]):
    """Asks over HTTP, and sees that each request is answered with the status of its success."""

    def __init__(self, robot: HttpRobot) -> None:
        self.robot = robot

    async def give(self, given: Input) -> Any:  # noqa: ANN401
        """Send a request and return what its answer says; None: it has no body."""
        answer = await self._send(given)
        return answer.json() if answer.content else None

    async def begin(self, request: ChangeRequest) -> str:
        """Ask for a change and return its path."""
        return str((await self._send(request)).headers["location"])

    async def advance(self, duration_s: float) -> None:
        """Let virtual time pass."""
        await self.robot.pass_time(duration_s)

    async def _send(self, given: Input) -> httpx.Response:
        match given:
            case Readings():
                values = {item.signal: item.value for item in given.items}
                return await self._ask("POST", "/signals", HTTPStatus.OK, json=values)
            case AcknowledgeRequest():
                path = f"{self._error_path(given.part, given.error)}/acknowledge"
                return await self._ask("POST", path, HTTPStatus.OK)
            case ShelveRequest():
                path = f"{self._error_path(given.part, given.error)}/shelf"
                shelf = {"for_s": to_seconds(given.for_), "reason": given.reason}
                return await self._ask("PUT", path, HTTPStatus.OK, json=shelf)
            case UnshelveRequest():
                path = f"{self._error_path(given.part, given.error)}/shelf"
                return await self._ask("DELETE", path, HTTPStatus.NO_CONTENT)
            case ErrorReport():
                path = self._error_path(given.part, given.error)
                report = {
                    "active": given.active,
                    "message": given.message,
                    "value": given.value,
                }
                return await self._ask("POST", path, HTTPStatus.OK, json=report)
            case ModeRequest():
                path, body = f"{self._path(given.part)}/mode", {"mode": given.mode}
                return await self._ask("POST", path, HTTPStatus.ACCEPTED, json=body)
            case TransitionRequest():
                path, body = f"{self._path(given.part)}/state", {"transition": given.transition}
                return await self._ask("POST", path, HTTPStatus.ACCEPTED, json=body)
            case EmergencyStopRequest():
                stop = {"engaged": given.engaged, "reason": given.reason}
                return await self._ask("PUT", "/emergency_stop", HTTPStatus.OK, json=stop)
            case TaskRequest():
                return await self._submit(given)
            case CancelTaskRequest():
                return await self._ask("DELETE", "/tasks/current", HTTPStatus.NO_CONTENT)
            case HoldRequest():
                path, body = f"/holds/{given.owner}", {"reason": given.reason}
                return await self._ask("PUT", path, HTTPStatus.OK, json=body)
            case ReleaseRequest():
                return await self._ask("DELETE", f"/holds/{given.owner}", HTTPStatus.NO_CONTENT)
            case _:
                raise NotImplementedError(given)

    async def _submit(self, task: TaskRequest) -> httpx.Response:
        answer = await self._ask(
            "POST",
            "/tasks",
            HTTPStatus.CREATED,
            content="".join(f"{x},{y},{yaw}\n" for x, y, yaw in task.path.waypoints.tolist()),
            headers={"Content-Type": "text/csv"},
            params={
                "start_index": task.start_index,
                "controller": task.controller,
                "speed_mps": task.speed_mps,
            },
        )
        assert answer.headers["location"] == f"/tasks/{answer.json()['id']}"
        return answer

    def _path(self, part: PartName) -> str:
        kind = "systems" if part in self.robot.supervisor.model.systems else "nodes"
        return f"/{kind}/{part}"

    def _error_path(self, part: PartName | None, error: str) -> str:
        return f"{'' if part is None else self._path(part)}/errors/{error}"

    async def _ask(
        self,
        method: str,
        path: str,
        status: HTTPStatus,
        **sent: Any,  # noqa: ANN401
    ) -> httpx.Response:
        answer = await self.robot.http.request(method, path, **sent)
        assert answer.status_code == status, answer.text
        return answer
