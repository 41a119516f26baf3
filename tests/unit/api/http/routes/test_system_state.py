"""`/system_state` and the acknowledgement of errors."""

from dataclasses import replace

from domain.health.signals import Recovery, default_signals
from domain.supervision import SupervisionSettings
from tests.support.http_robot import HttpRobot, http_robot


async def test_a_robot_with_good_signals_and_no_task_is_idle(robot: HttpRobot) -> None:
    state = await robot.get("/system_state")

    assert state == {
        "seq": robot.supervisor.publisher.seq,
        "at": "2026-01-01T00:00:00.000Z",
        "state": "IDLE",
        "error_code": 0,
        "errors": [],
        "reasons": [],
        "task_status": "NO_TASK",
        "simulated": ["nodes", "signals", "vehicle"],
        "storage_fault": None,
    }


async def test_without_any_reading_the_robot_is_in_error_and_says_what_is_missing() -> None:
    async with http_robot(mock=False) as robot:
        state = await robot.get("/system_state")

        assert (state["state"], state["errors"]) == ("ERROR", ["STALE_DATA"])
        assert len(state["reasons"]) == 5
        assert state["simulated"] == ["nodes", "vehicle"]


async def test_an_error_that_wants_it_ends_only_when_it_is_acknowledged() -> None:
    signals = tuple(replace(signal, recovery=Recovery.ACKNOWLEDGE) for signal in default_signals())
    settings = SupervisionSettings(signals=signals)
    async with http_robot(settings=settings) as robot:
        await robot.http.post("/signals/estop", json={"value": True})
        await robot.http.post("/signals/estop", json={"value": False})
        await robot.pass_time(1)
        assert (await robot.get("/system_state"))["errors"] == ["ESTOP"]

        answer = await robot.http.post("/errors/ESTOP/acknowledge")

        assert (answer.status_code, answer.json()["state"]) == (200, "IDLE")


async def test_an_error_that_there_is_not_cannot_be_acknowledged(robot: HttpRobot) -> None:
    answer = await robot.http.post("/errors/BOREDOM/acknowledge")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_ERROR")
