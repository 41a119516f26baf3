from api.cli.monitor.store import Note, Robot, fold
from tests.support.monitor import (
    AT,
    after,
    event,
    frame,
    hello,
    hold,
    named,
    off_target,
    part,
    robot,
    signal,
    stop,
    system,
    task,
)


def test_what_changed_is_taken_and_the_rest_stays() -> None:
    known = robot(parts=(part("arm"), part("leg")), signals=(signal("battery_level", 0.9),))

    known = fold(known, frame(after(1), parts=named("name", part("arm", "inactive"))))
    known = fold(known, frame(after(2), signals=named("signal", signal("battery_level", 0.8))))

    assert known.parts is not None
    assert known.signals is not None
    assert known.parts["arm"]["actual"]["state"] == "inactive"
    assert known.parts["leg"]["actual"]["state"] == "active"
    assert known.signals["battery_level"]["value"] == 0.8
    assert known.at == after(2)


def test_a_task_stays_until_a_frame_says_that_there_is_none() -> None:
    known = fold(robot(), frame(task=task()))

    assert fold(known, frame()).task == task()
    assert fold(known, frame(task=None)).task is None


def test_what_the_structure_told_is_kept_where_a_frame_leaves_it_out() -> None:
    known = fold(Robot(), {"type": "structure", "items": [system("robot", "arm"), part("arm")]})
    short = {key: part("arm")[key] for key in ("target", "effective_target", "actual", "converged")}

    known = fold(known, frame(after(1), parts={"arm": {**short, "converged": False}}))

    assert known.parts is not None
    assert known.parts["arm"]["kind"] == "node"
    assert known.parts["arm"]["deviation_since_at"] == after(1)
    assert list(known.parts) == ["robot", "arm"]


def test_a_part_that_was_streamed_is_newer_than_the_structure() -> None:
    known = fold(Robot(), frame(parts=named("name", off_target("arm"))))

    known = fold(known, {"type": "structure", "items": [system("robot", "arm"), part("arm")]})

    assert known.parts is not None
    assert known.parts["arm"] == off_target("arm")
    assert list(known.parts) == ["robot", "arm"]


def test_after_a_restart_nothing_of_before_is_known_but_that_it_happened() -> None:
    known = fold(robot(parts=(part("arm"),)), hello("two"))

    note = Note(AT, "the service was restarted")
    assert known == Robot(epoch="two", notes=(note,))


def test_the_same_service_goes_on_where_it_was() -> None:
    known = robot(parts=(part("arm"),))

    assert fold(known, hello()) == known


def test_an_event_is_told_once_and_in_words() -> None:
    said = event(7, "error.raised", error="BATTERY_LOW", message="battery 42 % is below 50 %")

    known = fold(fold(robot(), said), said)

    assert known.notes == (Note(AT, "BATTERY_LOW: battery 42 % is below 50 %"),)
    assert known.last_event_id == 7


def test_what_is_not_for_an_operator_is_passed_over() -> None:
    known = fold(robot(), event(7, "audit.write", method="PUT"))

    assert known.notes == ()
    assert known.last_event_id == 7


def test_of_systems_it_is_told_what_becomes_of_them_and_of_nodes_not() -> None:
    known = robot(parts=(system("robot", "arm"), part("arm")))

    for number, name in enumerate(("robot", "arm"), start=1):
        known = fold(
            known, event(number, "part.actual_changed", part=name, was="inactive", actual="active")
        )

    assert [note.words for note in known.notes] == ["robot: inactive -> active"]


def test_only_the_newest_of_what_happened_is_kept() -> None:
    known = robot()
    for number in range(1, 100):
        known = fold(known, event(number, "task.started", task=f"t{number}"))

    assert len(known.notes) == 20
    assert known.notes[-1].words == "task t99 drives"


def test_a_gap_is_not_asked_for_again() -> None:
    known = fold(robot(), {"type": "gap", "from": 1, "to": 5, "epoch": "one"})

    assert known.last_event_id == 5
    assert fold(known, {"type": "gap", "from": 1, "to": None, "epoch": "old"}) == known


def test_an_event_tells_of_holds_and_of_the_stop_before_any_answer_does() -> None:
    known = fold(robot(), event(1, "hold.set", "anna", owner="operator", reason="loading"))
    known = fold(known, event(2, "emergency_stop.engaged", "anna", reason="smoke"))

    assert known.holds == (hold("operator", "loading", "anna"),)
    assert known.emergency_stop is not None
    assert known.emergency_stop["engaged"]


def test_an_answer_has_the_last_word() -> None:
    known = fold(robot(), event(1, "hold.set", owner="operator", reason="loading"))

    assert fold(known, {"type": "holds", "items": []}).holds == ()


def test_an_event_does_not_stand_for_an_answer_that_has_not_come() -> None:
    known = fold(fold(Robot(), hello()), event(1, "hold.set", owner="operator", reason=""))

    assert known.holds is None
    assert known.emergency_stop is None


def test_it_is_whole_when_there_is_something_of_everything() -> None:
    known = robot()

    assert known.is_whole
    assert not fold(known, hello("two")).is_whole
    assert not fold(Robot(), frame(parts={}, signals={}, task=None)).is_whole


def test_as_json_it_has_each_member_as_the_interface_has_it() -> None:
    known = fold(robot(parts=(part("arm"),)), {"type": "holds", "items": [hold("operator")]})

    shown = known.as_json()

    assert list(shown) == [
        "at",
        "system_state",
        "parts",
        "signals",
        "task",
        "vehicle",
        "emergency_stop",
        "holds",
    ]
    assert shown["parts"] == {"arm": part("arm")}
    assert shown["emergency_stop"] == stop()
    assert shown["holds"] == (hold("operator"),)


def test_a_frame_of_an_unknown_type_tells_nothing() -> None:
    assert fold(robot(), {"type": "weather"}) == robot()
