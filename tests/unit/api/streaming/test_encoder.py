import asyncio
import json
from types import MappingProxyType
from typing import Any

import pytest

from api.http.page.assembled_page import assembled_page
from api.streaming.client_input import STATE_TOPICS
from api.streaming.encoder import StreamEncoder
from domain.actor import NOBODY
from domain.computers import ComputerName, DeviceState
from domain.devices.lead_view import LeadView, Word
from domain.errors import BlockedError
from domain.events.event import RecordedEvent
from domain.events.parts import NodeReported
from domain.findings import Blocker
from domain.parameters import Parameters
from domain.snapshot import EmergencyStopView, HoldView, PartView
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.event_log import Gap
from service.supervisor import Supervisor
from tests.support.frames import device_view, error_view, event, frame, part_view, signal_view
from tests.support.live_robot import make_supervisor

ALL = STATE_TOPICS
ARM = part_view("arm")
BATTERY = signal_view("battery_level", 0.8)


@pytest.fixture
def supervisor() -> Supervisor:
    return make_supervisor()


@pytest.fixture
def encoder(supervisor: Supervisor) -> StreamEncoder:
    return StreamEncoder(supervisor)


def read(text: str | bytes) -> dict[str, Any]:
    found = json.loads(text)
    assert isinstance(found, dict)
    return found


def test_the_first_frame_says_what_to_expect(
    encoder: StreamEncoder, supervisor: Supervisor
) -> None:
    hello = read(encoder.hello(frozenset({"signals", "parts"})))

    assert hello.pop("version").count(".") == 2
    assert hello == {
        "type": "hello",
        "epoch": supervisor.epoch,
        "boot": 1,
        "started_at": "2026-01-01T00:00:00.000Z",
        "model": "",
        "newest": 0,
        "topics": ["parts", "signals"],
        "period_s": 0.05,
        "page_version": assembled_page().version,
        "replay": None,
    }


def test_a_full_frame_holds_everything_with_the_fields_of_a_request(
    encoder: StreamEncoder,
) -> None:
    shown = read(encoder.frame(frame(20, [ARM], [BATTERY], full=True), 0, ALL))

    assert (shown["type"], shown["seq"], shown["skipped"]) == ("state", 20, 0)
    assert shown["at"] == "2026-01-01T00:00:01.000Z"
    assert shown["system_state"]["state"] == "IDLE"
    assert shown["system_state"]["seq"] == 20
    assert shown["system_state"]["simulated"] == ["nodes"]
    assert shown["parts"]["arm"]["target"] == {"state": "active", "mode": "__DEFAULT__"}
    assert shown["parts"]["arm"]["converged"] is True
    assert shown["signals"]["battery_level"]["value"] == 0.8


def test_a_frame_holds_no_ages(encoder: StreamEncoder) -> None:
    text = encoder.frame(frame(20, [ARM], [BATTERY], full=True), 0, ALL)

    assert b"age_s" not in text


def test_what_did_not_change_is_left_out(encoder: StreamEncoder) -> None:
    shown = read(encoder.frame(frame(2), 0, ALL))

    assert set(shown) == {"type", "seq", "at", "skipped", "system_state"}


def test_task_and_vehicle_are_sent_when_they_changed(encoder: StreamEncoder) -> None:
    driven = read(encoder.frame(frame(2, vehicle_changed=True), 0, ALL))
    ended = read(encoder.frame(frame(3, task_changed=True), 0, ALL))

    assert driven["vehicle"]["command"] == {"speed_mps": 0.0, "steering_angle_rad": 0.0}
    assert "task" not in driven
    assert ended["task"] is None
    assert "vehicle" not in ended


def test_holds_are_sent_whole_and_the_emergency_stop_too_when_they_changed(
    encoder: StreamEncoder,
) -> None:
    hold = HoldView("operator", "lunch", "http:1", seconds(1))
    held = read(encoder.frame(frame(2, holds={"operator": hold}, holds_changed=True), 0, ALL))
    stop = EmergencyStopView(
        engaged=True, by="http:1", reason="smoke", since=seconds(1), standstill_at=None
    )
    stopped = read(
        encoder.frame(frame(3, emergency_stop=stop, emergency_stop_changed=True), 0, ALL)
    )

    assert held["holds"] == {
        "operator": {
            "owner": "operator",
            "reason": "lunch",
            "by": "http:1",
            "since_at": "2026-01-01T00:00:01.000Z",
        }
    }
    assert "emergency_stop" not in held
    assert (stopped["emergency_stop"]["engaged"], stopped["emergency_stop"]["by"]) == (
        True,
        "http:1",
    )
    assert "holds" not in stopped


def test_errors_are_sent_by_name_when_they_changed(encoder: StreamEncoder) -> None:
    lost, low = error_view("arm", "UNREACHABLE"), error_view(None, "BATTERY_LOW")

    shown = read(encoder.frame(frame(2, errors=[lost, low]), 0, ALL))
    quiet = read(encoder.frame(frame(3), 0, ALL))

    assert list(shown["errors"]) == ["arm.UNREACHABLE", "BATTERY_LOW"]
    assert (shown["errors"]["arm.UNREACHABLE"]["part"], quiet.get("errors")) == ("arm", None)


def test_devices_are_sent_by_name_when_they_changed(encoder: StreamEncoder) -> None:
    arm = device_view("arm")

    shown = read(encoder.frame(frame(2, devices=[arm]), 0, ALL))
    quiet = read(encoder.frame(frame(3), 0, ALL))

    assert shown["devices"]["arm"]["state"] == "connected"
    assert "devices" not in quiet


def test_a_device_says_whose_word_counts_there_and_others_say_nothing(
    encoder: StreamEncoder,
) -> None:
    lead = LeadView(
        ComputerName("arm"), Word.CUT_OFF, DeviceState.LOST, seconds(1), "not heard", "nothing"
    )

    shown = read(encoder.frame(frame(2, lead=lead), 0, ALL))

    assert (shown["this_device"]["device"], shown["this_device"]["lead"]) == ("arm", "cut_off")
    assert "this_device" not in read(encoder.frame(frame(3, full=True), 0, ALL))


async def test_errors_are_encoded_ahead_also_for_clients_that_want_no_parts(
    encoder: StreamEncoder, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost = error_view("arm", "UNREACHABLE")
    supervisor.frames.publish(frame(1, [ARM], errors=[lost], full=True))
    await encoder.prepare(frozenset({"errors"}))
    monkeypatch.setattr(encoder._robot.errors, "_encode", lambda _view: "{}")  # noqa: SLF001

    complete = supervisor.frames.complete()
    assert complete is not None
    shown = read(encoder.frame(complete, 0, ALL))

    assert shown["errors"]["arm.UNREACHABLE"]["state"] == "active"


def test_a_full_frame_of_a_robot_without_parts_says_so(encoder: StreamEncoder) -> None:
    shown = read(encoder.frame(frame(2, full=True), 0, ALL))

    assert (shown["parts"], shown["signals"], shown["task"]) == ({}, {}, None)
    assert shown["errors"] == {}
    assert shown["holds"] == {}
    assert shown["emergency_stop"]["engaged"] is False


@pytest.mark.parametrize(
    ("topics", "members"),
    [
        ({"system_state"}, set()),
        ({"parts"}, {"parts"}),
        ({"signals", "events"}, {"signals"}),
        ({"errors"}, {"errors"}),
        ({"devices"}, {"devices"}),
        ({"task"}, {"task"}),
        ({"vehicle"}, {"vehicle"}),
        ({"holds"}, {"holds"}),
        ({"emergency_stop"}, {"emergency_stop"}),
    ],
)
def test_only_the_topics_that_were_asked_for_are_sent_beside_the_system_state(
    encoder: StreamEncoder, topics: set[str], members: set[str]
) -> None:
    full = frame(2, [ARM], [BATTERY], full=True)

    shown = read(encoder.frame(full, 0, frozenset(topics)))

    assert set(shown) - {"type", "seq", "at", "skipped"} == {"system_state", *members}


def test_clients_in_step_get_the_very_same_text(encoder: StreamEncoder) -> None:
    published = frame(2, [ARM])

    first = encoder.frame(published, 0, ALL)

    assert encoder.frame(published, 0, ALL | {"events"}) is first


def test_a_client_that_missed_frames_is_told_how_many(encoder: StreamEncoder) -> None:
    published = frame(9, [ARM], full=True)
    in_step = read(encoder.frame(published, 0, ALL))

    behind = read(encoder.frame(published, 7, ALL))

    assert behind == {**in_step, "skipped": 7}


def test_a_frame_of_another_moment_is_another_text(encoder: StreamEncoder) -> None:
    encoder.frame(frame(2, [ARM]), 0, ALL)

    shown = read(encoder.frame(frame(3, [part_view("arm", "STRONG")]), 0, ALL))

    assert shown["seq"] == 3
    assert shown["parts"]["arm"]["actual"]["mode"] == "STRONG"


def test_the_full_and_the_short_form_of_one_moment_do_not_get_mixed_up(
    encoder: StreamEncoder,
) -> None:
    short, full = frame(2), frame(2, [ARM], full=True)

    texts = [encoder.frame(f, 0, ALL) for f in (short, full, short, full)]

    assert ["parts" in read(text) for text in texts] == [False, True, False, True]


def test_a_part_with_quotes_in_its_name_is_still_json(encoder: StreamEncoder) -> None:
    odd = part_view('arm "left"\n')

    shown = read(encoder.frame(frame(2, [odd]), 0, ALL))

    assert list(shown["parts"]) == ['arm "left"\n']


def test_a_view_that_did_not_change_is_not_encoded_again(
    encoder: StreamEncoder, monkeypatch: pytest.MonkeyPatch
) -> None:
    views = [part_view(f"node_{n}") for n in range(3)]
    encoder.frame(frame(1, views, full=True), 0, ALL)
    encoded: list[str] = []

    def encode(view: PartView) -> str:
        encoded.append(view.name)
        return "{}"

    members = encoder._robot.parts  # noqa: SLF001 - the point of the class is what it does not do
    monkeypatch.setattr(members, "_encode", encode)

    encoder.frame(frame(2, [views[0], part_view("node_1", "FAST"), views[2]], full=True), 0, ALL)

    assert encoded == ["node_1"]


async def test_a_large_frame_is_made_in_pieces_between_which_others_run(
    encoder: StreamEncoder, supervisor: Supervisor
) -> None:
    views = [part_view(f"node_{number}") for number in range(2_000)]
    turns: list[None] = []

    async def take_turns() -> None:
        while True:
            turns.append(None)
            await asyncio.sleep(0)

    other = asyncio.create_task(take_turns())
    published = frame(1, views, full=True)
    supervisor.frames.publish(published)
    await encoder.prepare(ALL)
    other.cancel()

    assert len(turns) >= 10
    assert len(read(encoder.frame(published, 0, ALL))["parts"]) == 2_000


async def test_parts_that_change_while_others_are_encoded_are_encoded_as_well(
    encoder: StreamEncoder, supervisor: Supervisor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A client that skipped frames meanwhile is sent all parts, and none is left for that turn."""
    names = [f"node_{number}" for number in range(2_000)]
    supervisor.frames.publish(frame(1, [part_view(name) for name in names], full=True))
    preparing = asyncio.create_task(encoder.prepare(ALL))
    await asyncio.sleep(0)
    supervisor.frames.publish(frame(2, [part_view(name) for name in names]))
    supervisor.frames.publish(frame(3, [part_view(name) for name in names[:10]]))
    await preparing
    encoded: list[str] = []

    def encode(view: PartView) -> str:
        encoded.append(view.name)
        return "{}"

    monkeypatch.setattr(encoder._robot.parts, "_encode", encode)  # noqa: SLF001 - as above
    complete = supervisor.frames.complete()

    assert complete is not None
    assert len(read(encoder.frame(complete, 1, ALL))["parts"]) == 2_000
    assert encoded == []


async def test_parts_that_change_faster_than_they_are_encoded_hold_nobody_up(
    encoder: StreamEncoder, supervisor: Supervisor
) -> None:
    names = [f"node_{number}" for number in range(1_000)]
    supervisor.frames.publish(frame(1, [part_view(name) for name in names], full=True))
    preparing = asyncio.create_task(encoder.prepare(ALL))
    for seq in range(2, 40):
        supervisor.frames.publish(frame(seq, [part_view(name) for name in names]))
        await asyncio.sleep(0)

    assert preparing.done()


async def test_a_large_frame_of_known_parts_is_made_at_once(
    encoder: StreamEncoder, supervisor: Supervisor
) -> None:
    views = [part_view(f"node_{number}") for number in range(2_000)]
    encoder.frame(frame(1, views, full=True), 0, ALL)
    supervisor.frames.publish(frame(2, views, full=True))
    preparing = encoder.prepare(ALL)

    with pytest.raises(StopIteration):
        preparing.send(None)


def test_an_event_has_the_fields_that_the_log_is_read_by(
    encoder: StreamEncoder, supervisor: Supervisor
) -> None:
    assert read(encoder.event(event(88))) == {
        "type": "event",
        "epoch": supervisor.epoch,
        "id": 88,
        "at": "2026-01-01T00:01:28.000Z",
        "kind": "test.happened",
        "cause": 87,
        "actor": "test",
        "data": {"number": 88},
        "words": "number 88",
        "notable": True,
    }


def test_an_event_is_encoded_once(encoder: StreamEncoder) -> None:
    assert encoder.event(event(1)) is encoder.event(event(1))


def test_old_events_are_not_kept_for_ever(encoder: StreamEncoder) -> None:
    first = encoder.event(event(1))
    for number in range(2, 10_002):
        encoder.event(event(number))

    assert encoder.event(event(1)) is not first


def test_an_event_may_hold_what_json_does_not_know(encoder: StreamEncoder) -> None:
    parameters: Parameters = MappingProxyType({"speed": float("nan"), "gains": (1, 2)})
    reported = NodeReported(PartName("arm"), parameters=parameters)

    shown = read(encoder.event(RecordedEvent(1, seconds(1), None, NOBODY, reported)))

    assert shown["data"]["parameters"] == {"speed": None, "gains": [1, 2]}


def test_a_gap_says_from_where_to_where(encoder: StreamEncoder) -> None:
    assert read(encoder.gap(Gap(4, 15, "E1"))) == {
        "type": "gap",
        "from": 4,
        "to": 15,
        "epoch": "E1",
    }


def test_a_problem_is_the_document_of_a_request_as_a_frame(encoder: StreamEncoder) -> None:
    blocker = Blocker("ESTOP", "e-stop is pressed", ("arm", "estop"))

    shown = read(encoder.problem(BlockedError("arm", [blocker])))

    assert (shown["type"], shown["status"], shown["code"]) == ("problem", 409, "BLOCKED")
    assert shown["instance"] == "/ws"
    assert shown["blockers"][0]["code"] == "ESTOP"
