"""The vehicle is watched until it stands still."""

import pytest

from api.cli import standstill
from api.cli.standstill import Standstill
from api.client.bare_request import Answer
from api.client.outcomes import Json, NoAnswerError

ENGAGED = {"engaged": True, "standstill_at": None}
STILL = {"engaged": True, "standstill_at": "2026-05-04T12:00:01.000Z"}


class Robot:
    """A vehicle that brakes from look to look."""

    def __init__(self, *speeds_mps: float | None, latch: Json = STILL) -> None:
        self.speeds_mps = list(speeds_mps)
        self.latch = latch
        self.looks = 0

    def ask(self, _: str, path: str, __: float) -> Answer:
        if path == "/emergency_stop":
            return Answer(200, self.latch if not self.speeds_mps else ENGAGED, is_volatile=False)
        self.looks += 1
        speed_mps = self.speeds_mps.pop(0) if self.speeds_mps else 0.0
        at = None if speed_mps is None else f"2026-05-04T12:00:00.{self.looks:03}Z"
        return Answer(200, {"at": at, "speed_mps": speed_mps}, is_volatile=False)

    def watch(self, within_s: float = 10.0, *, is_quiet: bool = False) -> Standstill:
        still = Standstill(self.ask, ENGAGED, is_quiet=is_quiet)
        still.wait(within_s)
        return still


@pytest.fixture(autouse=True)
def quickly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standstill, "LOOK_S", 0.0)
    monkeypatch.setattr(standstill, "_POLL_S", 0.0)


def test_the_speed_is_told_until_the_vehicle_stands_still(
    capsys: pytest.CaptureFixture[str],
) -> None:
    still = Robot(2.8, 1.4).watch()

    assert still.is_still
    assert still.words() == "the vehicle stands still"
    assert capsys.readouterr().out == "2.80 m/s\n1.40 m/s\n"


def test_nothing_is_told_where_programs_read(capsys: pytest.CaptureFixture[str]) -> None:
    assert Robot(2.8).watch(is_quiet=True).is_still
    assert capsys.readouterr() == ("", "")


def test_a_vehicle_that_still_moves_at_the_end_is_told_with_what_to_do() -> None:
    still = Robot(-0.4, 0.4, 0.4, latch=ENGAGED).watch(within_s=0.0)

    assert still.is_still is False
    assert still.words() == "the vehicle still moves at 0.40 m/s: use the hardware stop"


def test_of_a_vehicle_that_does_not_report_it_is_not_known() -> None:
    still = Robot(None, latch=ENGAGED).watch(within_s=0.0)

    assert still.is_still is None
    assert "not known whether the vehicle stands still: the vehicle does not" in still.words()


def test_of_an_old_report_it_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standstill, "_OLD_S", -1.0)

    assert Robot(2.8, latch=ENGAGED).watch(within_s=0.0).speed_mps is None


def test_a_lost_connection_is_told() -> None:
    def ask(*_: object) -> Answer:
        raise NoAnswerError("no answer from http://robot")

    still = Standstill(ask, ENGAGED, is_quiet=True)
    still.wait(0.0)

    assert still.is_engaged
    assert still.words().endswith("stands still: no answer from http://robot")


def test_a_stop_that_somebody_releases_is_not_waited_for() -> None:
    still = Robot(latch={"engaged": False, "standstill_at": None}).watch(within_s=60.0)

    assert not still.is_engaged
    assert still.words() == "somebody has released the stop meanwhile"
