from api.cli.monitor.sentence import (
    Sentence,
    contact_sentence,
    restart_sentence,
    state_sentence,
    stop_sentence,
)
from api.cli.monitor.store import Json, Robot
from api.cli.monitor.view import Contact, Level
from tests.support.monitor import AT, after, frame, hello, robot, stop, system_state, task, view


def test_idle_without_a_task_says_so() -> None:
    assert state_sentence(view(robot())) == Sentence("IDLE", "no task")


def test_before_the_task_is_known_its_status_is_told() -> None:
    known = robot(frame(system_state=system_state("RUNNING", task_status="RUNNING_TASK")))

    assert state_sentence(view(known)) == Sentence("RUNNING", "the task is running")


def told_of(drives: Json) -> str:
    sentence = state_sentence(view(robot(frame(task=drives))))
    assert sentence is not None
    return sentence.text


def test_a_task_is_told_with_how_far_it_is_or_why_it_is_not_driven() -> None:
    assert told_of(task()) == "task t1 42 %, waypoint 41 of 66"
    assert told_of(task("PAUSING", reason="loading")) == "task t1 is stopping: loading"
    assert told_of(task("PAUSED", reason="loading")) == "task t1 at 42 % is paused: loading"


def test_an_error_begins_with_its_first_reason_and_goes_on_with_the_others() -> None:
    state = system_state("ERROR", "battery 42 % is below 50 %", "e-stop is pressed")
    known = robot(frame(system_state=state, task=task("PAUSED")))

    assert state_sentence(view(known)) == Sentence(
        "ERROR", "battery 42 % is below 50 %; task t1 is paused", ("e-stop is pressed",)
    )


def test_an_error_without_a_reason_tells_its_codes() -> None:
    state = {**system_state("ERROR"), "errors": ["BATTERY_LOW", "EMERGENCY_STOP"]}

    assert state_sentence(view(robot(frame(system_state=state)))) == Sentence(
        "ERROR", "BATTERY_LOW, EMERGENCY_STOP"
    )


def test_while_nothing_is_known_nothing_is_said_of_the_state() -> None:
    assert state_sentence(view(Robot())) is None


def test_good_contact_is_not_worth_a_word() -> None:
    assert contact_sentence(view(robot())) is None


def test_before_the_first_contact_it_says_what_it_waits_for() -> None:
    waiting = Contact(Level.CONNECTING, 1.0)
    failing = Contact(Level.CONNECTING, 1.0, "no service answers")

    said = contact_sentence(view(Robot(), waiting))
    assert said == Sentence("CONNECTING", "waiting for the first values")
    assert contact_sentence(view(Robot(), failing)) == Sentence("CONNECTING", "no service answers")


def test_lost_contact_is_told_with_since_when_why_and_of_when_the_picture_is() -> None:
    said = contact_sentence(
        view(robot(), Contact(Level.LOST, 14.0, "the connection was lost"), 14.0)
    )

    assert said is not None
    assert said.word == "NO CONTACT"
    assert said.text.endswith("(14 s), reconnecting")
    assert said.more[0] == "the connection was lost"
    assert said.more[1].startswith("values shown are from ")


def test_without_contact_the_state_is_one_that_was() -> None:
    lost = Contact(Level.LOST, 14.0)

    assert state_sentence(view(robot(), lost)) == Sentence("WAS IDLE", "no task")


def test_a_released_stop_is_not_worth_a_word() -> None:
    assert stop_sentence(view(robot())) is None
    assert stop_sentence(view(Robot())) is None


def test_an_engaged_stop_says_why_since_when_by_whom_and_whether_the_vehicle_stands() -> None:
    engaged = stop(engaged=True, by="anna", reason="smoke", since_at=AT)
    moving = view(robot(frame(emergency_stop=engaged)), later_s=3.0)
    standing = view(robot(frame(emergency_stop={**engaged, "standstill_at": AT})))

    assert stop_sentence(moving) == Sentence(
        "EMERGENCY STOP", "engaged: smoke, for 3 s, by anna, no standstill yet"
    )
    assert stop_sentence(standing) == Sentence(
        "EMERGENCY STOP", "engaged: smoke, for 0 s, by anna, the vehicle is at a standstill"
    )


def test_a_restart_is_told_for_ten_minutes() -> None:
    restarted = robot(hello("two", after(3)), frame(after(4)))

    told = restart_sentence(view(restarted, later_s=60.0))

    assert told is not None
    assert told.word == "RESTARTED"
    assert told.text.endswith("earlier tasks and holds are gone")
    assert restart_sentence(view(restarted, later_s=700.0)) is None
    assert restart_sentence(view(robot())) is None


def test_a_task_that_ended_is_no_task_any_more() -> None:
    ended = view(robot(frame(task=task("SUCCEEDED", ended_at=AT))))

    assert state_sentence(ended) == Sentence("IDLE", "no task")
