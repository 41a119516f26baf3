"""What one HTTP request is told about what it asked for."""

from types import SimpleNamespace

import pytest
from fastapi import APIRouter, FastAPI, Request
from httpx import ASGITransport, AsyncClient

from api.http.kept_requests import DURABLE, KeptRequests, VolatileDep
from api.http.limits import ServiceLimits
from api.http.request_body import JsonRoute
from domain.inputs import HoldRequest, Input
from domain.outbox import NOTHING, Outputs
from service.keeper import Taken

HOLD = HoldRequest("operator", "lunch")


class Robot:
    """The used part of a supervisor."""

    def __init__(self, journal: object) -> None:
        self.journal = journal
        self.asked: list[tuple[Input, bool]] = []

    async def request(self, given: Input, *, volatile: bool = False) -> Taken:
        self.asked.append((given, volatile))
        return Taken(NOTHING, is_durable=not volatile)


def request_to(robot: Robot, told: list[bool]) -> KeptRequests:
    app = SimpleNamespace(state=SimpleNamespace(supervisor=robot))
    return KeptRequests(Request({"type": "http", "app": app, DURABLE: told}))


async def submit(robot: Robot, *, volatile: bool = False) -> tuple[Outputs, list[bool]]:
    told: list[bool] = []
    return await request_to(robot, told).submit(HOLD, volatile=volatile), told


@pytest.mark.parametrize("volatile", [False, True])
async def test_the_answer_is_told_whether_the_outcome_is_on_disk(volatile: bool) -> None:
    robot = Robot(journal=object())

    outputs, told = await submit(robot, volatile=volatile)

    assert outputs is NOTHING
    assert robot.asked == [(HOLD, volatile)]
    assert told == [not volatile]


async def test_of_a_robot_that_keeps_nothing_nothing_is_told() -> None:
    assert (await submit(Robot(journal=None)))[1] == []


@pytest.mark.parametrize(
    ("query", "body", "is_volatile"),
    [
        ("", "", False),
        ("", "{}", False),
        ("", '{"volatile": false}', False),
        ("", '{"volatile": true}', True),
        ("?volatile=true", "", True),
        ("?volatile=true", "{}", True),
    ],
)
async def test_a_request_says_in_its_query_or_its_body_that_it_may_be_forgotten(
    query: str, body: str, is_volatile: bool
) -> None:
    router = APIRouter(route_class=JsonRoute)

    @router.post("/seen")
    async def see(volatile: VolatileDep) -> bool:
        return volatile

    app = FastAPI()
    app.include_router(router)
    app.state.limits = ServiceLimits()
    client = AsyncClient(transport=ASGITransport(app), base_url="http://robot")

    answer = await client.post(f"/seen{query}", content=body)

    assert answer.json() is is_volatile
