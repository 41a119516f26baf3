"""Events at the command line."""

import json
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands import events
from api.client.outcomes import Json
from tests.support.asked_service import AskedService

Output = pytest.CaptureFixture[str]


def event(number: int, **more: object) -> dict[str, Any]:
    return {
        "type": "event",
        "id": number,
        "at": "2026-05-04T12:00:00.250Z",
        "kind": "hold.set",
        "actor": "http:10.0.0.7",
        "words": f"hold {number} set",
        **more,
    }


def page(*items: Json, epoch: str = "e1", newest: int | None = None, **more: object) -> Json:
    last = newest if newest is not None else max((item["id"] for item in items), default=0)
    return {"epoch": epoch, "oldest": 1, "newest": last, "gaps": [], "items": items, **more}


@pytest.fixture
def service(monkeypatch: pytest.MonkeyPatch) -> AskedService:
    service = AskedService({"GET /events?limit=20": page(event(7), event(8, actor=""))})
    service.stand_in(monkeypatch)
    return service


def test_the_newest_events_are_listed_a_line_each(service: AskedService, capsys: Output) -> None:
    assert main(["events"]) == 0

    assert capsys.readouterr().out.splitlines() == [
        "2026-05-04T12:00:00.250Z       7  hold.set                hold 7 set  [http:10.0.0.7]",
        "2026-05-04T12:00:00.250Z       8  hold.set                hold 8 set",
    ]
    assert not service.writes


def test_what_is_wanted_is_asked_of_the_service(service: AskedService) -> None:
    wanted = ["--kind", "error.*", "--part", "arm", "--actor", "me", "--limit", "5"]

    main(["events", *wanted, "--since", "10min"])

    ((_, path, _),) = service.asked
    query = httpx.URL(f"http://x{path}").params
    assert (query["kind"], query["part"], query["actor"], query["limit"]) == (
        "error.*",
        "arm",
        "me",
        "5",
    )
    assert query["from_at"].endswith("+00:00")


def test_programs_get_one_object_a_line(service: AskedService, capsys: Output) -> None:
    assert main(["events", "--format", "json"]) == 0

    assert [json.loads(line)["id"] for line in capsys.readouterr().out.splitlines()] == [7, 8]
    assert service.asked


def test_a_text_cannot_steer_the_terminal(service: AskedService, capsys: Output) -> None:
    service.answers["GET /events?limit=20"] = page(event(7, words="\x1b[2Jgone"))

    main(["events"])

    assert "\x1b" not in capsys.readouterr().out


class Followed:
    """What `follow` told, until there was nothing more to come."""

    def __init__(self, service: AskedService, found: Json, pages: dict[str, Any]) -> None:
        service.answers |= {f"GET /events?{query}": answer for query, answer in pages.items()}
        self.told: list[int] = []
        with pytest.raises(KeyboardInterrupt):
            events.follow(
                service.client(), {}, found, lambda told: self.told.append(told["id"]), self.pause
            )
        self.queries = [path.partition("?")[2] for _, path, _ in service.asked]

    rounds = 3

    def pause(self, _: float) -> None:
        self.rounds -= 1
        if self.rounds == 0:
            raise KeyboardInterrupt


def test_events_are_followed_from_the_last_one(service: AskedService) -> None:
    followed = Followed(
        service,
        page(event(8)),
        {
            "after=8&epoch=e1&limit=1000": page(event(9), event(10)),
            "after=10&epoch=e1&limit=1000": [page(newest=10), page(event(11))],
        },
    )

    assert followed.told == [9, 10, 11]


def test_what_a_filter_leaves_out_is_not_asked_for_again(service: AskedService) -> None:
    followed = Followed(
        service,
        page(event(8)),
        {
            "after=8&epoch=e1&limit=1000": [page(newest=50), page(newest=60)],
            "after=50&epoch=e1&limit=1000": page(event(55), newest=70),
        },
    )

    assert followed.queries[-1].startswith("after=50")
    assert followed.told == [55]


def test_a_lost_connection_and_a_restart_are_told(service: AskedService, capsys: Output) -> None:
    followed = Followed(
        service,
        page(event(8)),
        {
            "after=8&epoch=e1&limit=1000": [
                httpx.ConnectError("refused"),
                page(event(1), epoch="e2", gaps=[{"from": 9, "to": None}]),
            ],
            "after=1&epoch=e2&limit=1000": page(event(5), epoch="e2", gaps=[{"from": 2, "to": 4}]),
        },
    )

    assert followed.told == [1, 5]
    told = capsys.readouterr().err.splitlines()
    assert told[0].endswith("is it running?; trying again")
    assert told[1:] == [
        "pilothouse: connected again",
        "pilothouse: the service was restarted, and does not keep what happened before",
        "pilothouse: events 2 to 4 are not kept",
    ]


def test_ctrl_c_is_how_following_ends(
    service: AskedService, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(events, "follow", interrupt)

    assert main(["events", "--follow"]) == 0
    assert service.asked
