"""Sources in a robot file: what is said holds, and what is wrong is told with its place."""

from typing import Any

import pytest

from domain.timebase import seconds
from service.files.robot_file import InvalidRobotFileError, read_robot_file, robot_settings_of
from service.files.source_block import SourceBlock
from tests.support.models import actuation_model


def faults(text: str) -> list[tuple[int | None, int | None, str]]:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, actuation_model())
    return [(f.line, f.column, f.message) for f in caught.value.findings]


def stale_after_s(text: str) -> dict[str, float]:
    settings = read_robot_file(text, actuation_model()).to_signal_settings()
    return {signal.spec.name: signal.stale_after / seconds(1) for signal in settings}


def test_a_signal_with_a_source_is_stale_after_three_periods() -> None:
    stale = stale_after_s(
        """
signals:
  cpu: {source: {os: {what: cpu_percent}}}
  disk: {source: {os: {what: disk_percent, path: /data}}}
  estop: {source: {gpio: {line: 17}}}
  posted: {source: {http: {period_s: 60}}}
  own: {stale_after_s: 5, source: {os: {what: load_1}}}
  never: {stale_after_s: 0, source: {os: {what: load_1}}}
"""
    )

    assert stale["cpu"] == 3
    assert stale["disk"] == 30
    assert stale["estop"] == pytest.approx(0.3)
    assert stale["posted"] == 180
    assert (stale["own"], stale["never"]) == (5, 0)
    assert stale["temperature"] == 2


def test_staleness_of_all_signals_is_also_that_of_those_with_a_source() -> None:
    text = "signals: {stale_after_s: 0, cpu: {source: {os: {what: cpu_percent}}}}"

    assert stale_after_s(text)["cpu"] == 0


@pytest.mark.parametrize(
    ("text", "column", "words"),
    [
        (
            "signals: {cpu: {source: {os: {what: cpu_percent, perid_s: 1}}}}",
            50,
            "signals.cpu.source.os.perid_s: unknown key",
        ),
        (
            "signals: {cpu: {source: {os: {what: cpu_percent}, http: {period_s: 1}}}}",
            17,
            "signals.cpu.source: a source is exactly one of os, systemd, file, gpio, i2c, spi, "
            "http",
        ),
        (
            "signals: {cpu: {source: {os: {what: load_1, process: camera}}}}",
            26,
            "signals.cpu.source.os: processes have no load_1",
        ),
        (
            "signals: {cpu: {stale_after_s: 1, source: {http: {period_s: 2}}}}",
            11,
            "signals.cpu: stale_after_s is shorter than the period of the source, 2 s",
        ),
        (
            "signals: {stale_after_s: 1, cpu: {source: {http: {period_s: 2}}}}",
            1,
            "signals: stale_after_s is shorter than the period of the source of cpu, 2 s",
        ),
        (
            "signals: {cpu: {source: {file: {path: etc/passwd}}}}",
            33,
            "signals.cpu.source.file.path: String should match pattern '^/[^\\x00]*$'",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_place(text: str, column: int, words: str) -> None:
    assert faults(text) == [(1, column, words)]


@pytest.mark.parametrize(
    ("kind", "block"),
    [
        ("os", {"what": "load_1", "cgroup": "system.slice"}),
        ("os", {"what": "cpu_percent", "cgroup": "system.slice", "process": "camera"}),
        ("os", {"what": "cpu_percent", "cgroup": "../etc"}),
        ("os", {"what": "cpu_percent", "cgroup": "a/../b"}),
        ("os", {"what": "oom_kills"}),
        ("os", {"what": "threads"}),
        ("os", {"what": "threads", "cgroup": "system.slice"}),
        ("os", {"what": "network_up"}),
        ("os", {"what": "cpu_percent", "path": "/data"}),
        ("os", {"what": "cpu_percent", "sensor": "coretemp"}),
        ("os", {"what": "disk_percent", "interface": "eth0"}),
        ("os", {"what": "cpu_percent", "period_s": 0.05}),
        ("os", {}),
        ("systemd", {"unit": "camera"}),
        ("systemd", {"unit": "../camera.service"}),
        ("file", {"path": "/sys/x", "period_s": 0.0}),
        ("file", {"path": "/sys/x", "scale": float("nan")}),
        ("gpio", {"line": -1}),
        ("gpio", {"line": True}),
        ("i2c", {"bus": 1, "address": 0x80, "register": 0}),
        ("i2c", {"bus": 1, "address": 0x40, "register": 256}),
        ("i2c", {"bus": 1, "address": 0x40, "register": 0, "size_bytes": 1, "shift": 8}),
        ("i2c", {"bus": 1, "address": 0x40, "register": 0, "shift": 8, "bits": 9}),
        ("spi", {"bus": 0, "send": []}),
        ("spi", {"bus": 0, "send": [256]}),
        ("spi", {"bus": 0, "send": [1] * 17}),
        ("http", {}),
    ],
)
def test_what_cannot_be_is_refused(kind: str, block: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=kind):
        SourceBlock.model_validate({kind: block})


def test_a_simulation_takes_the_same_settings_and_opens_nothing() -> None:
    settings = robot_settings_of(
        {"signals": {"f": {"source": {"file": {"path": "/no/such/file"}}}}}, actuation_model()
    )

    assert set(settings.signals.sources) == {"f"}


def test_a_signal_has_a_source_or_a_topic() -> None:
    text = """
signals: {load: {source: {file: {path: /sys/x}}}}
ros2: {signals: {load: {topic: /load, type: std_msgs/msg/Float32}}}
"""
    assert faults(text) == [(3, 18, "load has a source under signals; remove one of them")]
