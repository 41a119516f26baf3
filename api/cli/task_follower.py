"""Follows a task to its end over the stream of the service, and reports its progress."""

import asyncio
from collections.abc import Callable

from api.cli.first_ended import until_first_ends
from api.cli.task_text import distance_text, progress_text, status_text
from api.cli.terminal_line import TerminalLine
from api.client.link import Link
from api.client.outcomes import Json, NoAnswerError, Outcome, ServiceProblemError
from api.client.service_client import ServiceClient

REDRAW_S = 0.2
"""Least time between two redraws of the progress line."""

_PATIENCE_S = 30.0
"""Time to reconnect; enough for a restart of the service on a slow computer."""
_TOPICS = ("task", "vehicle")
_ENDS = {
    "SUCCEEDED": Outcome.SUCCEEDED,
    "CANCELED": Outcome.FAILED,
    "ABORTED": Outcome.FAILED,
}

Say = Callable[[str], None]


def follow_task(client: ServiceClient, task: Json, say: Say, line: TerminalLine) -> Outcome:
    """Report the progress of a task until it ends.

    On a terminal the progress line is redrawn; elsewhere each change of status is a line.

    Args:
        client: Sends requests to the service.
        task: The task, as answered to its submission.
        say: Prints a line.
        line: The progress line.

    Raises:
        NoAnswerError: The service cannot be reached any more.
    """
    report = _Report(say, line)
    if not line.is_shown:
        # On a terminal, wait for a frame: it has the speed.
        report.show(task, None)
    try:
        while task["status"] not in _ENDS:
            ended = asyncio.run(_ended_task(client, task, report))
            # The service shows another task: ours was replaced. A frame from before the submission
            # looks the same; then the task has not ended, and we follow it again.
            task = ended or client.call("GET", f"/tasks/{task['id']}")
    except ServiceProblemError as error:
        line.erase()
        say(f"task {task['id']}: what became of it is not known: {error}")
        return Outcome.UNKNOWN
    line.erase()
    say(f"task {task['id']} after {distance_text(task)}: {status_text(task)}")
    return _ENDS[task["status"]]


async def _ended_task(client: ServiceClient, task: Json, report: "_Report") -> Json | None:
    """Follow a task until it ends, and return it; None: the service shows another task.

    Raises:
        ServiceProblemError: The service was restarted and kept nothing, or denied access.
        NoAnswerError: The service cannot be reached any more.
    """
    follower = _Follower(task, report)
    await until_first_ends(Link(client.address, follower, _TOPICS).run(), follower.wait())
    return follower.ended.result()


class _Report:
    """Reports progress: on a terminal in one line, elsewhere each change of status."""

    def __init__(self, say: Say, line: TerminalLine) -> None:
        self._say = say
        self._line = line
        self._reported = ""

    def show(self, task: Json, speed_mps: float | None) -> None:
        """Report the progress of the task.

        Args:
            task: The task.
            speed_mps: Speed of the vehicle in m/s; None: unknown.
        """
        if self._line.is_shown:
            self._line.show(progress_text(task, speed_mps))
        elif self._reported != (status := status_text(task)):
            self._reported = status
            self._say(f"task {task['id']} at {distance_text(task)}: {status}")

    def remark(self, task: Json, message: str) -> None:
        """Report something besides the progress; this line stays on a terminal."""
        self._line.erase()
        self._say(f"task {task['id']}: {message}")

    def show_lost(self, task: Json, why: str) -> None:
        """Report that the connection is lost; the next status is reported again."""
        self._reported = ""
        if self._line.is_shown:
            # Without this, the text would be left out if it came too soon after the last one.
            self._line.erase()
            self._line.show(f"reconnecting: {why}")
        else:
            self._say(f"task {task['id']}: reconnecting: {why}")


class _Follower:
    """Listens to the stream until the task ends, is replaced, or is lost."""

    def __init__(self, task: Json, report: _Report) -> None:
        self.ended: asyncio.Future[Json | None] = asyncio.get_running_loop().create_future()
        """The ended task; None: the service shows another one."""
        self._task = task
        self._report = report
        self._speed_mps: float | None = None
        self._alarm: str | None = None
        self._epoch: str | None = None
        self._boot = 0
        self._why_lost = ""
        self._giving_up: asyncio.TimerHandle | None = None

    async def wait(self) -> None:
        """Wait until there is nothing to follow any more.

        Raises:
            ServiceProblemError: The service was restarted, and kept nothing.
            NoAnswerError: The service cannot be reached any more.
        """
        await self.ended

    def take(self, message: Json) -> None:
        """Process a frame of the stream."""
        if self.ended.done():
            return
        match message["type"]:
            case "hello":
                self._check_epoch(message["epoch"], message["boot"])
            case "state":
                self._keep_following()
                self._take_state(message)

    def lose(self, why: str) -> None:
        """Report a lost connection, and give up if reconnecting takes too long."""
        self._why_lost = why
        if self._giving_up is None:
            self._report.show_lost(self._task, why)
            loop = asyncio.get_running_loop()
            self._giving_up = loop.call_later(_PATIENCE_S, self._give_up)

    def _check_epoch(self, epoch: str, boot: int) -> None:
        """Report a restart of the service; end if it kept nothing, since ids begin again then."""
        before, self._epoch = self._epoch, epoch
        is_kept, self._boot = boot > self._boot, boot
        if before in (None, epoch):
            return
        if is_kept:
            self._report.remark(self._task, "the service was restarted")
        else:
            problem = {"detail": "the service was restarted"}
            self.ended.set_exception(ServiceProblemError(problem))

    def _take_state(self, frame: Json) -> None:
        if "vehicle" in frame:
            self._take_vehicle(frame["vehicle"])
        if "task" in frame:
            shown = frame["task"]
            if shown is None or shown["id"] != self._task["id"]:
                self.ended.set_result(None)
                return
            self._task = shown
            if shown["status"] in _ENDS:
                self.ended.set_result(shown)
                return
        self._report.show(self._task, self._speed_mps)

    def _take_vehicle(self, vehicle: Json) -> None:
        self._speed_mps = vehicle["speed_mps"]
        found = vehicle.get("still_moving")
        before, self._alarm = self._alarm, found and found["message"]
        if self._alarm not in (None, before):
            self._report.remark(self._task, self._alarm)

    def _keep_following(self) -> None:
        if self._giving_up is not None:
            self._giving_up.cancel()
            self._giving_up = None

    def _give_up(self) -> None:
        if not self.ended.done():
            self.ended.set_exception(NoAnswerError(self._why_lost))
