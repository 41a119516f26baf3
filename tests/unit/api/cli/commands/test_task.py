import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands.task import TaskOptions, cancel, fault_lines, preview_lines, run_task
from api.client.address import Address
from api.client.outcomes import NoAnswerError, Outcome, ServiceProblemError
from api.client.service_client import ServiceClient

URL = "http://robot:8000"
CSV = "0,0,0\n1,0,0\n"
PREVIEW: dict[str, Any] = {
    "waypoint_count": 2,
    "length_m": 799.52,
    "min_radius_m": 40.04,
    "vehicle_min_radius_m": 2.5,
    "steerable": True,
    "start": {"distance_m": 0.3, "heading_error_rad": -0.1},
    "duration_s": 289.4,
    "warnings": [],
}


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def task(status: str = "RUNNING", distance_m: float = 0.0, **more: object) -> dict[str, Any]:
    return {
        "id": "t1",
        "status": status,
        "distance_m": distance_m,
        "length_m": 10.0,
        "progress": distance_m / 10,
        "cross_track_error_m": 0.02,
        "reason": None,
        **more,
    }


def problem(status: int, **more: object) -> httpx.Response:
    body = {"status": status, "code": "REFUSED", "title": "Refused", "detail": "it is so", **more}
    return httpx.Response(status, json=body)


class Service:
    """Answers with what a test lays out, and keeps what it was asked."""

    def __init__(self) -> None:
        self.asked: list[httpx.Request] = []
        self.preview = httpx.Response(200, json=PREVIEW)
        self.served = httpx.Response(201, json=task())
        self.current = problem(404)
        self.seen: Iterator[dict[str, Any] | httpx.Response | Exception] = iter(())

    @property
    def client(self) -> ServiceClient:
        return ServiceClient(Address.of(URL), httpx.MockTransport(self._answer))

    @property
    def paths(self) -> list[str]:
        return [f"{request.method} {request.url.raw_path.decode()}" for request in self.asked]

    def _answer(self, request: httpx.Request) -> httpx.Response:
        self.asked.append(request)
        match request.method, request.url.path:
            case "POST", "/tasks/preview":
                return self.preview
            case "POST", "/tasks":
                return self.served
            case "GET", "/tasks/current":
                return self.current
            case "GET", "/vehicle":
                return httpx.Response(200, json={"speed_mps": 2.81})
            case "DELETE", "/tasks/current":
                return httpx.Response(204)
        seen = next(self.seen)
        if isinstance(seen, Exception):
            raise seen
        return seen if isinstance(seen, httpx.Response) else httpx.Response(200, json=seen)


class Driven:
    """What `pilothouse task` did."""

    def __init__(
        self,
        service: Service,
        path: Path,
        *seen: dict[str, Any] | httpx.Response | Exception,
        terminal: bool = False,
        pause: Callable[[float], None] = lambda _: None,
        **options: Any,  # noqa: ANN401
    ) -> None:
        service.seen = iter(seen)
        self.said: list[str] = []
        self.complaints = Terminal() if terminal else io.StringIO()
        asked = TaskOptions(str(path), **options)
        self.outcome: Outcome | None = None
        try:
            self.outcome = run_task(service.client, asked, self.said.append, self.complaints, pause)
        except KeyboardInterrupt:
            self.said.append("interrupted")

    @property
    def after_preview(self) -> list[str]:
        return self.said[3:]


@pytest.fixture
def service() -> Service:
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
    driven = Driven(service, track, task(distance_m=5), task("SUCCEEDED", 10))

    assert driven.outcome is Outcome.SUCCEEDED
    assert driven.said == [
        f"{track}: 2 waypoints, 799.5 m, some 289 s",
        "  tightest radius 40.0 m (the vehicle can steer 2.5 m)",
        "  start 0.3 m from the vehicle, heading off by 6 degrees",
        "task t1 at 0.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]
    assert service.paths == ["POST /tasks/preview", "POST /tasks", *["GET /tasks/t1"] * 2]


def test_the_file_is_sent_as_csv_with_what_was_asked(service: Service, track: Path) -> None:
    Driven(
        service,
        track,
        task("SUCCEEDED"),
        controller="stanley",
        speed_mps=1.5,
        heading="compass",
        start_index=3,
    )

    for request in service.asked[:2]:
        assert request.content == CSV.encode()
        assert request.headers["content-type"] == "text/csv"
        assert dict(request.url.params) == {
            "controller": "stanley",
            "speed_mps": "1.5",
            "heading": "compass",
            "start_index": "3",
        }


def test_what_was_not_asked_is_left_to_the_service(service: Service, track: Path) -> None:
    Driven(service, track, task("SUCCEEDED"))

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

    assert driven.outcome is Outcome.FAILED
    assert "no.csv cannot be read" in driven.complaints.getvalue()
    assert service.asked == []


def test_the_preview_tells_what_is_not_usual() -> None:
    found = {
        **PREVIEW,
        "min_radius_m": None,
        "start": None,
        "warnings": [
            {"code": "TOO_TIGHT", "message": "a bend", "index": 41},
            {"code": "LONG", "message": "it is long", "index": None},
        ],
    }

    assert list(preview_lines("a.csv", found))[1:] == [
        "  straight",
        "  it is not known where the vehicle is",
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
        "refused: nothing is started",
        "  hint: set --heading deg",
    ]
    assert service.paths == ["POST /tasks/preview"]


def test_a_finding_without_a_line_of_its_own_is_told_alone() -> None:
    findings = [{"code": "EMPTY_FILE", "message": "nothing", "line": None, "column": None}]

    assert list(fault_lines("a.csv", "", {"findings": findings})) == [
        "a.csv:1:1: EMPTY_FILE nothing",
        "refused: nothing is started",
    ]


def test_another_refusal_is_handed_on_with_a_hint_in_options(service: Service, track: Path) -> None:
    service.served = problem(422, hint="begin at another waypoint with start_index")

    with pytest.raises(ServiceProblemError) as refused:
        Driven(service, track)

    assert refused.value.problem["hint"] == "begin at another waypoint with --start-index"


# --- following -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("status", "reason", "words"),
    [
        ("CANCELED", "canceled", "canceled"),
        ("CANCELED", "replaced by t2", "canceled: replaced by t2"),
        ("ABORTED", "no progress for 20 s", "aborted: no progress for 20 s"),
    ],
)
def test_an_end_other_than_success_is_told_with_its_reason(
    status: str, reason: str, words: str, service: Service, track: Path
) -> None:
    driven = Driven(service, track, task(status, 4, reason=reason))

    assert driven.outcome is Outcome.FAILED
    assert driven.said[-1] == f"task t1 after 4.0 of 10.0 m: {words}"


def test_without_a_terminal_each_change_of_state_is_a_line(service: Service, track: Path) -> None:
    driven = Driven(
        service,
        track,
        task(distance_m=1),
        task(distance_m=2),
        task("PAUSING", 3, reason="lunch"),
        task("PAUSED", 3.5, reason="lunch"),
        task("PAUSED", 3.5, reason="lunch; e-stop is pressed"),
        task(distance_m=4),
        task("SUCCEEDED", 10),
    )

    assert driven.after_preview == [
        "task t1 at 0.0 of 10.0 m: running",
        "task t1 at 3.0 of 10.0 m: pausing: lunch",
        "task t1 at 3.5 of 10.0 m: paused: lunch",
        "task t1 at 3.5 of 10.0 m: paused: lunch; e-stop is pressed",
        "task t1 at 4.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]
    assert "GET /vehicle" not in service.paths


def test_on_a_terminal_one_line_is_redrawn_and_erased(
    service: Service, track: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")

    driven = Driven(service, track, task("SUCCEEDED", 10), terminal=True)

    assert driven.complaints.getvalue() == (
        "\r\x1b[2K[...............]   0% 0.0 of 10.0 m  2.8 m/s  +0.02 m off  running\r\x1b[2K"
    )
    assert driven.after_preview == ["task t1 after 10.0 of 10.0 m: succeeded"]


def test_a_held_task_shows_its_reason_within_80_columns(
    service: Service, track: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    held = task("PAUSED", 6, reason="e-stop is pressed", length_m=1234.5)
    service.served = httpx.Response(201, json=held)

    driven = Driven(service, track, task("SUCCEEDED", 10), terminal=True)

    shown = driven.complaints.getvalue().split("\r\x1b[2K")[1]
    assert shown == "[#########......]  60% 6.0 of 1234.5 m  paused: e-stop is pressed"


def test_what_is_not_known_of_the_vehicle_is_not_made_up(
    service: Service, track: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ServiceClient, "call", _without_speed(ServiceClient.call))
    service.served = httpx.Response(201, json=task(cross_track_error_m=None))

    driven = Driven(service, track, task("SUCCEEDED", 10), terminal=True)

    assert "0.0 of 10.0 m  ? m/s  running" in driven.complaints.getvalue()


def _without_speed(call: Callable[..., Any]) -> Callable[..., Any]:
    def called(self: ServiceClient, method: str, path: str, **more: Any) -> Any:  # noqa: ANN401
        return {"speed_mps": None} if path == "/vehicle" else call(self, method, path, **more)

    return called


def test_ctrl_c_ends_only_the_following_and_says_how_to_cancel(
    service: Service, track: Path
) -> None:
    def interrupt(_: float) -> None:
        raise KeyboardInterrupt

    driven = Driven(service, track, pause=interrupt)

    assert driven.said[-2:] == [
        f"task t1 goes on; to cancel it: pilothouse task --cancel --url {URL}",
        "interrupted",
    ]
    assert not any(path.startswith("DELETE") for path in service.paths)


def test_a_service_that_does_not_know_the_task_any_more_leaves_its_end_unknown(
    service: Service, track: Path
) -> None:
    driven = Driven(service, track, problem(404))

    assert driven.outcome is Outcome.UNKNOWN
    assert driven.said[-1] == "task t1: what became of it is not known: it is so"


def test_a_service_that_does_not_answer_any_more_is_told(service: Service, track: Path) -> None:
    with pytest.raises(NoAnswerError):
        Driven(service, track, httpx.ReadTimeout("slow"))


# --- canceling -----------------------------------------------------------------------------------


def test_the_current_task_is_canceled(service: Service) -> None:
    service.current = httpx.Response(200, json=task())
    service.seen = iter([task("CANCELED", 4, reason="canceled")])
    said: list[str] = []

    assert cancel(service.client, said.append) is Outcome.SUCCEEDED
    assert said == ["task t1 after 4.0 of 10.0 m: canceled"]
    assert service.paths[1] == "DELETE /tasks/current"


def test_to_cancel_nothing_is_no_failure(service: Service) -> None:
    said: list[str] = []

    assert cancel(service.client, said.append) is Outcome.SUCCEEDED
    assert said == ["there is no task to cancel"]


def test_a_refusal_to_tell_the_task_is_handed_on(service: Service) -> None:
    service.current = problem(403)

    with pytest.raises(ServiceProblemError):
        cancel(service.client, print)


# --- the command line ----------------------------------------------------------------------------


def test_task_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[TaskOptions] = []

    def run_task(_: ServiceClient, asked: TaskOptions, __: object) -> Outcome:
        given.append(asked)
        return Outcome.FAILED

    monkeypatch.setattr("api.cli.commands.task.run_task", run_task)

    assert main(["task", "a.csv"]) == 1
    options = ["--controller", "stanley", "--speed", "1.5", "--heading", "deg"]
    main(["task", "-", *options, "--start-index", "3", "--preview", "--no-wait"])

    assert given == [
        TaskOptions("a.csv"),
        TaskOptions("-", "stanley", 1.5, "deg", 3, preview=True, wait=False),
    ]


def test_task_cancels_where_it_is_told_to(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def cancel(client: ServiceClient, _: object) -> Outcome:
        asked.append(client.url)
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.cli.commands.task.cancel", cancel)

    assert main(["task", "--cancel", "--url", "http://robot:9000"]) == 0
    assert asked == ["http://robot:9000"]
