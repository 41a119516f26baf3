import json
import sys
from pathlib import Path

import pytest
from mcap.reader import make_reader

from api.recording.mcap_file import McapFile, NoMcapError

SCHEMA = {"type": "object", "properties": {"x": {"type": "number"}}}


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    with McapFile(path, "pilothouse 1.2") as file:
        for topic in ("/a", "/b"):
            assert not file.has(topic)
            file.add_channel(topic, "Number", SCHEMA)
        file.write("/a", 5, {"x": 1})
        file.write("/b", 6, {"x": 2})
        assert not path.exists(), "it appears when it is complete"

    with path.open("rb") as stream:
        reader = make_reader(stream)
        found = [
            (schema and schema.name, channel.topic, message.log_time, json.loads(message.data))
            for schema, channel, message in reader.iter_messages()
        ]
        summary = reader.get_summary()
    assert found == [("Number", "/a", 5, {"x": 1}), ("Number", "/b", 6, {"x": 2})]
    assert summary is not None
    assert len(summary.schemas) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_that_was_not_completed_is_not_there(tmp_path: Path) -> None:
    def interrupt() -> None:
        with McapFile(tmp_path / "run.mcap", "") as file:
            file.add_channel("/a", "Number", SCHEMA)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupt()

    assert list(tmp_path.iterdir()) == []


def test_without_mcap_nothing_is_begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mcap", None)

    with (
        pytest.raises(NoMcapError, match=r"pilothouse\[recording\]"),
        McapFile(tmp_path / "run.mcap", ""),
    ):
        pass

    assert list(tmp_path.iterdir()) == []
