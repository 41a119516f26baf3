import pytest

from domain.actor import Actor
from domain.events.event import RecordedEvent
from domain.health.emergency_stop import EmergencyStop
from domain.health.health import Health
from domain.health.signals import default_signals
from domain.inputs import EmergencyStopRequest, Restored
from domain.kept import Kept, KeptEmergencyStop
from domain.outbox import Outbox
from domain.restart import Restart
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant

RELEASED = EmergencyStopView(engaged=False, by=None, reason=None, since=None, standstill_at=None)


class Robot:
    """A robot of which nothing but its emergency stop is of interest."""

    def __init__(self, now: Instant = 0) -> None:
        self.now = now
        self.kept: list[Kept | None] = []
        """What was kept in the last step."""
        self.outbox = Outbox()
        self.health = Health(default_signals(), self.outbox, now)
        self.stop = EmergencyStop(self.health, self.outbox)

    def engage(self, by: str, reason: str, now: int) -> list[str]:
        self.stop.take_request(EmergencyStopRequest(True, reason, Actor(by)), now)
        return self._told()

    def release(self, by: str, reason: str, now: int) -> list[str]:
        self.stop.take_request(EmergencyStopRequest(False, reason, Actor(by)), now)
        return self._told()

    def stand(self, now: int) -> list[str]:
        self.stop.note_standstill(now)
        return self._told()

    def restore(self, *kept: KeptEmergencyStop, stop_because: str = "") -> list[str]:
        restored = Restored(kept, stop_because=stop_because)
        Restart(self.outbox).take_restored(restored, self.now)
        self.stop.restore(restored, self.now)
        return self._told()

    def _told(self) -> list[str]:
        outputs = self.outbox.take()
        self.kept = [item.value for item in outputs.kept]
        events: tuple[RecordedEvent, ...] = outputs.events
        return [event.kind for event in events]


def test_it_starts_released_by_nobody() -> None:
    assert Robot().stop.view() == RELEASED


def test_it_shows_who_engaged_it_why_and_when() -> None:
    robot = Robot()

    assert robot.engage("anna", "child on the track", 7)[0] == "emergency_stop.engaged"
    assert robot.stop.view() == EmergencyStopView(
        engaged=True, by="anna", reason="child on the track", since=7, standstill_at=None
    )


def test_it_raises_estop_until_it_is_released() -> None:
    robot = Robot()

    assert "error.raised" in robot.engage("anna", "child on the track", 7)
    assert robot.health.is_stopped
    assert [reason.code for reason in robot.health.stop_reasons] == ["ESTOP"]

    robot.release("bert", "track is clear", 20)
    robot.health.pass_time(10**9)
    assert not robot.health.is_stopped
    assert robot.health.stop_reasons == ()


def test_whoever_engages_it_second_does_not_hide_who_was_first() -> None:
    robot = Robot()
    robot.engage("anna", "child on the track", 7)
    before = robot.stop.view()

    assert robot.engage("bert", "me too", 9) == []
    assert robot.stop.view() is before


def test_it_shows_who_released_it() -> None:
    robot = Robot()
    robot.engage("anna", "child on the track", 7)

    assert robot.release("bert", "track is clear", 20)[0] == "emergency_stop.released"
    assert robot.stop.view() == EmergencyStopView(
        engaged=False, by="bert", reason="track is clear", since=20, standstill_at=None
    )


def test_releasing_what_is_released_changes_nothing() -> None:
    robot = Robot()

    assert robot.release("bert", "just in case", 3) == []
    assert robot.stop.view() == RELEASED


def test_the_first_standstill_after_the_stop_is_kept() -> None:
    robot = Robot()
    robot.engage("anna", "child on the track", 7)

    assert robot.stand(9) == ["emergency_stop.standstill"]
    assert robot.stand(12) == []
    assert robot.stop.view() == EmergencyStopView(
        engaged=True, by="anna", reason="child on the track", since=7, standstill_at=9
    )


def test_a_vehicle_that_moves_again_has_to_be_seen_standing_anew() -> None:
    robot = Robot()
    robot.stop.note_motion()
    assert robot.stop.view() == RELEASED
    robot.engage("anna", "child on the track", 7)
    robot.stand(9)

    robot.stop.note_motion()
    assert robot.stop.view().standstill_at is None
    assert robot.stand(12) == ["emergency_stop.standstill"]
    assert robot.stop.view().standstill_at == 12


def test_a_vehicle_that_stands_without_a_stop_is_no_news() -> None:
    robot = Robot()

    assert robot.stand(9) == []
    assert robot.stop.view() == RELEASED


def test_another_stop_waits_for_a_standstill_of_its_own() -> None:
    robot = Robot()
    robot.engage("anna", "child on the track", 7)
    robot.stand(9)
    robot.release("bert", "track is clear", 20)
    robot.engage("anna", "another child", 30)

    assert robot.stop.view().standstill_at is None


# --- over a restart ------------------------------------------------------------------------------


def test_whoever_engages_or_releases_it_is_kept() -> None:
    robot = Robot()
    robot.engage("anna", "child on the track", 7)
    assert robot.kept == [KeptEmergencyStop(True, "anna", "child on the track", 7)]
    robot.engage("bert", "me too", 9)
    assert robot.kept == []

    robot.release("bert", "track is clear", 20)
    assert robot.kept == [KeptEmergencyStop(False, "bert", "track is clear", 20)]


def test_after_a_restart_it_is_engaged_as_it_was() -> None:
    robot = Robot(now=100)
    told = robot.restore(KeptEmergencyStop(True, "anna", "child on the track", 7))

    assert told[:2] == ["service.restored", "error.raised"]
    assert robot.stop.view() == EmergencyStopView(
        engaged=True, by="anna", reason="child on the track", since=7, standstill_at=None
    )
    (reason,) = robot.health.stop_reasons
    assert (reason.code, reason.since) == ("ESTOP", 7)
    assert robot.kept == [], "it is kept already"


def test_after_a_restart_a_released_one_says_who_released_it() -> None:
    robot = Robot(now=100)
    robot.restore(KeptEmergencyStop(False, "bert", "track is clear", 20))

    assert robot.stop.view() == EmergencyStopView(
        engaged=False, by="bert", reason="track is clear", since=20, standstill_at=None
    )
    assert not robot.health.is_stopped


def test_a_clock_that_went_back_makes_no_time_to_come() -> None:
    robot = Robot(now=100)
    robot.restore(KeptEmergencyStop(True, "anna", "child on the track", 250))

    assert robot.stop.view().since == 100
    assert [reason.since for reason in robot.health.stop_reasons] == [100]


def test_whoever_releases_it_after_a_restart_clears_estop() -> None:
    robot = Robot(now=100)
    robot.restore(KeptEmergencyStop(True, "anna", "child on the track", 7))
    robot.release("bert", "track is clear", 120)
    robot.health.pass_time(10**9)

    assert not robot.health.is_stopped


@pytest.mark.parametrize(
    "kept",
    [
        (),
        (KeptEmergencyStop(False, "bert", "track is clear", 20),),
        (KeptEmergencyStop(True, "anna", "child on the track", 7),),
    ],
    ids=["nothing", "released", "engaged"],
)
def test_what_cannot_be_read_engages_it_whatever_was_kept(
    kept: tuple[KeptEmergencyStop, ...],
) -> None:
    robot = Robot(now=100)
    told = robot.restore(*kept, stop_because="state.db is broken")

    assert told[:3] == ["service.restored", "emergency_stop.engaged", "error.raised"]
    assert robot.stop.view() == EmergencyStopView(
        engaged=True, by="service", reason="state.db is broken", since=100, standstill_at=None
    )
    assert robot.kept == [KeptEmergencyStop(True, "service", "state.db is broken", 100)]


def test_the_first_run_of_a_robot_leaves_it_as_it_is() -> None:
    robot = Robot()

    assert robot.restore() == []
    assert robot.stop.view() == RELEASED
