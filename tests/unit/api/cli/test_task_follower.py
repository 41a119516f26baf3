import io

import httpx
import pytest

from api.cli import task_follower
from api.cli.task_follower import REDRAW_S, follow_task
from api.cli.terminal_line import TerminalLine
from api.client.outcomes import Json, NoAnswerError, Outcome, ServiceProblemError
from tests.support.monitor import frame, hello
from tests.support.task_service import Loss, Service, Step, Stream, Terminal, problem, shows, task

MOVING = {"speed_mps": 2.81}


class Followed:
    """What came of following the task.

    Args:
        service: Answers requests.
        stream: What the stream has to say after `hello`.
        terminal: Whether there is a terminal.
        redraw_s: Least time between two redraws.
    """

    def __init__(
        self, service: Service, *stream: Step, terminal: bool = False, redraw_s: float = REDRAW_S
    ) -> None:
        Stream.connections.append([hello(), *stream])
        self.said: list[str] = []
        out = Terminal() if terminal else io.StringIO()
        with TerminalLine(out, redraw_s) as line:
            self.outcome = follow_task(service.client, task(), self.said.append, line)
        self.shown = out.getvalue()


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> Service:
    Stream.stand_in(monkeypatch)
    return Service()


@pytest.mark.parametrize(
    ("status", "reason", "words"),
    [
        ("CANCELED", "canceled", "canceled"),
        ("CANCELED", "replaced by t2", "canceled: replaced by t2"),
        ("ABORTED", "no progress for 20 s", "aborted: no progress for 20 s"),
    ],
)
def test_an_end_other_than_success_is_told_with_its_reason(
    status: str, reason: str, words: str, service: Service
) -> None:
    followed = Followed(service, shows(task(status, 4, reason=reason)))

    assert followed.outcome is Outcome.FAILED
    assert followed.said[-1] == f"task t1 after 4.0 of 10.0 m: {words}"


def test_following_asks_for_nothing_and_hears_only_of_task_and_vehicle(service: Service) -> None:
    Followed(service, frame(), shows(task("SUCCEEDED", 10)))

    assert Stream.topics == ("task", "vehicle")
    assert service.paths == []


def test_without_a_terminal_each_change_of_state_is_a_line(service: Service) -> None:
    followed = Followed(
        service,
        shows(task(distance_m=1)),
        shows(task(distance_m=2)),
        shows(task("PAUSING", 3, reason="lunch")),
        shows(task("PAUSED", 3.5, reason="lunch")),
        shows(task("PAUSED", 3.5, reason="lunch; e-stop is pressed")),
        shows(task(distance_m=4)),
        shows(task("SUCCEEDED", 10)),
    )

    assert followed.said == [
        "task t1 at 0.0 of 10.0 m: running",
        "task t1 at 3.0 of 10.0 m: pausing: lunch",
        "task t1 at 3.5 of 10.0 m: paused: lunch",
        "task t1 at 3.5 of 10.0 m: paused: lunch; e-stop is pressed",
        "task t1 at 4.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]


def test_on_a_terminal_one_line_is_redrawn_and_erased(
    service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")

    followed = Followed(
        service, shows(task(), vehicle=MOVING), shows(task("SUCCEEDED", 10)), terminal=True
    )

    assert followed.shown == (
        "\r\x1b[2K[...............]   0% 0.0 of 10.0 m  2.8 m/s  +0.02 m off  running\r\x1b[2K"
    )
    assert followed.said == ["task t1 after 10.0 of 10.0 m: succeeded"]


def test_the_line_is_redrawn_five_times_a_second_however_many_frames_come(service: Service) -> None:
    frames = [shows(task(distance_m=number / 100), vehicle=MOVING) for number in range(100)]
    frames.append(shows(task("SUCCEEDED", 10)))

    followed = Followed(service, *frames, terminal=True, redraw_s=60.0)

    assert followed.shown.count("running") == 1
    assert REDRAW_S == 0.2


def test_a_frame_without_news_of_the_task_still_brings_the_speed(service: Service) -> None:
    followed = Followed(
        service,
        shows(task(distance_m=5), vehicle=MOVING),
        frame(vehicle={"speed_mps": 1.5}),
        shows(task("SUCCEEDED", 10)),
        terminal=True,
        redraw_s=0.0,
    )

    assert "5.0 of 10.0 m  1.5 m/s" in followed.shown


@pytest.mark.parametrize("terminal", [False, True])
def test_a_vehicle_that_should_stand_and_does_not_is_told_once_and_again_when_it_changes(
    service: Service, terminal: bool
) -> None:
    def moving(message: str | None) -> Json:
        found = None if message is None else {"code": "STILL_MOVING", "message": message}
        return {"speed_mps": 2.0, "still_moving": found}

    followed = Followed(
        service,
        shows(task("PAUSING", 3, reason="lunch"), vehicle=moving("it moved at 2.6 m/s")),
        frame(vehicle=moving("it moved at 2.6 m/s")),
        frame(vehicle=moving(None)),
        frame(vehicle=moving("there was no pose")),
        shows(task("SUCCEEDED", 10)),
        terminal=terminal,
    )

    told = [line for line in followed.said if line.startswith("task t1: ")]
    assert told == ["task t1: it moved at 2.6 m/s", "task t1: there was no pose"]


def test_a_held_task_shows_its_reason_within_80_columns(
    service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    held = task("PAUSED", 6, reason="e-stop is pressed", length_m=1234.5)

    followed = Followed(service, shows(held), shows(task("SUCCEEDED", 10)), terminal=True)

    shown = followed.shown.split("\r\x1b[2K")[1]
    assert shown == "[#########......]  60% 6.0 of 1234.5 m  paused: e-stop is pressed"


def test_what_is_not_known_of_the_vehicle_is_not_made_up(service: Service) -> None:
    unknown = shows(task(cross_track_error_m=None), vehicle={"speed_mps": None})

    followed = Followed(service, unknown, shows(task("SUCCEEDED", 10)), terminal=True)

    assert "0.0 of 10.0 m  ? m/s  running" in followed.shown


# --- a task that leaves the stream ---------------------------------------------------------------


def test_who_is_replaced_asks_once_how_the_task_ended(service: Service) -> None:
    replaced = task("CANCELED", 4, reason="replaced by t2")
    service.by_id = httpx.Response(200, json=replaced)

    followed = Followed(service, shows(task()), shows(task(id="t2")), shows(task(id="t3")))

    assert followed.outcome is Outcome.FAILED
    assert followed.said[-1] == "task t1 after 4.0 of 10.0 m: canceled: replaced by t2"
    assert service.paths == ["GET /tasks/t1"]


@pytest.mark.parametrize("before", [None, task("SUCCEEDED", 10, id="t0")])
def test_a_frame_from_before_the_submission_does_not_end_the_following(
    service: Service, before: Json | None
) -> None:
    service.by_id = httpx.Response(200, json=task())
    Stream.connections.append([hello(), shows(before)])

    followed = Followed(service, shows(task(distance_m=1)), shows(task("SUCCEEDED", 10)))

    assert followed.outcome is Outcome.SUCCEEDED
    assert followed.said == [
        "task t1 at 0.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]


def test_a_service_that_does_not_know_the_task_any_more_leaves_its_end_unknown(
    service: Service,
) -> None:
    service.by_id = problem(404)

    followed = Followed(service, shows(None))

    assert followed.outcome is Outcome.UNKNOWN
    assert followed.said[-1] == "task t1: what became of it is not known: it is so"


def test_a_service_that_does_not_answer_that_request_is_told(service: Service) -> None:
    service.by_id = httpx.ReadTimeout("slow")

    with pytest.raises(NoAnswerError):
        Followed(service, shows(None))


# --- a stream that breaks ------------------------------------------------------------------------


def test_after_a_short_loss_the_following_goes_on(service: Service) -> None:
    followed = Followed(
        service,
        shows(task(distance_m=1)),
        Loss("the connection broke"),
        Loss("no service answers"),
        hello(),
        shows(task(distance_m=3)),
        shows(task("SUCCEEDED", 10)),
    )

    assert followed.outcome is Outcome.SUCCEEDED
    assert followed.said == [
        "task t1 at 0.0 of 10.0 m: running",
        "task t1: reconnecting: the connection broke",
        "task t1 at 3.0 of 10.0 m: running",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]


def test_on_a_terminal_a_loss_is_shown_at_once(service: Service) -> None:
    followed = Followed(
        service,
        shows(task()),
        Loss("the connection broke"),
        shows(task("SUCCEEDED", 10)),
        terminal=True,
    )

    assert followed.shown.endswith("\r\x1b[2Kreconnecting: the connection broke\r\x1b[2K")


def test_a_task_that_outlived_a_restart_of_the_service_is_followed_to_its_end(
    service: Service,
) -> None:
    followed = Followed(
        service,
        shows(task()),
        Loss("the connection broke"),
        hello("two", boot=2),
        shows(task("PAUSED", 4, reason="restart")),
        shows(task("SUCCEEDED", 10)),
    )

    assert followed.outcome is Outcome.SUCCEEDED
    assert followed.said == [
        "task t1 at 0.0 of 10.0 m: running",
        "task t1: reconnecting: the connection broke",
        "task t1: the service was restarted",
        "task t1 at 4.0 of 10.0 m: paused: restart",
        "task t1 after 10.0 of 10.0 m: succeeded",
    ]


def test_a_service_that_was_restarted_leaves_the_end_unknown_though_it_has_a_task_of_that_id(
    service: Service,
) -> None:
    followed = Followed(
        service,
        shows(task()),
        Loss("the connection broke"),
        hello("two"),
        shows(task("SUCCEEDED", 10)),
    )

    assert followed.outcome is Outcome.UNKNOWN
    assert followed.said[-1] == "task t1: what became of it is not known: the service was restarted"


def test_a_service_that_stays_away_is_told_with_the_last_reason(
    service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(task_follower, "_PATIENCE_S", 0.01)

    with pytest.raises(NoAnswerError, match="no service answers"):
        Followed(service, shows(task()), Loss("it broke"), Loss("no service answers"))


def test_a_service_that_lets_us_in_no_more_leaves_the_end_unknown(service: Service) -> None:
    denied = ServiceProblemError({"detail": "a token is needed"})

    followed = Followed(service, shows(task()), Loss("the connection broke"), denied)

    assert followed.outcome is Outcome.UNKNOWN
    assert followed.said[-1] == "task t1: what became of it is not known: a token is needed"
