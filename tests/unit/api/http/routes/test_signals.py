"""`/signals` as an operator, or a sensor, uses it."""

from collections.abc import AsyncIterator

import pytest

from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.inputs import Reading, Readings, SourceFault
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from service.files.robot_settings import SignalsBlock
from tests.support.http_robot import HttpRobot, http_robot

GOOD = {
    "battery_level": 0.9,
    "estop": False,
    "gps_accuracy": 100,
    "signal_strength": "CONNECTED",
    "temperature": 30,
}

SIGNAL_FIELDS = {
    "signal",
    "value",
    "unit",
    "source",
    "received_at",
    "age_s",
    "stale",
    "error",
    "pending",
    "settings",
}


@pytest.fixture
async def unmocked() -> AsyncIterator[HttpRobot]:
    async with http_robot(mock=False) as robot:
        yield robot


async def test_the_five_signals_are_listed_with_every_field(robot: HttpRobot) -> None:
    items = (await robot.get("/signals"))["items"]

    assert {item["signal"] for item in items} == set(GOOD)
    assert all(set(item) >= SIGNAL_FIELDS for item in items)


async def test_the_age_is_that_of_the_moment_of_the_question(unmocked: HttpRobot) -> None:
    await unmocked.http.post("/signals/temperature", json={"value": 21.5})
    await unmocked.pass_time(1.25)

    signal = await unmocked.get("/signals/temperature")

    assert (signal["value"], signal["age_s"], signal["source"]) == (21.5, 1.25, "api")
    assert signal["received_at"] == "2026-01-01T00:00:00.000Z"


async def test_a_signal_never_seen_has_no_age_and_is_stale(unmocked: HttpRobot) -> None:
    signal = await unmocked.get("/signals/temperature")

    assert (signal["value"], signal["age_s"], signal["received_at"]) == (None, None, None)
    assert signal["stale"] is True


async def test_a_signal_says_why_its_source_gives_no_reading(unmocked: HttpRobot) -> None:
    unmocked.supervisor.submit(SourceFault("temperature", "file", "no such file"))
    await unmocked.pass_time(3)

    assert (await unmocked.get("/signals/temperature"))["source_fault"] == "no such file"
    reasons = (await unmocked.get("/system_state"))["reasons"]
    assert "no reading of temperature yet: no such file" in [r["message"] for r in reasons]

    reading = {"value": 20, "source": "file"}
    await unmocked.http.post("/signals/temperature", json=reading)
    assert (await unmocked.get("/signals/temperature"))["source_fault"] is None


async def test_an_error_that_is_on_its_way_tells_how_far_it_is(robot: HttpRobot) -> None:
    await robot.http.post("/signals/gps_accuracy", json={"value": 250})
    await robot.pass_time(6)

    pending = (await robot.get("/signals/gps_accuracy"))["pending"]

    assert (pending["error"], pending["needs_s"]) == ("GPS_LOST", 15.0)
    assert pending["for_s"] == pytest.approx(6, abs=0.2)


async def test_a_reading_is_decided_on_arrival(robot: HttpRobot) -> None:
    answer = await robot.http.post("/signals/battery_level", json={"value": 0.42})

    state = answer.json()
    assert answer.status_code == 200
    assert set(state) == {
        "seq",
        "at",
        "state",
        "error_code",
        "errors",
        "reasons",
        "task_status",
        "simulated",
        "storage_fault",
    }
    assert (state["state"], state["error_code"], state["errors"]) == ("ERROR", 1, ["BATTERY_LOW"])
    assert state["reasons"][0]["value"] == 0.42
    assert state["seq"] == robot.supervisor.publisher.seq


async def test_several_readings_are_taken_together(unmocked: HttpRobot) -> None:
    answer = await unmocked.http.post("/signals", json=GOOD)

    assert answer.json()["state"] == "IDLE"


@pytest.mark.parametrize(
    ("signal", "value", "code"),
    [
        ("temperature", "hot", "INVALID_VALUE"),
        ("temperature", True, "INVALID_VALUE"),
        ("temperature", None, "INVALID_VALUE"),
        ("temperature", [1], "INVALID_VALUE"),
        ("battery_level", 1.5, "INVALID_VALUE"),
        ("gps_accuracy", -1, "INVALID_VALUE"),
        ("estop", 2, "INVALID_VALUE"),
        ("estop", "false", "INVALID_VALUE"),
        ("signal_strength", "GREAT", "INVALID_VALUE"),
        ("mood", 1, "UNKNOWN_SIGNAL"),
    ],
)
async def test_one_reading_that_cannot_be_right_lets_none_be_taken(
    signal: str, value: object, code: str, unmocked: HttpRobot
) -> None:
    await unmocked.http.post("/signals", json=GOOD)

    answer = await unmocked.http.post("/signals", json={"battery_level": 0.1, signal: value})

    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert (fault["pointer"], fault["code"]) == (f"/{signal}", code)
    assert (await unmocked.get("/signals/battery_level"))["value"] == 0.9


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", "1e999", '"1"', "true"])
async def test_what_is_no_number_is_no_temperature(value: str, unmocked: HttpRobot) -> None:
    answer = await unmocked.http.post("/signals/temperature", content=f'{{"value": {value}}}')

    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == ["/value"]
    assert (await unmocked.get("/signals/temperature"))["value"] is None


async def test_a_signal_that_there_is_not_is_not_found(robot: HttpRobot) -> None:
    shown = await robot.http.get("/signals/mood")
    posted = await robot.http.post("/signals/mood", json={"value": 1})

    assert (shown.status_code, shown.json()["code"]) == (404, "UNKNOWN_SIGNAL")
    assert (posted.status_code, posted.json()["code"]) == (404, "UNKNOWN_SIGNAL")


# --- stamps -------------------------------------------------------------------------------------


async def test_a_stamp_is_kept_and_shown(unmocked: HttpRobot) -> None:
    body = {"value": 20, "stamp": "2026-01-01T00:59:59.500+01:00"}

    await unmocked.http.post("/signals/temperature", json=body)

    signal = await unmocked.get("/signals/temperature")
    assert signal["stamp_at"] == "2025-12-31T23:59:59.500Z"
    assert signal["age_s"] == 0.0


@pytest.mark.parametrize("stamp", ["2026-01-01T00:00:00", "yesterday", "2026-13-01T00:00:00Z", ""])
async def test_a_stamp_that_is_no_moment_is_refused(stamp: str, unmocked: HttpRobot) -> None:
    body = {"value": 20, "stamp": stamp}

    answer = await unmocked.http.post("/signals/temperature", json=body)

    assert answer.status_code == 422
    assert [fault["pointer"] for fault in answer.json()["errors"]] == ["/stamp"]


async def test_a_reading_older_than_the_one_that_is_held_is_refused(unmocked: HttpRobot) -> None:
    for stamp, status in (("2026-01-01T00:00:00Z", 200), ("2025-12-31T23:59:59Z", 409)):
        body = {"value": 20, "stamp": stamp}
        answer = await unmocked.http.post("/signals/temperature", json=body)

        assert answer.status_code == status

    assert answer.json()["code"] == "OUTDATED_READING"


# --- who measured -------------------------------------------------------------------------------


async def test_one_source_of_the_e_stop_cannot_release_anothers(unmocked: HttpRobot) -> None:
    await unmocked.http.post("/signals", json=GOOD)
    await unmocked.http.post("/signals/estop", json={"value": True, "source": "left button"})
    await unmocked.pass_time(1)

    released = await unmocked.http.post("/signals", json={"estop": False, "source": "panel"})

    assert "ESTOP" in released.json()["errors"]
    assert "left button" in released.json()["reasons"][0]["message"]


@pytest.mark.parametrize("source", ["", "x" * 65])
async def test_a_source_has_a_name_of_reasonable_length(source: str, unmocked: HttpRobot) -> None:
    one = await unmocked.http.post("/signals/estop", json={"value": False, "source": source})
    many = await unmocked.http.post("/signals", json={"estop": False, "source": source})

    assert (one.status_code, many.status_code) == (422, 422)


async def test_where_the_mock_runs_it_goes_on_with_the_value_that_was_posted(
    robot: HttpRobot,
) -> None:
    await robot.http.post("/signals/battery_level", json={"value": 0.42})
    await robot.pass_time(3)

    signal = await robot.get("/signals/battery_level")

    assert (signal["value"], signal["stale"]) == (0.42, False)


@pytest.mark.parametrize(
    ("path", "body"), [("/signals/estop", {"value": True}), ("/signals", {"estop": True})]
)
async def test_where_the_mock_runs_it_stands_in_for_senders_without_a_name(
    path: str, body: dict[str, bool], robot: HttpRobot
) -> None:
    pressed = await robot.http.post(path, json=body)

    assert "mock" in pressed.json()["reasons"][0]["message"]


async def test_a_sender_with_a_name_keeps_it_where_the_mock_runs(robot: HttpRobot) -> None:
    one = await robot.http.post("/signals/estop", json={"value": True, "source": "left button"})
    many = await robot.http.post("/signals", json={"estop": True, "source": "right button"})

    assert "left button" in one.json()["reasons"][0]["message"]
    assert "right button" in many.json()["reasons"][0]["message"]


async def test_where_no_mock_runs_a_sender_without_a_name_is_the_api(unmocked: HttpRobot) -> None:
    await unmocked.http.post("/signals", json={"temperature": 31})
    await unmocked.http.post("/signals/battery_level", json={"value": 0.42, "source": None})

    for signal in ("battery_level", "temperature"):
        assert (await unmocked.get(f"/signals/{signal}"))["source"] == "api"


async def test_the_mock_does_not_release_a_stop_that_was_pressed_under_a_name(
    robot: HttpRobot,
) -> None:
    await robot.http.post("/signals/estop", json={"value": True, "source": "left button"})
    await robot.pass_time(3)

    released = await robot.http.post("/signals/estop", json={"value": False})

    assert "ESTOP" in released.json()["errors"]


async def test_an_e_stop_that_came_with_another_signal_is_released_like_any_other() -> None:
    load = SignalSettings(SignalSpec("load", SignalKind.NUMBER), (), stale_after=0)
    settings = SupervisionSettings(signals=(*default_signals(), load))
    async with http_robot(settings=settings) as robot:
        await robot.http.post("/signals", json={"load": 300, "estop": True})
        await robot.http.post("/signals/estop", json={"value": False})
        await robot.pass_time(1)

        assert (await robot.get("/system_state"))["errors"] == []


async def test_what_is_pending_agrees_with_what_is_raised_and_with_what_it_says() -> None:
    load = {"error": "OVERLOAD", "unit": "kg", "above": 1500.0, "for_s": 3.0, "stale_after_s": 0.0}
    signals = SignalsBlock.model_validate({"stale_after_s": 0.0, "load": load}).to_domain()
    async with http_robot(settings=SupervisionSettings(signals=signals)) as robot:
        await robot.http.post("/signals/load", json={"value": 100})
        await robot.pass_time(6)
        answer = await robot.http.post("/signals/load", json={"value": 1800})
        assert answer.json()["errors"] == []

        await robot.pass_time(2.5)
        shown = await robot.get("/signals/load")
        assert shown["error"] is None
        assert shown["pending"] == {
            "error": "OVERLOAD",
            "since_at": "2026-01-01T00:00:06.000Z",
            "for_s": 2.5,
            "needs_s": 3.0,
        }

        await robot.pass_time(0.5)
        (reason,) = (await robot.get("/system_state"))["reasons"]
        assert reason["message"] == "load 1800 kg has been above 1500 kg for 3 s"
        assert reason["since_at"] == "2026-01-01T00:00:09.000Z"
        assert (await robot.get("/signals/load"))["pending"] is None


# --- history ------------------------------------------------------------------------------------


async def test_the_history_has_every_reading_and_its_error(unmocked: HttpRobot) -> None:
    for value in (0.9, 0.42, 0.8):
        await unmocked.http.post("/signals/battery_level", json={"value": value})
        await unmocked.pass_time(1)

    history = await unmocked.get("/signals/battery_level/history")

    assert history["tier_s"] == 1.0
    assert [(item["at"], item["last"], item["error"]) for item in history["items"]] == [
        ("2026-01-01T00:00:00.000Z", 0.9, None),
        ("2026-01-01T00:00:01.000Z", 0.42, "BATTERY_LOW"),
        ("2026-01-01T00:00:02.000Z", 0.8, None),
    ]
    assert set(history["items"][0]) == {"at", "min", "max", "mean", "last", "error"}


@pytest.mark.parametrize(
    ("span", "found"),
    [
        ("from_at=0001-01-01T00:00:00Z&to_at=9999-12-31T23:59:59Z", 1),
        ("from_at=0001-01-01T00:00:00Z&to_at=9999-12-31T23:59:59Z&points=2", 1),
        ("to_at=9999-12-31T23:59:59Z", 0),
        ("from_at=0001-01-01T00:00:00Z&to_at=0002-01-01T00:00:00Z", 0),
    ],
)
async def test_a_history_may_be_as_long_as_a_calendar(
    unmocked: HttpRobot, span: str, found: int
) -> None:
    await unmocked.http.post("/signals/temperature", json={"value": 20})

    history = await unmocked.get(f"/signals/temperature/history?{span}")

    assert len(history["items"]) == found


async def test_a_history_cannot_be_posted(unmocked: HttpRobot) -> None:
    answer = await unmocked.http.post("/signals/temperature/history", json={"value": 20})

    assert (answer.status_code, answer.headers["Allow"]) == (405, "GET, HEAD")


@pytest.mark.parametrize("at", ["17", "1.7e9", "2026-01-01"])
async def test_moments_of_a_history_are_no_numbers(unmocked: HttpRobot, at: str) -> None:
    answer = await unmocked.http.get(f"/signals/temperature/history?from_at={at}")

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")
    assert "RFC 3339" in answer.json()["detail"]


async def test_a_short_history_has_single_readings(unmocked: HttpRobot) -> None:
    await unmocked.http.post("/signals/temperature", json={"value": 20})
    await unmocked.http.post("/signals/temperature", json={"value": 21})

    span = "from_at=2025-12-31T23:59:00Z&to_at=2026-01-01T01:00:01%2B01:00"
    history = await unmocked.get(f"/signals/temperature/history?{span}")

    assert [item["last"] for item in history["items"]] == [20.0, 21.0]
    assert history["tier_s"] == 0.0


async def test_a_history_of_few_points_keeps_a_spike(unmocked: HttpRobot) -> None:
    for second in range(30):
        value = 99.0 if second == 17 else 20.0
        await unmocked.http.post("/signals/temperature", json={"value": value})
        await unmocked.pass_time(1)

    items = (await unmocked.get("/signals/temperature/history?points=3"))["items"]

    assert 1 <= len(items) <= 3
    assert max(item["max"] for item in items) == 99.0
    assert {item["error"] for item in items} >= {"TEMPERATURE_HIGH"}


async def test_the_history_of_members_and_of_a_stop(unmocked: HttpRobot) -> None:
    for strength, pressed in (("CONNECTED", False), ("NOT_CONNECTED", True), ("CONNECTED", False)):
        body = {"signal_strength": strength, "estop": pressed}
        await unmocked.http.post("/signals", json=body)
    await unmocked.pass_time(1)

    (member,) = (await unmocked.get("/signals/signal_strength/history?points=2"))["items"]
    (stop,) = (await unmocked.get("/signals/estop/history?points=2"))["items"]

    assert (member["min"], member["max"]) == ("CONNECTED", "NOT_CONNECTED")
    assert (member["mean"], member["last"]) == (None, "CONNECTED")
    assert (stop["min"], stop["max"], stop["last"], stop["error"]) == (0.0, 1.0, 0.0, "ESTOP")
    assert stop["mean"] == pytest.approx(1 / 3)


async def test_a_signal_that_was_never_read_has_an_empty_history(unmocked: HttpRobot) -> None:
    assert (await unmocked.get("/signals/temperature/history"))["items"] == []


async def test_there_is_no_history_of_a_signal_that_there_is_not(robot: HttpRobot) -> None:
    answer = await robot.http.get("/signals/temprature/history")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_SIGNAL")
    assert "did you mean temperature?" in answer.json()["hint"]


@pytest.mark.parametrize(
    ("query", "parameter"),
    [
        ("points=1", "points"),
        ("points=10001", "points"),
        ("points=many", "points"),
        ("from_at=yesterday", "from_at"),
        ("from_at=2026-01-01T00:00:00", "from_at"),
        ("to_at=2026-13-01T00:00:00Z", "to_at"),
        ("from_at=2026-01-01T00:00:01Z&to_at=2026-01-01T00:00:01Z", "from_at"),
        ("from_at=2027-01-01T00:00:00Z", "from_at"),
    ],
)
async def test_a_history_that_cannot_be_is_refused_with_the_reason(
    query: str, parameter: str, robot: HttpRobot
) -> None:
    answer = await robot.http.get(f"/signals/temperature/history?{query}")

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_QUERY")
    (fault,) = answer.json()["errors"]
    assert fault["message"].startswith(f"query {parameter}: ")


async def test_a_history_from_the_first_year_to_the_last_is_answered(unmocked: HttpRobot) -> None:
    await unmocked.http.post("/signals/temperature", json={"value": 20})

    span = "from_at=0001-01-01T00:00:00Z&to_at=9999-12-31T23:59:59Z"
    items = (await unmocked.get(f"/signals/temperature/history?{span}&points=2"))["items"]

    assert [item["last"] for item in items] == [20.0]


async def test_a_simulation_has_no_history() -> None:
    async with http_robot() as robot:
        robot.supervisor.trends = None
        answer = await robot.http.get("/signals/temperature/history")

    assert (answer.status_code, answer.json()["code"]) == (404, "NO_HISTORY")


# --- signals that a device reads ----------------------------------------------------------------

BASE = ComputerName("base")
READ_ON_BASE = SupervisionSettings(
    devices={BASE: DeviceSettings(BASE, (PartName("drive_base"),), ("temperature",))}
)


@pytest.fixture
async def of_devices() -> AsyncIterator[HttpRobot]:
    """Return a robot whose device reads the temperature, which is high."""
    async with http_robot(mock=False, settings=READ_ON_BASE) as robot:
        robot.supervisor.deliver(Readings((Reading("temperature", 95.0),), "can"))
        yield robot


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("/signals/temperature", {"value": 10}),
        ("/signals//temperature", {"value": 10}),
        ("/signals", {"temperature": 10}),
        ("/signals", {"battery_level": 0.3, "/temperature": 10}),
    ],
)
async def test_a_reading_of_a_signal_of_a_device_is_sent_there(
    path: str, body: dict[str, object], of_devices: HttpRobot
) -> None:
    answer = await of_devices.http.post(path, json=body)

    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (409, "ACTS_ELSEWHERE")
    assert problem["detail"] == "temperature is read on device base, whatever is said here"
    assert problem["hint"] == "post it at base"
    assert (await of_devices.get("/signals/temperature"))["value"] == 95.0
    assert (await of_devices.get("/signals/battery_level"))["value"] is None
    assert of_devices.supervisor.refused_readings.counts == {"http": 1}


async def test_a_stop_beside_a_reading_of_a_device_is_taken(of_devices: HttpRobot) -> None:
    answer = await of_devices.http.post("/signals", json={"temperature": 10, "estop": True})

    assert answer.status_code == 200
    assert [fault["code"] for fault in answer.json()["ignored"]] == ["ACTS_ELSEWHERE"]
    assert "ESTOP" in answer.json()["errors"]
    assert (await of_devices.get("/signals/temperature"))["value"] == 95.0


async def test_signals_that_no_device_reads_are_posted_as_ever(of_devices: HttpRobot) -> None:
    answer = await of_devices.http.post("/signals", json={"battery_level": 0.9})

    assert answer.status_code == 200
    assert (await of_devices.get("/signals/battery_level"))["value"] == 0.9
