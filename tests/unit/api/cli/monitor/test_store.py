from dataclasses import replace

from api.cli.monitor.store import Note, Robot, fold
from tests.support.monitor import (
    AT,
    after,
    device,
    error,
    event,
    frame,
    graph,
    hello,
    hold,
    named,
    part,
    robot,
    signal,
    stop,
    task,
    this_device,
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


def test_a_task_that_ended_is_not_the_current_one() -> None:
    ended = task("SUCCEEDED", ended_at=after(5))
    known = fold(robot(), frame(task=task()))

    assert known.current_task == task()
    known = fold(known, frame(task=ended))
    assert (known.task, known.current_task) == (ended, None)


def test_holds_and_the_stop_are_those_of_the_last_frame_that_told_them() -> None:
    held = {"operator": hold("operator", "loading", "anna")}
    engaged = stop(engaged=True, by="anna", reason="smoke", since_at=AT)
    known = fold(robot(), frame(holds=held, emergency_stop=engaged))

    assert fold(known, frame(after(1))).holds == held
    assert fold(known, frame(after(1))).emergency_stop == engaged
    assert fold(known, frame(after(1), holds={})).holds == {}
    assert fold(known, frame(after(1), emergency_stop=stop())).emergency_stop == stop()


def test_after_a_restart_nothing_of_before_is_known_but_that_it_happened_and_when() -> None:
    known = fold(robot(parts=(part("arm"),)), hello("two", after(3)))

    note = Note(after(3), "the service was restarted: earlier tasks and holds are gone")
    assert known == Robot("robot.yaml", epoch="two", restarted_at=after(3), notes=(note,))


def test_a_restart_that_kept_everything_is_told_by_its_own_events() -> None:
    known = fold(robot(parts=(part("arm"),)), event(7, "a hold was set"))

    restarted = fold(known, hello("two", after(3), boot=2))

    assert restarted == Robot(
        "robot.yaml", epoch="two", boot=2, restarted_at=after(3), last_event_id=7, notes=known.notes
    )


def test_the_same_service_goes_on_where_it_was() -> None:
    known = robot(parts=(part("arm"),))

    assert fold(known, hello()) == known


def test_an_event_is_told_once_in_the_words_that_it_carries() -> None:
    said = event(7, "BATTERY_LOW: battery 42 % is below 50 %")

    known = fold(fold(robot(), said), said)

    assert known.notes == (Note(AT, "BATTERY_LOW: battery 42 % is below 50 %"),)
    assert known.last_event_id == 7


def test_a_detail_is_passed_over() -> None:
    known = fold(robot(), event(7, notable=False))

    assert known.notes == ()
    assert known.last_event_id == 7


def test_only_the_newest_of_what_happened_is_kept() -> None:
    known = robot()
    for number in range(1, 100):
        known = fold(known, event(number, f"task t{number} drives"))

    assert len(known.notes) == 20
    assert known.notes[-1].words == "task t99 drives"


def test_a_gap_is_not_asked_for_again() -> None:
    known = fold(robot(), {"type": "gap", "from": 1, "to": 5, "epoch": "one"})

    assert known.last_event_id == 5
    unknown = fold(known, {"type": "gap", "from": 1, "to": None, "epoch": "old"})
    assert unknown == replace(known, last_event_id=0)


def test_it_is_whole_when_there_is_something_of_everything() -> None:
    known = robot()

    assert known.is_whole
    assert not fold(known, hello("two")).is_whole
    assert not fold(Robot(), frame(parts={}, signals={}, task=None)).is_whole
    assert fold(
        Robot(), frame(parts={}, signals={}, holds={}, emergency_stop=stop(), task=None)
    ).is_whole


def test_a_service_that_does_not_name_its_model_is_understood_all_the_same() -> None:
    unnamed = {key: value for key, value in hello().items() if key != "model"}

    assert fold(Robot(), unnamed).model == ""


def test_of_a_graph_it_is_whole_once_all_was_heard_that_can_be_heard_soon() -> None:
    begun = fold(Robot(), graph(part("arm"), part("base"), settled=False))
    changed = fold(begun, graph(part("arm", "inactive"), at=after(1)))

    assert not begun.is_whole
    assert changed.is_whole
    assert changed.as_json() == {
        "at": after(1),
        "parts": named("name", part("arm", "inactive"), part("base")),
    }


def test_as_json_it_has_each_member_as_an_answer_to_a_request_has_it() -> None:
    known = robot(frame(holds={"operator": hold("operator")}), parts=(part("arm"),))

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
        "errors",
        "reactions",
        "devices",
        "this_device",
    ]
    assert shown["parts"] == {"arm": part("arm")}
    assert shown["emergency_stop"] == stop()
    assert shown["holds"] == [hold("operator")]


def test_a_frame_of_an_unknown_type_tells_nothing() -> None:
    assert fold(robot(), {"type": "weather"}) == robot()


def test_errors_are_known_until_they_are_told_to_be_normal() -> None:
    low, lost = error("BATTERY_LOW"), error("UNREACHABLE", "arm")
    known = fold(robot(), frame(errors={"BATTERY_LOW": low, "arm.UNREACHABLE": lost}))
    known = fold(known, frame(after(1)))
    assert known.errors == {"BATTERY_LOW": low, "arm.UNREACHABLE": lost}
    assert known.as_json()["errors"] == [low, lost]

    known = fold(known, frame(after(2), errors={"BATTERY_LOW": {**low, "state": "normal"}}))
    assert known.errors == {"arm.UNREACHABLE": lost}


def test_an_error_that_is_shelved_is_known_though_it_is_normal() -> None:
    shelved = {**error("BATTERY_LOW", state="normal"), "shelved_until_at": AT}
    known = fold(robot(), frame(errors={"BATTERY_LOW": shelved}))
    assert known.errors == {"BATTERY_LOW": shelved}


def test_after_a_reconnection_only_the_errors_of_the_next_frame_are_known() -> None:
    known = fold(robot(), frame(errors={"arm.DEVIATES": error("DEVIATES", "arm")}))
    assert fold(known, hello()).errors == {}


def test_reactions_are_known_as_they_were_told_last() -> None:
    known = fold(robot(), frame(reactions={"a.LIMP": {"state": "idle"}}))
    known = fold(known, frame(after(1), reactions={"a.LIMP": {"state": "acting"}}))

    assert known.reactions == {"a.LIMP": {"state": "acting"}}
    assert known.as_json()["reactions"] == [{"state": "acting"}]


def test_devices_that_changed_are_taken_and_the_others_stay() -> None:
    known = robot(frame(devices=named("device", device("arm"), device("base"))))

    known = fold(known, frame(after(1), devices=named("device", device("arm", "lost"))))

    assert {name: each["state"] for name, each in known.devices.items()} == {
        "arm": "lost",
        "base": "connected",
    }


def test_whose_word_counts_on_a_device_stays_until_it_is_told_anew() -> None:
    known = robot(frame(this_device=this_device("arm")))
    assert fold(known, frame(after(1))).this_device == this_device("arm")

    known = fold(known, frame(after(2), this_device=this_device("arm", "cut_off")))
    assert known.this_device == this_device("arm", "cut_off")
