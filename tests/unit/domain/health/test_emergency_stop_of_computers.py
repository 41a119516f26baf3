"""The emergency stop of a robot with several computers, on one of them."""

from domain.commands import AskRelease, TellStops
from domain.computers import SUPERVISOR, DeviceState, PeerStop, StopId, StopView
from domain.inputs import (
    DeviceStatus,
    SupervisorStatus,
)
from domain.kept import KeptEmergencyStop, KeptPeerStops
from domain.snapshot import EmergencyStopView
from domain.timebase import Instant
from tests.support.stopped_robot import ARM, BASE, Robot


def stop_of_arm(number: int = 1, since: Instant = 5) -> PeerStop:
    return PeerStop(StopId(f"arm-{number}"), "bert", "smoke", since)


def test_a_stop_on_another_computer_stops_the_robot_and_says_where_it_is() -> None:
    robot = Robot(peers=(ARM,))

    assert robot.hear(ARM, 7, stop_of_arm()) == ["emergency_stop.peer_engaged", "error.raised"]
    assert robot.words[0] == "emergency stop engaged at device arm by bert: smoke"
    assert robot.reasons == ["emergency stop is engaged at device arm"]
    assert robot.stop.view() == EmergencyStopView(
        True, "bert", "smoke", 5, None, (StopView(StopId("arm-1"), ARM, "bert", "smoke", 5),)
    )
    assert robot.hear(ARM, 8, stop_of_arm(since=6)) == [], "it says the same again"
    assert robot.stop.view().since == 5


def test_the_computer_that_has_a_stop_ends_it() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 7, stop_of_arm())

    assert robot.hear(ARM, 9)[0] == "emergency_stop.peer_released"
    assert robot.words[0] == "emergency stop at device arm released"
    robot.health.pass_time(10**9)
    assert robot.reasons == []
    assert robot.stop.view() == EmergencyStopView(False, "device arm", "", 9, None)


def test_a_new_stop_of_a_computer_stops_before_its_last_one_ends() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 7, stop_of_arm(1))

    assert robot.hear(ARM, 9, stop_of_arm(2)) == [
        "emergency_stop.peer_engaged",
        "emergency_stop.peer_released",
    ], "ESTOP was never gone"
    assert [stop.id for stop in robot.stop.view().stops] == ["arm-2"]


def test_whoever_is_not_dealt_with_stops_the_robot_and_releases_only_its_own_stop() -> None:
    robot = Robot(peers=(ARM,))
    robot.restore(KeptPeerStops(ARM, (stop_of_arm(1),)))
    assert robot.hear(ARM, 8, ended=()) == []
    assert robot.hear(ARM, 9, stop_of_arm(2), ended=()) == ["emergency_stop.peer_engaged"]
    assert [stop.id for stop in robot.stop.view().stops] == ["arm-1", "arm-2"]
    assert robot.stop.view().not_heard == (ARM,)

    assert robot.hear(ARM, 10, ended=(StopId("arm-2"),)) == ["emergency_stop.peer_released"]
    assert [stop.id for stop in robot.stop.view().stops] == ["arm-1"]
    assert robot.hear(ARM, 11, ended=(), is_dealt_with=True) == []
    assert [stop.id for stop in robot.stop.view().stops] == ["arm-1"], "another may have it"
    assert robot.stop.view().not_heard == ()
    assert robot.hear(ARM, 12)[0] == "emergency_stop.peer_released", "the arm itself has no stop"


def test_whoever_is_not_dealt_with_releases_what_it_engaged_itself() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 7, stop_of_arm(1), stop_of_arm(2), ended=())

    assert robot.hear(ARM, 8, stop_of_arm(2), ended=(stop_of_arm(1).id,)) == [
        "emergency_stop.peer_released"
    ]
    assert [stop.id for stop in robot.stop.view().stops] == ["arm-2"]


def test_nothing_is_known_of_the_connection_to_a_computer_that_the_robot_does_not_have() -> None:
    robot = Robot(peers=(BASE,))
    robot.hear(ARM, 7, stop_of_arm())
    robot.connect(DeviceStatus(ARM, DeviceState.LOST), 8)

    assert robot.reasons == ["emergency stop is engaged at device arm"]


def test_a_stop_of_time_to_come_begins_now() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 7, stop_of_arm(since=700))

    assert robot.stop.view().since == 7


def test_a_stop_here_stands_beside_one_elsewhere() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 5, stop_of_arm())

    assert robot.engage("anna", "me too", 7) == ["emergency_stop.engaged"]
    assert robot.reasons == [
        "emergency stop is engaged",
        "emergency stop is engaged at device arm",
    ]
    assert [stop.computer for stop in robot.stop.view().stops] == [ARM, None]
    assert robot.stop.view().by == "bert", "his is the older one"


def test_the_others_are_told_of_each_change_here_and_at_the_start() -> None:
    robot = Robot(peers=(ARM,))
    robot.restore(run="0f0f")
    assert robot.commands == [TellStops(())]

    robot.engage("anna", "child on the track", 7)
    told = TellStops((PeerStop(StopId("0f0f-1"), "anna", "child on the track", 7),))
    assert robot.commands == [told]
    assert robot.stop.told() == told
    robot.engage("bert", "me too", 8)
    robot.hear(ARM, 9, stop_of_arm())
    assert robot.commands == [], "of their own stops they tell themselves"

    robot.release("anna", "track is clear", 20, "0f0f-1")
    assert robot.commands == [TellStops(())]


def test_a_robot_of_one_computer_tells_nobody() -> None:
    robot = Robot()
    robot.restore(run="0f0f")
    assert robot.commands == []
    robot.engage("anna", "child on the track", 7)
    assert robot.commands == []
    assert [stop.id for stop in robot.stop.view().stops] == ["stop-1"]


def test_a_release_ends_the_own_stop_and_asks_the_others_to_end_theirs() -> None:
    robot = Robot(peers=(ARM,))
    robot.engage("anna", "child on the track", 5)
    robot.hear(ARM, 6, stop_of_arm())

    assert robot.release("anna", "track is clear", 20) == [
        "emergency_stop.released",
        "emergency_stop.release_asked",
    ]
    assert robot.words == [
        "emergency stop released here; one is still engaged at device arm",
        "device arm asked to release its emergency stop",
    ]
    assert robot.commands == [TellStops(()), AskRelease(ARM, (StopId("arm-1"),))]
    view = robot.stop.view()
    assert (view.engaged, view.by, view.waits_for) == (True, "bert", (ARM,))

    robot.hear(ARM, 21)
    view = robot.stop.view()
    assert (view.engaged, view.by, view.waits_for) == (False, "device arm", ())


def test_a_release_ends_only_what_its_person_saw() -> None:
    robot = Robot(peers=(ARM, BASE))
    robot.engage("anna", "child on the track", 5)
    robot.hear(ARM, 6, stop_of_arm(1), stop_of_arm(2))

    robot.release("anna", "track is clear", 20, "arm-2")
    assert robot.commands == [AskRelease(ARM, (StopId("arm-2"),))]
    assert [stop.id for stop in robot.stop.view().stops] == ["stop-1", "arm-1", "arm-2"]

    assert robot.release("anna", "track is clear", 21, "stop-0", "base-1") == []
    assert robot.commands == []


def test_the_stop_of_a_computer_that_is_lost_stays_and_nobody_asks_for_it_later() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 6, stop_of_arm())
    robot.connect(DeviceStatus(ARM, DeviceState.LOST, "not heard for 1.5 s"), 8)
    assert robot.reasons == ["emergency stop is engaged at device arm, which has not been heard"]
    assert robot.stop.view().not_heard == (ARM,)

    assert robot.release("anna", "track is clear", 20) == []
    assert robot.commands == []

    robot.connect(DeviceStatus(ARM, DeviceState.CONNECTED), 30)
    assert robot.commands == []
    assert robot.reasons == ["emergency stop is engaged at device arm"]
    robot.release("anna", "track is clear", 31)
    assert robot.commands == [AskRelease(ARM, (StopId("arm-1"),))]


def test_a_device_knows_whether_the_supervisor_can_be_heard() -> None:
    robot = Robot(peers=(SUPERVISOR, BASE))
    robot.connect(SupervisorStatus(DeviceState.CONNECTED), 1)
    robot.engage("anna", "child on the track", 5)
    assert robot.stop.view().not_heard == (BASE,), "it may still move"

    robot.hear(BASE, 6)
    assert robot.stop.view().not_heard == ()
    robot.connect(SupervisorStatus(DeviceState.LATE), 7)
    assert robot.stop.view().not_heard == (), "a late one is heard"
    robot.connect(SupervisorStatus(DeviceState.LOST), 8)
    assert robot.stop.view().not_heard == (SUPERVISOR,)


def test_how_a_connection_is_matters_to_nobody_while_nothing_is_engaged() -> None:
    robot = Robot(peers=(ARM,))
    before = robot.stop.view()

    robot.connect(DeviceStatus(ARM, DeviceState.LOST), 8)
    assert robot.stop.view() is before


def test_somebody_elsewhere_releases_the_stop_that_he_saw() -> None:
    robot = Robot(peers=(ARM,))
    robot.restore(run="0f0f")
    robot.engage("anna", "child on the track", 5)

    assert robot.hear_release(ARM, 6, "0f0f-0", "arm-1") == []
    assert robot.hear_release(ARM, 7, "0f0f-1")[0] == "emergency_stop.released"
    assert robot.commands == [TellStops(())]
    assert robot.kept == [
        KeptEmergencyStop(False, "device arm", "released at device arm", 7),
    ]
    assert robot.hear_release(ARM, 8, "0f0f-1") == [], "it says so until it hears that it is done"

    robot.engage("anna", "another child", 9)
    assert robot.hear_release(ARM, 10, "0f0f-1") == []
    assert robot.stop.view().engaged


def test_stops_of_other_computers_outlast_a_restart() -> None:
    robot = Robot(peers=(ARM,))
    robot.hear(ARM, 6, stop_of_arm())
    (kept,) = robot.kept
    assert kept == KeptPeerStops(ARM, (stop_of_arm(),))

    again = Robot(now=100, peers=(ARM,))
    assert again.restore(kept)[:2] == ["service.restored", "error.raised"]
    assert again.reasons == ["emergency stop is engaged at device arm, which has not been heard"]
    assert again.release("anna", "track is clear", 110) == []

    assert again.hear(ARM, 120, stop_of_arm(since=90)) == []
    assert again.reasons == ["emergency stop is engaged at device arm"]
    assert again.hear(ARM, 130)[0] == "emergency_stop.peer_released"
    assert again.kept == [None]


def test_a_computer_that_the_robot_has_no_more_does_not_stop_it_for_ever() -> None:
    robot = Robot(now=100, peers=(BASE,))

    told = robot.restore(KeptPeerStops(ARM, (stop_of_arm(),)))

    assert told == ["service.restored", "service.not_restored"]
    assert robot.words[1].startswith("the emergency stop at device arm is not restored: ")
    assert robot.kept == [None]
    assert not robot.stop.view().engaged
