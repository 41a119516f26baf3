import pytest

from api.cli.monitor.sentence import (
    Sentence,
    absence_sentence,
    contact_sentence,
    restart_sentence,
    standstill_words,
    state_sentence,
    stop_sentence,
    storage_sentence,
)
from api.cli.monitor.store import Json, Robot, fold
from api.cli.monitor.view import Contact, Level, seconds_of
from api.cli.monitor.words import time_of_day
from tests.support.monitor import (
    AT,
    after,
    device,
    frame,
    graph,
    hello,
    named,
    part,
    robot,
    stop,
    system,
    system_state,
    view,
)
from tests.support.sentence_cases import CASES, STORAGE, Case, combinations, moving, reason


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_is_said_of_a_state_is_true(case: Case) -> None:
    text = case.text.format(ended=time_of_day(seconds_of(AT)))

    said = state_sentence(view(robot(frame(**case.members))))

    assert said == Sentence(case.word, text, case.more, case.level)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_without_contact_the_same_is_told_of_the_past(case: Case) -> None:
    said = state_sentence(view(robot(frame(**case.members)), Contact(Level.LOST, 14.0)))

    assert said is not None
    assert said.word == f"WAS {case.word}"


def test_no_combination_is_told_better_than_it_is() -> None:
    for members in combinations():
        known = robot(frame(**members))
        said = state_sentence(view(known))
        assert said is not None
        task, holds, parts = known.current_task, known.holds, known.parts or {}
        whole = "; ".join([said.text, *said.more])
        if said.word == "RUNNING":
            assert task is not None, members
            assert (task["status"], holds) == ("RUNNING", {}), members
        if said.word == "IDLE":
            assert task is None, members
        if said.level == "calm" and said.word in ("IDLE", "PAUSED"):
            assert known.vehicle is not None, members
            assert known.vehicle["speed_mps"] in (None, 0.0, 0.049), members
        if said.text == "no task":
            assert (holds, said.level) == ({}, "calm"), members
            off = [part for part in parts.values() if not part["converged"] and not part["change"]]
            assert off == [], members
            assert known.task is None or known.task["status"] != "ABORTED", members
        if known.system_state is not None and known.system_state["state"] == "ERROR":
            assert said.level == "error", members
            assert said.word in ("ERROR", "STILL MOVING"), members
        for each in parts.values():
            if not each["reachable"]:
                assert f"{each['name']} is unreachable" in whole, members


def test_an_error_without_a_reason_tells_its_codes() -> None:
    state = {**system_state("ERROR"), "errors": ["BATTERY_LOW", "EMERGENCY_STOP"]}

    assert state_sentence(view(robot(frame(system_state=state)))) == Sentence(
        "ERROR", "BATTERY_LOW, EMERGENCY_STOP", level="error"
    )


def test_while_nothing_is_known_nothing_is_said_of_state_and_storage() -> None:
    assert state_sentence(view(Robot())) is None
    assert storage_sentence(view(Robot())) is None


@pytest.mark.parametrize(("state", "contact", "told"), STORAGE)
def test_that_storage_fails_is_told_with_what_follows(
    state: Json, contact: str, told: tuple[str, str] | None
) -> None:
    said = storage_sentence(view(robot(frame(system_state=state)), Contact(Level(contact), 1.0)))

    assert said == (None if told is None else Sentence(*told, level="attention"))


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


def told_of_graph(*parts: Json, settled: bool = True) -> Sentence | None:
    return absence_sentence(view(fold(Robot(), graph(*parts, settled=settled))))


def away(*names: str) -> list[Json]:
    return [part(name, "unknown", reachable=False) for name in names]


def test_nodes_of_a_graph_that_do_not_answer_are_named() -> None:
    assert told_of_graph(part("arm"), system("robot", "arm")) is None
    assert told_of_graph(part("arm"), *away("a", "b", "c", "d", "e")) == Sentence(
        "ABSENT", "5 of 6 nodes: a, b, c and 2 more", level="attention"
    )
    assert told_of_graph(part("arm"), *away("base"), settled=False) == Sentence(
        "LOOKING FOR", "1 of 2 nodes: base"
    )


def test_where_no_node_answers_it_says_what_may_be_wrong() -> None:
    said = told_of_graph(*away("arm"))

    assert said is not None
    assert "ROS_DOMAIN_ID" in said.more[0]


def test_what_a_service_tells_of_its_nodes_is_told_elsewhere() -> None:
    assert absence_sentence(view(robot(parts=tuple(away("arm"))))) is None


def test_a_released_stop_is_not_worth_a_word() -> None:
    assert stop_sentence(view(robot())) is None
    assert stop_sentence(view(Robot())) is None


def test_an_engaged_stop_says_why_since_when_by_whom_and_whether_the_vehicle_stands() -> None:
    engaged = stop(engaged=True, by="anna", reason="smoke", since_at=AT)

    def told(speed: float | None, **more: object) -> str:
        known = robot(frame(emergency_stop={**engaged, **more}, vehicle=moving(speed)))
        said = stop_sentence(view(known, later_s=3.0))
        assert said is not None
        assert said.word == "EMERGENCY STOP"
        assert said.text.startswith("engaged: smoke, for 3 s, by anna, ")
        return said.text.removeprefix("engaged: smoke, for 3 s, by anna, ")

    assert told(1.25) == "the vehicle moves at 1.2 m/s"
    assert told(0.0) == "no standstill yet"
    assert told(0.0, standstill_at=AT) == "the vehicle is at a standstill"
    assert told(None) == "it is not known whether the vehicle stands"
    # It stood once, and somebody pushes it.
    assert told(0.3, standstill_at=AT) == "the vehicle moves at 0.30 m/s"


def test_under_a_stop_that_does_not_stop_what_to_do_comes_first() -> None:
    def told(code: str, speed: float | None) -> str:
        state = reason(code, "after the stop")
        return standstill_words(robot(frame(system_state=state, vehicle=moving(speed))))

    still = "use the hardware stop: the vehicle still moves at 1.1 m/s"
    assert told("STILL_MOVING", 1.1) == still
    unknown = "use the hardware stop: the vehicle may be moving"
    assert told("STANDSTILL_UNKNOWN", None) == unknown


def test_a_stop_on_another_computer_says_where_it_is() -> None:
    stops = [{"id": "a-1", "device": "arm"}]
    engaged = stop(engaged=True, by="anna", since_at=AT, stops=stops, not_heard=["arm"])

    said = stop_sentence(view(robot(frame(emergency_stop=engaged))))

    assert said is not None
    assert said.text.startswith("engaged at device arm (not heard), for ")


def test_devices_that_may_go_on_under_a_stop_are_named() -> None:
    devices = named("device", device("arm", "lost"), device("base"))
    engaged = robot(frame(emergency_stop=stop(engaged=True, since_at=AT), devices=devices))

    said = stop_sentence(view(engaged))

    assert said is not None
    assert said.more == ("arm is not known to be stopped",)


def test_without_contact_a_stop_was_engaged_and_its_time_does_not_run_on() -> None:
    engaged = robot(frame(after(2), emergency_stop=stop(engaged=True, since_at=AT)))

    said = stop_sentence(view(engaged, Contact(Level.LOST, 30.0), 32.0))

    assert said is not None
    assert said.text.startswith("was engaged, for 2 s")


def test_a_restart_is_told_for_ten_minutes() -> None:
    restarted = robot(hello("two", after(3)), frame(after(4)))

    told = restart_sentence(view(restarted, later_s=60.0))

    assert told is not None
    assert told.word == "RESTARTED"
    assert told.text.endswith("earlier tasks and holds are gone")
    kept = robot(hello("two", after(3), boot=2), frame(after(4)))
    assert restart_sentence(view(kept, later_s=60.0)) == Sentence(
        "RESTARTED", f"{told.text.partition(';')[0]}; nothing moves before somebody asks"
    )
    assert restart_sentence(view(restarted, later_s=700.0)) is None
    assert restart_sentence(view(robot())) is None
