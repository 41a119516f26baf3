import pytest

from domain.kept import KeptEmergencyStop
from domain.snapshot import EmergencyStopView
from tests.support.stopped_robot import RELEASED, Robot, engaged


def test_it_starts_released_by_nobody() -> None:
    assert Robot().stop.view() == RELEASED


def test_it_shows_who_engaged_it_why_and_when() -> None:
    robot = Robot()

    assert robot.engage("anna", "child on the track", 7)[0] == "emergency_stop.engaged"
    assert robot.stop.view() == engaged("anna", "child on the track", 7, stop="stop-1")


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
    assert robot.stop.view() == engaged(
        "anna", "child on the track", 7, stop="stop-1", standstill_at=9
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
    assert robot.kept == [KeptEmergencyStop(True, "anna", "child on the track", 7, "stop-1")]
    robot.engage("bert", "me too", 9)
    assert robot.kept == []

    robot.release("bert", "track is clear", 20)
    assert robot.kept == [KeptEmergencyStop(False, "bert", "track is clear", 20)]


def test_after_a_restart_it_is_engaged_as_it_was() -> None:
    robot = Robot(now=100)
    told = robot.restore(KeptEmergencyStop(True, "anna", "child on the track", 7, "stop-3"))

    assert told[:2] == ["service.restored", "error.raised"]
    assert robot.stop.view() == engaged("anna", "child on the track", 7, stop="stop-3")
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
    (kept_now,) = robot.kept
    assert isinstance(kept_now, KeptEmergencyStop)
    assert kept_now == KeptEmergencyStop(True, "service", "state.db is broken", 100, kept_now.id)
    assert robot.stop.view() == engaged("service", "state.db is broken", 100, stop=kept_now.id)


def test_the_first_run_of_a_robot_leaves_it_as_it_is() -> None:
    robot = Robot()

    assert robot.restore() == []
    assert robot.stop.view() == RELEASED


def test_a_stop_of_a_release_without_ids_gets_one_that_is_kept() -> None:
    robot = Robot(now=100)
    robot.restore(KeptEmergencyStop(True, "anna", "child on the track", 7))

    assert robot.kept == [KeptEmergencyStop(True, "anna", "child on the track", 7, "stop-1")]
    assert robot.stop.view() == engaged("anna", "child on the track", 7, stop="stop-1")
