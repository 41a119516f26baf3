import io
import json
import os
import signal
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands.task import TaskOptions, cancel, fault_lines, preview_lines, run_task
from api.client.outcomes import Outcome, ServiceProblemError
from api.client.service_client import ServiceClient
from tests.support.monitor import URL, hello
from tests.support.task_service import PREVIEW, Service, Step, Stream, problem, shows, task

CSV = "0,0,0\n1,0,0\n"


class Driven:
    """What `pilothouse task` did.

    Args:
        service: Answers requests.
        path: The waypoint file.
        stream: What the stream has to say after `hello`.
        options: Further options of the task.
    """

    def __init__(
        self,
        service: Service,
        path: Path,
        *stream: Step,
        **options: Any,  # noqa: ANN401
    ) -> None:
        Stream.connections.append([hello(), *stream])
        self.said: list[str] = []
        self.complaints = io.StringIO()
        asked = TaskOptions(str(path), **options)
        self.outcome: Outcome | None = None
        try:
            self.outcome = run_task(service.client, asked, self.said.append, self.complaints)
        except KeyboardInterrupt:
            self.said.append("interrupted")

    @property
    def after_preview(self) -> list[str]:
        return self.said[3:]


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Service:
    Stream.stand_in(monkeypatch)
    return Service()


@pytest.fixture
def track(tmp_path: Path) -> Path:
    path = tmp_path / "track.csv"
    path.write_text(CSV)
    return path


# --- asking --------------------------------------------------------------------------------------


def test_waypoints_are_previewed_started_and_followed_to_the_end(
    service: Service, track: Path
) -> None:
    driven = Driven(service, track, shows(task(distance_m=5)), shows(task("SUCCEEDED", 10)))

    assert driven.outcome is Outcome.SUCCEEDED
    assert driven.said == [
        f"{track}: 2 waypoints, 799.5 m, some 289 s",
        "  tightest radius 40.0 m (the vehicle can steer 2.5 m)",
        "  start 0.3 m from the vehicle, heading off by 6 degrees",
        "task t1 at 0.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]
    assert service.paths == ["POST /tasks/preview", "POST /tasks"]


def test_the_file_is_sent_as_csv_with_what_was_asked(service: Service, track: Path) -> None:
    Driven(
        service,
        track,
        shows(task("SUCCEEDED")),
        controller="stanley",
        speed_mps=1.5,
        heading="compass",
        columns="s,x,y,yaw",
        start_index=3,
    )

    for request in service.asked[:2]:
        assert request.content == CSV.encode()
        assert request.headers["content-type"] == "text/csv"
        assert dict(request.url.params) == {
            "controller": "stanley",
            "speed_mps": "1.5",
            "heading": "compass",
            "columns": "s,x,y,yaw",
            "start_index": "3",
        }


def test_what_was_not_asked_is_left_to_the_service(service: Service, track: Path) -> None:
    Driven(service, track, shows(task("SUCCEEDED")))

    assert service.paths[1] == "POST /tasks"


def test_a_preview_starts_nothing(service: Service, track: Path) -> None:
    driven = Driven(service, track, preview=True)

    assert driven.outcome is Outcome.SUCCEEDED
    assert service.paths == ["POST /tasks/preview"]


def test_without_waiting_the_task_is_only_started(service: Service, track: Path) -> None:
    service.served = httpx.Response(201, json=task("PAUSED", reason="e-stop is pressed"))

    driven = Driven(service, track, wait=False)

    assert driven.outcome is Outcome.SUCCEEDED
    assert driven.after_preview == ["task t1 is started: paused: e-stop is pressed"]


def test_a_file_that_is_not_there_is_told_before_anything_is_asked(
    service: Service, tmp_path: Path
) -> None:
    driven = Driven(service, tmp_path / "no.csv")

    assert driven.outcome is Outcome.UNKNOWN
    assert "no.csv cannot be read" in driven.complaints.getvalue()
    assert service.asked == []


def test_the_preview_tells_how_the_file_was_read_and_what_to_say_in_options() -> None:
    warning = {"code": "HEADINGS_MISFIT", "message": "off", "index": 2, "hint": "?columns=x,y"}
    read = {"message": "blank-separated: x from column 1"}
    found = {**PREVIEW, "csv": read, "warnings": [warning]}

    said = list(preview_lines("a.csv", found))
    assert said[1] == "  blank-separated: x from column 1"
    assert said[-2:] == [
        "  warning HEADINGS_MISFIT: off (waypoint 2)",
        "  hint: --columns x,y",
    ]


def test_a_file_of_a_spreadsheet_is_sent_as_utf_8(service: Service, track: Path) -> None:
    track.write_bytes("x\ty [°]\r\n0\t0\r\n".encode("utf-16"))
    Driven(service, track, preview=True)

    assert service.asked[0].content == "x\ty [°]\r\n0\t0\r\n".encode()


def test_lines_that_end_with_cr_are_counted() -> None:
    findings = [{"code": "NOT_A_NUMBER", "message": "y: 'x'", "line": 2, "column": 3}]

    assert list(fault_lines("a.csv", "0,0\r1,x\r", {"findings": findings}))[1] == "    1,x"


def test_the_preview_tells_what_is_not_usual() -> None:
    found = {
        **PREVIEW,
        "min_radius_m": None,
        "start": None,
        "approach": {"distance_m": 3.5, "turn_rad": 0.0, "speed_mps": 1.0, "length_m": 7.25},
        "warnings": [
            {"code": "TOO_TIGHT", "message": "a bend", "index": 41},
            {"code": "LONG", "message": "it is long", "index": None},
        ],
    }

    assert list(preview_lines("a.csv", found))[1:] == [
        "  straight",
        "  it is not known where the vehicle is",
        "  the vehicle drives onto the path first: 7.2 m at 1.0 m/s",
        "  warning TOO_TIGHT: a bend (waypoint 41)",
        "  warning LONG: it is long",
    ]


# --- refusals ------------------------------------------------------------------------------------


def test_a_refused_file_is_told_line_by_line_with_a_hint_in_options(
    service: Service, track: Path
) -> None:
    track.write_text("0,0,0\n1,0,x\n")
    findings = [{"code": "NOT_A_NUMBER", "message": "yaw: 'x'", "line": 2, "column": 5}]
    service.preview = problem(422, findings=findings, hint="set ?heading=deg")

    driven = Driven(service, track)

    assert driven.outcome is Outcome.FAILED
    assert driven.complaints.getvalue().splitlines() == [
        f"{track}:2:5: NOT_A_NUMBER yaw: 'x'",
        "    1,0,x",
        "rejected: nothing was started",
        "  hint: set --heading deg",
    ]
    assert service.paths == ["POST /tasks/preview"]


def test_a_finding_without_a_line_of_its_own_is_told_alone() -> None:
    findings = [{"code": "EMPTY_FILE", "message": "nothing", "line": None, "column": None}]

    assert list(fault_lines("a.csv", "", {"findings": findings})) == [
        "a.csv:1:1: EMPTY_FILE nothing",
        "rejected: nothing was started",
    ]


def test_another_refusal_is_handed_on_with_a_hint_in_options(service: Service, track: Path) -> None:
    service.served = problem(422, hint="begin at another waypoint with start_index")

    with pytest.raises(ServiceProblemError) as refused:
        Driven(service, track)

    assert refused.value.problem["hint"] == "begin at another waypoint with --start-index"


def test_ctrl_c_while_a_task_is_submitted_says_that_it_may_go_on(
    service: Service, track: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    call = service.client.call

    def interrupted(method: str, path: str, **rest: Any) -> Any:  # noqa: ANN401
        if (method, path) == ("POST", "/tasks"):
            raise KeyboardInterrupt
        return call(method, path, **rest)

    monkeypatch.setattr(
        ServiceClient, "call", lambda _, *given, **rest: interrupted(*given, **rest)
    )

    driven = Driven(service, track)

    assert driven.said[-2:] == [
        "the task, if it was submitted, goes on; to cancel it: "
        f"pilothouse task --cancel --url {URL}",
        "interrupted",
    ]


def test_ctrl_c_ends_only_the_following_and_says_how_to_cancel(
    service: Service, track: Path
) -> None:
    driven = Driven(service, track, shows(task()), lambda: os.kill(os.getpid(), signal.SIGINT))

    assert driven.said[-2:] == [
        f"task t1 goes on; to cancel it: pilothouse task --cancel --url {URL}",
        "interrupted",
    ]
    assert not any(path.startswith("DELETE") for path in service.paths)


# --- canceling -----------------------------------------------------------------------------------


def test_the_current_task_is_canceled(service: Service) -> None:
    service.current = httpx.Response(200, json=task())
    ended = task("CANCELED", 4, reason="canceled")
    service.by_id = httpx.Response(200, json=ended)
    said: list[str] = []

    assert cancel(service.client, "text", said.append) is Outcome.SUCCEEDED
    assert said == ["task t1 after 4.0 of 10.0 m: canceled"]
    assert service.paths[1] == "DELETE /tasks/current"


def test_programs_get_the_task_that_was_canceled(service: Service) -> None:
    service.current = httpx.Response(200, json=task())
    ended = task("CANCELED", 4, reason="canceled")
    service.by_id = httpx.Response(200, json=ended)
    said: list[str] = []

    assert cancel(service.client, "json", said.append) is Outcome.SUCCEEDED
    assert json.loads(said[0]) == {"task": ended}


def test_programs_get_only_the_task_as_it_ended(service: Service, track: Path) -> None:
    ended = task("SUCCEEDED", 10)
    service.by_id = httpx.Response(200, json=ended)

    driven = Driven(service, track, shows(task(distance_m=5)), shows(ended), is_json=True)

    assert driven.outcome is Outcome.SUCCEEDED
    assert [json.loads(line) for line in driven.said] == [ended]


def test_programs_get_only_the_preview(service: Service, track: Path) -> None:
    driven = Driven(service, track, is_json=True, preview=True)

    assert [json.loads(line) for line in driven.said] == [PREVIEW]


def test_to_cancel_nothing_is_no_failure(service: Service) -> None:
    said: list[str] = []

    assert cancel(service.client, "text", said.append) is Outcome.SUCCEEDED
    assert said == ["there is no task to cancel"]


def test_a_refusal_to_tell_the_task_is_handed_on(service: Service) -> None:
    service.current = problem(403)

    with pytest.raises(ServiceProblemError):
        cancel(service.client, "text", print)


# --- the command line ----------------------------------------------------------------------------


def test_task_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[TaskOptions] = []

    def run_task(_: ServiceClient, asked: TaskOptions, __: object) -> Outcome:
        given.append(asked)
        return Outcome.FAILED

    monkeypatch.setattr("api.cli.commands.task.run_task", run_task)

    assert main(["task", "a.csv"]) == 1
    options = [
        "--controller",
        "stanley",
        "--speed",
        "1.5",
        "--heading",
        "deg",
        "--columns",
        "s,x,y",
    ]
    main(["task", "-", *options, "--start-index", "3", "--preview", "--no-wait"])

    assert given == [
        TaskOptions("a.csv"),
        TaskOptions("-", "stanley", 1.5, "deg", "s,x,y", start_index=3, preview=True, wait=False),
    ]


def test_task_cancels_where_it_is_told_to(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def cancel(client: ServiceClient, *_: object) -> Outcome:
        asked.append(client.address.url)
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.cli.commands.task.cancel", cancel)

    assert main(["task", "--cancel", "--url", "http://robot:9000"]) == 0
    assert asked == ["http://robot:9000"]
