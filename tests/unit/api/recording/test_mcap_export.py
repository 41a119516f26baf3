"""What was recorded, as Foxglove and Lichtblick get it."""

import json
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import jsonschema_rs
import pytest
from mcap.reader import make_reader

from api.recording.mcap_export import export_mcap
from service.recorded_pieces import offset_of, pieces_of
from service.storage.sqlite.recorded_log import RecordedLog
from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import boot_of, held_on_its_way, store

VERSION = boot_of(1).version


class Message(NamedTuple):
    topic: str
    kind: str
    schema: dict[str, Any]
    log_ns: int
    content: dict[str, Any]


@pytest.fixture(scope="module")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="module")
def folder(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(20,))
    return folder


@pytest.fixture(scope="module")
def messages(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Message]:
    """Return what a whole export holds."""
    path = tmp_path_factory.mktemp("export") / "run.mcap"
    return exported(folder, path)


def exported(folder: Path, path: Path, first_event: int | None = None) -> list[Message]:
    pieces = pieces_of(RecordedLog(folder), VERSION, first_event, None)
    count = export_mcap(pieces, VERSION, path, first_event, lambda *_: None)
    found = read(path)
    assert count == len(found)
    return found


def read(path: Path) -> list[Message]:
    found = []
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            content = json.loads(message.data)
            found.append(
                Message(
                    channel.topic,
                    schema.name,
                    json.loads(schema.data),
                    message.log_time,
                    content,
                )
            )
    return found


def of(messages: list[Message], topic: str) -> list[Message]:
    return [message for message in messages if message.topic == topic]


def test_every_message_fits_the_schema_of_its_channel(messages: list[Message]) -> None:
    validators: dict[str, Any] = {}
    for message in messages:
        kind = message.kind
        validators.setdefault(kind, jsonschema_rs.validator_for(message.schema))
        validators[kind].validate(message.content)

    assert {
        "pilothouse.SystemState",
        "pilothouse.Part",
        "pilothouse.Signal",
        "pilothouse.Task",
        "pilothouse.Vehicle",
        "pilothouse.Holds",
        "pilothouse.EmergencyStop",
        "foxglove.Log",
        "foxglove.PoseInFrame",
        "foxglove.PosesInFrame",
    } == set(validators)


def test_the_times_are_those_of_the_calendar_and_go_on(
    messages: list[Message], robot: RecordedRobot
) -> None:
    times = [message.log_ns for message in messages]
    offset = offset_of(boot_of(1))

    assert all(before <= after for before, after in pairwise(times))
    assert times[0] == robot.taken[0].at + offset
    assert 0 <= times[-1] - (robot.taken[-1].at + offset) < 50_000_000


def test_the_state_comes_20_times_a_second_and_events_are_all_there(
    messages: list[Message], robot: RecordedRobot
) -> None:
    counts = Counter(message.topic for message in messages)
    span_s = (robot.taken[-1].at - robot.taken[0].at) / 1e9

    assert counts["/events"] == len(robot.events)
    assert abs(counts["/system_state"] - span_s * 20) <= 2
    words = [message.content["message"] for message in of(messages, "/events")]
    assert words == [event.event.words for event in robot.events]


def test_each_part_and_signal_has_a_channel_that_can_be_plotted(
    messages: list[Message], robot: RecordedRobot
) -> None:
    topics = {message.topic for message in messages}

    assert {f"/parts/{part}" for part in robot.core.parts()} <= topics
    assert {f"/signals/{signal}" for signal in robot.core.signals()} <= topics
    battery = of(messages, "/signals/battery_level")
    assert isinstance(battery[-1].content["value"], float)
    estop = of(messages, "/signals/estop")[-1]
    assert estop.content["value"] in (0.0, 1.0)


def test_the_vehicle_is_drawn_on_its_path(messages: list[Message], robot: RecordedRobot) -> None:
    (path,) = of(messages, "/path")
    state = robot.core.driving.vehicle.state
    assert state is not None
    last = of(messages, "/pose")[-1].content["pose"]

    assert len(path.content["poses"]) > 1
    assert last["position"]["x"] == pytest.approx(state.pose.x_m)
    rotation = last["orientation"]
    assert rotation["z"] ** 2 + rotation["w"] ** 2 == pytest.approx(1)


def test_it_can_begin_with_an_event(
    folder: Path, robot: RecordedRobot, tmp_path: Path, messages: list[Message]
) -> None:
    first = next(event for event in robot.events if event.kind == "hold.set")
    found = exported(folder, tmp_path / "part.mcap", first.id)

    logs = of(found, "/events")
    assert len(logs) == sum(event.id >= first.id for event in robot.events)
    assert found[0].log_ns >= first.at + offset_of(boot_of(1))
    # It begins with all there is, as a stream does.
    assert {m.topic for m in found} >= {f"/parts/{part}" for part in robot.core.parts()}
    assert messages[0].log_ns < found[0].log_ns


def test_the_chunks_are_compressed(folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    messages = exported(folder, path)
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()

    assert summary is not None
    assert summary.statistics is not None
    assert {index.compression for index in summary.chunk_indexes} == {"zstd"}
    assert summary.statistics.message_count == len(messages)
    compressed = sum(index.compressed_size for index in summary.chunk_indexes)
    assert 3 * compressed < sum(index.uncompressed_size for index in summary.chunk_indexes)


@pytest.mark.parametrize("failure", [KeyboardInterrupt, OSError])
def test_what_is_interrupted_leaves_nothing(
    folder: Path, tmp_path: Path, failure: type[BaseException]
) -> None:
    ticks = 0

    def tell(at_ns: int, count: int) -> None:
        nonlocal ticks
        ticks += 1
        if ticks == 10:
            raise failure

    pieces = pieces_of(RecordedLog(folder), VERSION, None, None)
    with pytest.raises(failure):
        export_mcap(pieces, VERSION, tmp_path / "run.mcap", None, tell)

    assert list(tmp_path.iterdir()) == []
