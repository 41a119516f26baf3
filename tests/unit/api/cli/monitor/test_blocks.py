import pytest
from rich.text import Text

from api.cli.monitor import blocks
from api.cli.monitor.rows import SignalRow
from api.cli.monitor.store import Json, Robot
from api.cli.monitor.view import Contact, Level, View
from tests.support.monitor import (
    AT,
    after,
    console,
    device,
    error,
    event,
    frame,
    hello,
    hold,
    named,
    robot,
    signal,
    stop,
    system_state,
    task,
    this_device,
    view,
)
from tests.support.sentence_cases import moving


def plain(lines: list[Text]) -> list[str]:
    return [line.plain.rstrip() for line in lines]


def drawn_signals(*signals: Json, later_s: float = 0.0, room: int | None = None) -> list[str]:
    rows = [SignalRow(given) for given in signals]
    return plain(blocks.signals(view(robot(), later_s=later_s), rows, 80, room))


def drawn_task(*messages: Json, later_s: float = 0.0) -> list[str]:
    return plain(blocks.task(view(robot(*messages), later_s=later_s), console()))


def drawn_head(seen: View) -> list[str]:
    return plain(blocks.head(seen))


def test_the_head_is_that_of_the_mode_monitor_with_date_model_and_address() -> None:
    seen = view(robot(hello(model="actuation.yaml")))

    title, about = drawn_head(seen)

    assert title.startswith(" System Modes Monitor - Mon May  4 ")
    assert title.endswith(" 2026")
    assert about == " Model: actuation.yaml  http://robot:8000"


def test_the_head_says_what_is_not_real() -> None:
    state = {**system_state(), "simulated": ["nodes", "vehicle"]}

    about = drawn_head(view(robot(frame(system_state=state))))[1]

    assert about.endswith("  simulated: nodes, vehicle")


def test_the_head_marks_what_is_old() -> None:
    assert drawn_head(view(robot(), Contact(Level.LOST, 9.0)))[0].endswith(" 2026 (old)")


def test_before_the_first_frame_the_head_says_no_time_and_no_model() -> None:
    assert drawn_head(view(Robot())) == [
        " System Modes Monitor",
        " Model: ?  http://robot:8000",
    ]


def test_a_signal_has_value_age_and_verdict() -> None:
    assert drawn_signals(signal("battery_level", 0.9, "ratio"), later_s=0.5)[1] == (
        "  battery_level      90 %           now         ok"
    )


def test_ages_are_counted_from_when_the_reading_came() -> None:
    line = drawn_signals(signal("x", received_at=after(2)), later_s=64.0)[1]

    assert " 1 min 2 s " in line


def test_a_signal_that_never_came_says_so() -> None:
    line = drawn_signals(signal("x", None, received_at=None, stale=True))[1]

    assert line.split() == ["!", "x", "?", "never", "stale"]


def test_an_error_that_comes_is_counted_down() -> None:
    pending = {"error": "GPS_LOST", "since_at": AT, "needs_s": 15.0}

    line = drawn_signals(signal("gps", pending=pending), later_s=5.0)[1]

    assert line.startswith("> gps ")
    assert line.endswith("GPS_LOST in 10 s")


def test_without_room_for_all_signals_the_rest_is_counted() -> None:
    given = [signal("a"), signal("b", stale=True), signal("c"), signal("d", stale=True)]

    assert drawn_signals(*given, room=3)[1:] == [
        "! b                  1              now         stale",
        "  ... and 3 more signals, 1 of them marked",
    ]


def test_where_not_even_a_row_fits_there_are_no_titles() -> None:
    assert drawn_signals(signal("a"), room=1) == []


def test_no_task_is_told() -> None:
    assert drawn_task() == ["no task"]


def test_a_task_is_told_with_its_way_and_how_it_drives() -> None:
    assert drawn_task(frame(task=task(), vehicle={"speed_mps": 2.7})) == [
        "task t1  RUNNING  42 %, 336 m of 800 m, waypoint 41 of 66",
        "  2.7 of 2.8 m/s, 0.03 m left of the path",
    ]


def test_why_a_task_waits_is_told() -> None:
    lines = drawn_task(frame(task=task("PAUSED", reason="the vehicle is lost")))

    assert lines[-1] == "  the vehicle is lost"


def test_how_the_last_task_ended_stays_until_the_next() -> None:
    lines = drawn_task(frame(task=task("SUCCEEDED", ended_at=AT)))

    assert lines[0] == "no task"
    assert lines[1].startswith("  task t1 succeeded at ")


def test_holds_are_told_instead_with_since_when_and_by_whom() -> None:
    holds = named("owner", hold("operator", "loading", "anna"), hold("error"))
    paused = task("PAUSED", reason="loading; error")

    lines = drawn_task(frame(task=paused, holds=holds), later_s=5.0)

    assert lines[-2:] == [
        "  held by operator: loading, for 5 s, by anna",
        "  held by error, for 5 s",
    ]


def test_reasons_wrap_and_stay_behind_their_beginning() -> None:
    long = "battery 42 % is below 50 %, and that is told at some length"
    state = system_state("ERROR", long, "e-stop is pressed")

    lines = blocks.sentences(view(robot(frame(system_state=state))), console(30))

    assert plain(lines) == [
        "ERROR  battery 42 % is below",
        "  50 %, and that is told at",
        "  some length",
        "  e-stop is pressed",
    ]


def test_the_stop_is_told_before_the_state() -> None:
    engaged = stop(engaged=True, reason="smoke", since_at=AT)

    known = robot(frame(emergency_stop=engaged, vehicle=moving(0.0)))
    lines = blocks.sentences(view(known), console(80))

    assert plain(lines) == [
        "EMERGENCY STOP  engaged: smoke, for 0 s, no standstill yet",
        "IDLE  no task",
    ]


def test_that_storage_fails_is_told_after_the_state() -> None:
    full = {**system_state(), "storage_fault": "the disk is full"}

    lines = blocks.sentences(view(robot(frame(system_state=full))), console(80))

    assert plain(lines) == [
        "IDLE  no task",
        "STORAGE FAILS  the disk is full; a restart may forget what you ask now",
    ]


def test_a_reason_cannot_move_the_cursor() -> None:
    state = system_state("ERROR", "\x1b[2Jgone")

    (line,) = blocks.sentences(view(robot(frame(system_state=state))), console(80))

    assert line.plain == "ERROR  ?[2Jgone"


@pytest.mark.parametrize(("room", "told"), [(2, ["t2 drives", "t3 drives"]), (0, []), (-1, [])])
def test_of_what_happened_the_newest_is_told(room: int, told: list[str]) -> None:
    starts = [event(number, f"task t{number} drives") for number in (1, 2, 3)]

    lines = plain(blocks.notes(view(robot(*starts)), room))

    assert [line[len("12:00:00  task ") :] for line in lines] == told


# --- errors of parts -----------------------------------------------------------------------------


def drawn_errors(*errors: Json) -> list[str]:
    told = {f"{item['part']}.{item['error']}": item for item in errors}
    return plain(blocks.errors(view(robot(frame(errors=told)))))


def test_without_errors_of_parts_nothing_is_said_of_them() -> None:
    assert drawn_errors() == []
    assert drawn_errors(error("BATTERY_LOW"), error("DEVIATES", "arm", "pending")) == []


def test_errors_of_parts_are_counted_and_named_the_newest_first() -> None:
    assert drawn_errors(error("UNREACHABLE", "arm")) == [
        "errors of parts: 1 urgent: arm.UNREACHABLE"
    ]
    many = [error("DEVIATES", f"n{number}") for number in range(100)]
    (line,) = drawn_errors(*many)
    assert line.startswith("errors of parts: 100 urgent: n99.DEVIATES, n98.DEVIATES, ")
    assert line.endswith(" n80.DEVIATES")


def test_the_worst_errors_of_parts_are_named_first() -> None:
    blind = {**error("BLIND", "carrier"), "severity": "critical"}
    (line,) = drawn_errors(blind, error("SILENT", "lidar"))
    assert line == "errors of parts: 1 critical, 1 urgent: carrier.BLIND, lidar.SILENT"


def test_what_follows_or_is_silenced_is_only_counted() -> None:
    late = {**error("LATE", "mapper"), "root_cause": False}
    hidden = {**error("HOT", "arm"), "suppressed": True}
    gone = error("SLOW", "arm", "returned")
    (line,) = drawn_errors(error("SILENT", "lidar"), late, hidden, gone)
    assert line == (
        "errors of parts: 1 urgent: lidar.SILENT, 1 follow from these, 1 returned unseen,"
        " 1 not announced"
    )


# --- reactions -----------------------------------------------------------------------------------


def drawn_reactions(**states: str) -> list[str]:
    told = {f"carrier.{name}": {"state": state} for name, state in states.items()}
    return plain(blocks.reactions(view(robot(frame(reactions=told)))))


def test_reactions_that_are_idle_are_not_told() -> None:
    assert drawn_reactions() == []
    assert drawn_reactions(LIMP="idle", HALT="pending") == []


def test_reactions_are_counted_and_named_by_how_they_stand() -> None:
    assert drawn_reactions(LIMP="acting", HALT="exhausted", REST="acting", TRY="passive") == [
        "reactions: 1 exhausted: carrier.HALT; 2 acting: carrier.LIMP, carrier.REST;"
        " 1 passive: carrier.TRY"
    ]


# --- devices -------------------------------------------------------------------------------------


def drawn_devices(*devices: Json, later_s: float = 0.0, **more: object) -> list[str]:
    message = {**frame(devices=named("device", *devices)), **more}
    known = robot(message)
    return plain(blocks.devices(view(known, later_s=later_s)))


def test_devices_that_are_connected_are_not_told() -> None:
    assert drawn_devices() == []
    assert drawn_devices(device("arm")) == []


def test_a_device_that_is_lost_is_told_with_for_how_long() -> None:
    told = drawn_devices(device("arm", "lost"), device("base", "late"), later_s=12)

    assert told == ["devices: arm lost for 12 s, base late"]


def test_the_monitor_of_a_device_says_whose_word_counts() -> None:
    own = this_device("arm", "device")

    assert drawn_devices(this_device=own) == ["device arm: acts alone"]
