from dataclasses import replace

import pytest

from domain.actor import Actor
from domain.commands import Drive
from domain.controller import (
    ControllerAnswer,
    ControllerFeedback,
    ControllerResult,
    ControllerStatus,
)
from domain.errors import InvalidModelError
from domain.inputs import HoldRequest, ReleaseRequest, TimePassed
from domain.parts.system_model import SmhModel
from domain.vehicle import DriveCommand
from service.checkpoint import checkpoint_of, core_of_checkpoint
from service.codec.codec import STEPS
from service.codec.recorded_step import RecordedStep
from service.replay import Difference, core_of_boot, replay
from tests.support.good import GOOD
from tests.support.recorded_robot import BOOT, RecordedRobot
from tests.support.scripted_controller import ControlledRobot, make_controlled


@pytest.fixture(scope="module")
def steps() -> list[RecordedStep]:
    """Return a run in which a task was driven, held and resumed."""
    robot = RecordedRobot()
    robot.read(**GOOD)
    robot.submit_task()
    robot.advance(1)
    robot.hold("gate", "closed")
    robot.advance(2)
    robot.release("gate")
    robot.advance(1)
    return robot.recorded()


def place_of(steps: list[RecordedStep], kind: type, **fields: object) -> int:
    """Return the index of the step that an input led to."""
    return next(
        index
        for index, step in enumerate(steps)
        if isinstance(step.given, kind)
        and all(getattr(step.given, name) == value for name, value in fields.items())
    )


def found(steps: list[RecordedStep], index: int, **changed: object) -> Difference:
    """Return what a replay finds if one step was recorded otherwise."""
    otherwise = [*steps]
    otherwise[index] = replace(steps[index], **changed)  # type: ignore[arg-type]
    replayed = replay(core_of_boot(BOOT), otherwise, first=1001)
    assert replayed.steps == index
    assert replayed.difference is not None
    assert replayed.difference.step == 1001 + index
    assert replayed.difference.at == steps[index].at
    return replayed.difference


def test_the_same_follows_again(steps: list[RecordedStep]) -> None:
    replayed = replay(core_of_boot(BOOT), steps)

    assert replayed.difference is None
    assert replayed.steps == len(steps)
    assert replayed.last_event == max(event.id for step in steps for event in step.events)


def test_an_event_that_was_recorded_otherwise_is_named(steps: list[RecordedStep]) -> None:
    index = place_of(steps, HoldRequest)
    first, second, *others = steps[index].events
    otherwise = replace(second, event=replace(second.event, reason="open"))  # type: ignore[type-var]

    difference = found(steps, index, events=(first, otherwise, *others))

    assert difference.event == second.id
    assert difference.words == (
        f"step {1001 + index} (hold_request): recorded was event {second.id} hold.set "
        f"(hold gate set: open), but now came event {second.id} hold.set (hold gate set: closed)"
    )


def test_what_words_do_not_tell_is_shown_in_full(steps: list[RecordedStep]) -> None:
    index = place_of(steps, HoldRequest)
    first, *others = steps[index].events

    difference = found(steps, index, events=(replace(first, actor=Actor("eve")), *others))

    assert difference.event == first.id
    assert '"actor":{"name":"eve"}' in difference.expected
    assert '"actor":{"name":"operator"}' in difference.came


def test_an_event_too_many_is_named(steps: list[RecordedStep]) -> None:
    index = place_of(steps, ReleaseRequest)

    difference = found(steps, index, events=())

    assert difference.event == steps[index].events[0].id
    assert difference.expected == "nothing"
    assert "hold.release_requested" in difference.came


def test_another_drive_command_is_found(steps: list[RecordedStep]) -> None:
    index = next(i for i, step in enumerate(steps) if step.commands)
    faster = Drive(DriveCommand(1.25, 0.5))

    difference = found(steps, index, commands=(faster,))

    assert difference.event is None
    assert difference.expected == "drive at 1.25 m/s, 0.5 rad"
    assert difference.came.startswith("drive at ")


def test_what_is_kept_is_compared(steps: list[RecordedStep]) -> None:
    index = place_of(steps, HoldRequest)

    difference = found(steps, index, kept=())

    assert difference.event is None
    assert (difference.expected, difference.came) == ("nothing", "kept_progress t1 is kept")


def test_a_view_that_did_not_change_is_found(steps: list[RecordedStep]) -> None:
    index = place_of(steps, HoldRequest)

    assert found(steps, index, views=0).expected == "a change of other views"


def test_views_that_were_not_recorded_are_not_compared(steps: list[RecordedStep]) -> None:
    unknown = [replace(step, views=None) for step in steps]

    assert replay(core_of_boot(BOOT), unknown).difference is None


def test_an_input_that_is_rejected_now_is_a_difference(steps: list[RecordedStep]) -> None:
    difference = found(steps, place_of(steps, TimePassed), given=HoldRequest("error", ""))

    assert difference.given == "hold_request"
    assert difference.came == ("a rejection: only Pilothouse sets and releases the hold 'error'")


def test_a_model_that_cannot_be_read_is_told() -> None:
    with pytest.raises(InvalidModelError):
        core_of_boot(replace(BOOT, model="robot: {}"))


def test_a_robot_without_a_robot_file_has_the_defaults() -> None:
    core = core_of_boot(replace(BOOT, robot=""))

    assert set(core.core.signals()) == set(GOOD)


def test_what_an_external_controller_said_leads_to_the_same_again() -> None:
    robot = ControlledRobot()
    robot.submit_task()
    robot.drive(3)
    robot.be(heeds_cancel=False)
    robot.hold()
    robot.drive(2)
    robot.be(heeds_cancel=True)
    robot.drive(2)
    robot.release()
    robot.drive(2)
    recorded = [STEPS.decode(STEPS.encode(step)) for step in robot.taken]
    given = {type(step.given) for step in recorded}
    assert {ControllerStatus, ControllerAnswer, ControllerFeedback, ControllerResult} <= given

    replayed = replay(make_controlled(SmhModel({}, {})), recorded)

    assert replayed.difference is None
    assert replayed.steps == len(recorded)


def test_an_external_controller_is_in_a_checkpoint() -> None:
    robot = ControlledRobot()
    robot.submit_task()
    robot.drive(3)
    done = len(robot.taken)
    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1"), "1")
    robot.hold()
    robot.drive(3)

    assert replay(copy, robot.taken[done:]).difference is None
