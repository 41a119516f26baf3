"""Who is there, and what follows if a computer of the robot is not."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.computers import ComputerName, DeviceState, PeerStop, StopId
from domain.devices.settings import NOTHING_OFFLINE
from domain.errors import UnknownPartError
from domain.inputs import (
    AcknowledgeRequest,
    DeviceStatus,
    ModeRequest,
    NodeReport,
    PeerStops,
    ShelveRequest,
    TimePassed,
)
from domain.outbox import NOTHING
from domain.snapshot import ErrorKey, ErrorState, Severity
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.models import ACTUATION, ARM, BASE, actuation_model
from tests.support.robot_of_devices import (
    ARM_COMPUTER,
    BASE_COMPUTER,
    DEVICES,
    SILENT,
    RobotOfDevices,
)

CONNECTED, LATE, LOST = DeviceState.CONNECTED, DeviceState.LATE, DeviceState.LOST
CONFLICT, NEVER_SEEN = DeviceState.CONFLICT, DeviceState.NEVER_SEEN
LATE_WORDS = "device arm has not been heard for 0.5 s"
OTHER_MODEL = "device arm is not dealt with: it has another model"


@pytest.fixture
def robot() -> RobotOfDevices:
    """Both devices are connected."""
    return RobotOfDevices().connect_all()


# --- the start -----------------------------------------------------------------------------------


def test_a_robot_of_one_computer_has_no_devices() -> None:
    core = Supervision(actuation_model(), SupervisionSettings(), 0)

    assert core.devices() == {}
    assert core.part(ARM).device is None
    assert core.error(ErrorKey(ARM, "UNREACHABLE")).is_root


def test_at_the_start_no_device_was_ever_seen() -> None:
    robot = RobotOfDevices()
    view = robot.device()

    assert list(robot.core.devices()) == [BASE_COMPUTER, ARM_COMPUTER]
    assert (view.state, view.parts, view.offline) == (NEVER_SEEN, (ARM,), NOTHING_OFFLINE)
    assert (view.incarnation, view.session, view.version, view.stops) == (None, None, None, ())


def test_a_part_says_which_computer_owns_it(robot: RobotOfDevices) -> None:
    assert robot.core.part(ARM).device == "arm"
    assert robot.core.part(BASE).device == "base"
    assert robot.core.part(ACTUATION).device is None


def test_that_a_device_was_not_heard_yet_is_an_error_that_nobody_is_told() -> None:
    robot = RobotOfDevices()

    assert robot.error("arm.LOST").state is ErrorState.ACTIVE
    assert robot.error("arm.LOST").message == "device arm was never heard of"
    assert robot.error("manipulator.UNREACHABLE").roots == (ErrorKey(PartName("arm"), "LOST"),)
    assert robot.announced == ["base.LOST", "arm.LOST"]

    robot.connect_all().advance(5)

    assert robot.announced == []
    assert robot.error("arm.LOST").count == 0
    assert "LOST" not in " ".join(robot.happened("error.*"))
    assert [words for words in robot.short_list if "connected" in words or "reach" in words] == [
        "device base is connected",
        "device arm is connected",
    ]


def test_a_device_that_is_still_missing_is_told_once() -> None:
    robot = RobotOfDevices().connect(BASE_COMPUTER)
    missing = "device arm has not been heard since the start"

    robot.says(NEVER_SEEN, reason=missing)
    robot.hears(ARM, reachable=False).advance(5)

    assert robot.happened("device.lost") == [missing]
    assert "arm" not in " ".join(robot.happened("error.*"))
    assert robot.announced == ["arm.LOST"]
    assert robot.error("arm.LOST").message == missing


# --- late and lost -------------------------------------------------------------------------------


def test_a_device_is_connected(robot: RobotOfDevices) -> None:
    view = robot.device()

    assert (view.state, view.reason, view.version) == (CONNECTED, "", "0.9.1")
    assert view.incarnation == f"{1:032x}"
    assert view.session == f"{101:032x}"


def test_what_is_said_again_changes_nothing(robot: RobotOfDevices) -> None:
    assert robot.says(CONNECTED) == NOTHING


def test_a_change_is_said_with_the_name_of_the_device(robot: RobotOfDevices) -> None:
    assert robot.says(LATE, reason=LATE_WORDS).devices == {"arm"}


def test_a_late_device_is_a_warning_and_goes_on(robot: RobotOfDevices) -> None:
    robot.advance(3)
    robot.events.clear()
    robot.says(LATE, reason=LATE_WORDS)

    error = robot.error("arm.LATE")
    assert (error.state, error.severity) == (ErrorState.ACTIVE, Severity.WARNING)
    assert (error.message, error.since) == (LATE_WORDS, seconds(3))
    assert robot.core.part(ARM).reachable

    robot.says(CONNECTED)

    assert not robot.error("arm.LATE").state.is_on
    assert robot.happened("device.*") == [LATE_WORDS, "device arm is connected"]
    assert robot.short_list == []


def test_a_lost_device_is_one_error_and_all_else_follows_from_it(robot: RobotOfDevices) -> None:
    robot.core.part(ACTUATION)
    robot.says(LATE, reason=LATE_WORDS)
    robot.events.clear()

    robot.lose().advance(5)

    error = robot.error("arm.LOST")
    assert (error.state, error.severity) == (ErrorState.ACTIVE, Severity.URGENT)
    assert (error.message, error.is_root, error.first_out) == (SILENT, True, False)
    assert not robot.error("arm.LATE").state.is_on
    assert robot.error("manipulator.UNREACHABLE").roots == (error.key,)
    assert not robot.error("drive_base.UNREACHABLE").state.is_on
    assert robot.announced == ["arm.LOST"]
    assert robot.short_list[0] == SILENT
    assert [words for words in robot.short_list if "manipulator" in words] == []


def test_what_a_system_misses_goes_back_to_the_lost_device() -> None:
    robot = RobotOfDevices().connect_all("active")
    robot.give(_performance())
    robot.obey().advance(1)
    assert robot.core.part(ACTUATION).actual.state_and_mode.label == "active.PERFORMANCE"

    robot.lose().advance(5)

    lost = (ErrorKey(PartName("arm"), "LOST"),)
    assert robot.error("manipulator.DEVIATES").roots == lost
    assert robot.error("actuation.DEVIATES").roots == lost
    assert robot.announced == ["arm.LOST"]


def test_a_system_of_a_lost_device_is_unknown_and_says_why(robot: RobotOfDevices) -> None:
    robot.lose()

    for part in (ARM, ACTUATION):
        actual = robot.core.part(part).actual
        assert (actual.state_and_mode.label, actual.reason) == (
            "unknown",
            f"manipulator is unreachable: {SILENT}, its last values are old",
        )
    assert not robot.core.part(ACTUATION).reachable
    assert robot.core.part(BASE).actual.state_and_mode.label == "unconfigured"


def test_a_device_that_comes_back_ends_all_that_followed(robot: RobotOfDevices) -> None:
    robot.lose().advance(5)
    robot.connect(run=2).advance(1)

    assert robot.announced == []
    assert not robot.error("manipulator.UNREACHABLE").state.is_on
    assert robot.core.part(ACTUATION).actual.state_and_mode.label == "unconfigured"
    assert robot.happened("device.connected")[-1] == "device arm is connected after a restart"


def test_each_part_of_a_device_changes_once_when_it_is_lost_and_once_when_it_returns(
    robot: RobotOfDevices,
) -> None:
    robot.events.clear()

    robot.lose().advance(5)
    robot.connect().advance(5)

    assert robot.happened("part.actual_changed") == [
        "actuation: unconfigured -> unknown",
        "manipulator: unconfigured -> unknown",
        "actuation: unknown -> unconfigured",
        "manipulator: unknown -> unconfigured",
    ]


def test_a_node_that_is_missing_on_a_connected_device_is_an_error_of_its_own(
    robot: RobotOfDevices,
) -> None:
    robot.hears(ARM, reachable=False)

    assert robot.announced == ["manipulator.UNREACHABLE"]
    assert robot.core.part(ARM).actual.reason == "manipulator is unreachable"


def test_a_node_that_is_still_missing_when_its_device_returns_is_unreachable_by_itself(
    robot: RobotOfDevices,
) -> None:
    robot.hears(ARM, reachable=False).lose()
    assert robot.announced == ["arm.LOST"]

    robot.says(CONNECTED)

    assert robot.core.part(ARM).actual.reason == "manipulator is unreachable"
    assert robot.core.part(ACTUATION).actual.reason == "manipulator is unreachable"
    (why,) = robot.core.mode(ARM, robot.model.modes_of(ARM)[0]).blockers
    assert (why.code, why.causes, why.root_cause) == ("UNREACHABLE", (), True)


# --- blockers ------------------------------------------------------------------------------------


def test_a_mode_says_that_its_device_is_lost_and_can_be_asked_for(robot: RobotOfDevices) -> None:
    robot.advance(3).lose()

    mode = robot.core.mode(ACTUATION, robot.model.modes_of(ACTUATION)[-1])

    (why,) = mode.blockers
    assert (why.code, why.path, why.refuses) == ("UNREACHABLE", ("actuation", "manipulator"), False)
    assert not why.root_cause
    (cause,) = why.causes
    assert (cause.code, cause.message) == ("DEVICE_LOST", f"{SILENT}, its last values are old")
    assert (cause.path, cause.since) == (why.path, seconds(3))
    assert cause.root_cause
    assert not cause.refuses
    assert mode.can_enter


def test_why_names_the_lost_device() -> None:
    robot = RobotOfDevices().connect_all("active")
    robot.give(_performance())
    robot.obey().advance(1).lose()

    (why,) = robot.core.why(ACTUATION)

    assert why.code == "UNREACHABLE"
    assert [cause.code for cause in why.causes] == ["DEVICE_LOST"]


def test_of_a_device_that_was_never_seen_no_value_is_old() -> None:
    robot = RobotOfDevices()

    (why, _) = robot.core.mode(ACTUATION, robot.model.modes_of(ACTUATION)[-1]).blockers

    assert why.code == "UNKNOWN_STATE"
    assert [cause.message for cause in why.causes] == ["device arm was never heard of"]


# --- conflicts -----------------------------------------------------------------------------------


def test_a_newcomer_of_the_same_name_is_an_error_and_nothing_else(robot: RobotOfDevices) -> None:
    robot.events.clear()
    robot.says(CONNECTED, refused="another process is device arm")

    error = robot.error("arm.DEVICE_CONFLICT")
    assert (error.state, error.severity) == (ErrorState.ACTIVE, Severity.URGENT)
    assert error.message == "another process is device arm"
    assert robot.announced == ["arm.DEVICE_CONFLICT"]
    assert robot.core.part(ARM).reachable
    assert robot.short_list == ["conflict about device arm: another process is device arm"]

    robot.says(CONNECTED)

    assert robot.announced == []


def test_a_device_that_is_not_dealt_with_is_lost_because_of_that(robot: RobotOfDevices) -> None:
    robot.lose()
    robot.says(CONFLICT, reason=OTHER_MODEL)

    assert robot.error("arm.DEVICE_CONFLICT").message == OTHER_MODEL
    assert robot.error("arm.LOST").roots == (ErrorKey(PartName("arm"), "DEVICE_CONFLICT"),)
    assert robot.announced == ["arm.DEVICE_CONFLICT"]
    assert robot.core.part(ARM).actual.reason == (
        f"manipulator is unreachable: {OTHER_MODEL}, its last values are old"
    )


def test_a_device_with_another_model_is_told_from_the_start() -> None:
    robot = RobotOfDevices()
    robot.says(CONFLICT, reason=OTHER_MODEL)

    assert robot.announced == ["base.LOST", "arm.DEVICE_CONFLICT"]
    assert robot.short_list == [f"conflict about device arm: {OTHER_MODEL}"]

    robot.connect()

    assert robot.announced == ["base.LOST"]


def test_another_reason_for_the_same_conflict_is_told(robot: RobotOfDevices) -> None:
    robot.says(CONFLICT, reason=OTHER_MODEL)
    robot.says(CONFLICT, reason="device arm refuses this computer")

    assert robot.error("arm.DEVICE_CONFLICT").message == "device arm refuses this computer"
    assert len(robot.happened("device.conflict")) == 2


# --- what else is known --------------------------------------------------------------------------


def test_a_device_that_acts_on_its_own_says_so(robot: RobotOfDevices) -> None:
    robot.says(CONNECTED, autonomous=True)

    assert robot.device().autonomous
    assert robot.happened("device.reported") == ["device arm acts on its own"]


def test_what_was_known_of_a_lost_device_stays_known(robot: RobotOfDevices) -> None:
    robot.give(DeviceStatus(ARM_COMPUTER, LOST, SILENT))

    view = robot.device()
    assert (view.incarnation, view.version, view.session) == (f"{1:032x}", "0.9.1", None)


def test_its_stops_are_shown_also_while_it_is_lost(robot: RobotOfDevices) -> None:
    stop = PeerStop(StopId("arm-7"), "ada", "smoke", 1)
    outputs = robot.give(PeerStops(ARM_COMPUTER, (stop,)))
    assert outputs.devices == {"arm"}

    robot.lose()

    assert robot.device().stops == ("arm-7",)
    assert robot.device(BASE_COMPUTER).stops == ()

    robot.restart()
    assert robot.device().stops == ("arm-7",)

    assert robot.give(PeerStops(ARM_COMPUTER, ())).devices == {"arm"}
    assert robot.device().stops == ()


def test_stops_of_who_is_no_device_are_those_of_none(robot: RobotOfDevices) -> None:
    stop = PeerStop(StopId("leg-7"), "ada", "smoke", 1)

    assert robot.give(PeerStops(ComputerName("leg"), (stop,))).devices == frozenset()
    assert [view.stops for view in robot.core.devices().values()] == [(), ()]


def test_a_device_that_the_robot_does_not_have_is_refused(robot: RobotOfDevices) -> None:
    with pytest.raises(UnknownPartError, match="there is no device 'leg'"):
        robot.says(CONNECTED, ComputerName("leg"))


# --- errors of devices as any other --------------------------------------------------------------


def test_errors_of_devices_are_listed_before_those_of_parts(robot: RobotOfDevices) -> None:
    names = [view.key.name for view in robot.core.errors()]
    first = names.index("base.LATE")

    assert names[first : first + 6] == [
        "base.LATE",
        "base.LOST",
        "base.DEVICE_CONFLICT",
        "arm.LATE",
        "arm.LOST",
        "arm.DEVICE_CONFLICT",
    ]
    assert names[first + 6].startswith("actuation.")
    assert [view.key.error for view in robot.core.errors_of(PartName("arm"))] == [
        "LATE",
        "LOST",
        "DEVICE_CONFLICT",
    ]


def test_that_a_device_was_lost_is_acknowledged(robot: RobotOfDevices) -> None:
    robot.lose().connect().advance(1)
    assert robot.error("arm.LOST").state is ErrorState.RETURNED

    robot.give(AcknowledgeRequest("LOST", part=PartName("arm")))

    assert robot.error("arm.LOST").state is ErrorState.NORMAL
    assert robot.error("manipulator.UNREACHABLE").state is ErrorState.NORMAL


def test_that_a_device_is_late_is_shelved(robot: RobotOfDevices) -> None:
    robot.give(ShelveRequest("LATE", seconds(600), "a bad antenna", part=PartName("arm")))
    robot.says(LATE, reason=LATE_WORDS)

    assert robot.error("arm.LATE").marks.is_silenced


def test_a_loss_that_nobody_saw_is_known_after_a_restart(robot: RobotOfDevices) -> None:
    robot.lose().restart().connect_all().advance(1)

    assert robot.error("arm.LOST").state is ErrorState.RETURNED
    assert robot.error("base.LOST").state is ErrorState.NORMAL


def test_a_loss_of_a_device_that_the_robot_no_longer_has_is_forgotten(
    robot: RobotOfDevices,
) -> None:
    robot.lose()
    robot.settings = replace(robot.settings, devices={BASE_COMPUTER: DEVICES[BASE_COMPUTER]})

    robot.restart()

    assert robot.happened("service.not_restored") == [
        "the error arm.LOST is not restored: there is no such error any more"
    ]


# --- replay --------------------------------------------------------------------------------------


def test_a_replay_gives_the_same(robot: RobotOfDevices) -> None:
    robot.says(LATE, reason=LATE_WORDS)
    robot.lose().advance(3)
    robot.connect(state="active", run=2).advance(3)

    again = Supervision(robot.model, robot.settings, 0)

    assert [(at, given, again.handle(given, at)) for at, given, _ in robot.record] == robot.record


@given(
    st.lists(
        st.one_of(
            st.tuples(st.sampled_from(DeviceState), st.sampled_from(["", "another one"])),
            st.tuples(st.sampled_from([True, False, None]), st.just("")),
        ),
        max_size=12,
    )
)
def test_whatever_a_link_says_in_whichever_order_the_errors_say_how_it_is(
    said: list[tuple[DeviceState | bool | None, str]],
) -> None:
    robot = RobotOfDevices()
    for what, refused in said:
        if isinstance(what, DeviceState):
            robot.says(what, refused=refused)
        elif what is None:
            robot.advance(1)
        else:
            robot.give(NodeReport(ARM, reachable=what))
        view = robot.device()
        is_on = {name: robot.error(f"arm.{name}").state.is_on for name in ("LATE", "LOST")}
        assert is_on == {"LATE": view.state is LATE, "LOST": not view.is_connected}
        is_conflict = robot.error("arm.DEVICE_CONFLICT").state.is_on
        assert is_conflict is (bool(view.refused) or view.state is CONFLICT)
        unreachable = robot.error("manipulator.UNREACHABLE")
        if unreachable.state.is_on and not view.is_connected:
            assert not unreachable.is_root
    again = Supervision(robot.model, robot.settings, 0)
    assert [again.handle(given_, at) for at, given_, _ in robot.record] == [
        outputs for _, _, outputs in robot.record
    ]
    assert robot.give(TimePassed()).devices == frozenset()


def _performance() -> ModeRequest:
    return ModeRequest(ACTUATION, "PERFORMANCE")
