from service.files.robot_file import RobotSettings, read_robot_file
from service.sources.from_settings import make_sources
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model

ALL = """
signals:
  estop: {source: {gpio: {line: 17, active_low: true}}}
  cpu: {source: {os: {what: cpu_percent}}}
  disk: {source: {os: {what: disk_percent}}}
  heat: {source: {file: {path: /sys/class/thermal/thermal_zone0/temp, scale: 0.001}}}
  heat_raw: {source: {file: {path: /sys/class/thermal/thermal_zone0/temp}}}
  voltage: {source: {i2c: {bus: 1, address: 0x40, register: 2}}}
  current: {source: {i2c: {bus: 1, address: 0x41, register: 4}}}
  other_bus: {source: {i2c: {bus: 2, address: 0x40, register: 2}}}
  adc: {source: {spi: {bus: 0, send: [1, 0x80], skip: 1, bits: 10}}}
  camera: {source: {systemd: {unit: camera.service}}}
  mine: {source: {systemd: {unit: mine.service, manager: user}}}
  posted: {source: {http: {period_s: 1}}}
"""


def test_there_is_a_source_for_each_thing_and_none_for_what_is_posted() -> None:
    robot = read_robot_file(ALL, actuation_model())
    sources = make_sources(robot, ManualClock())

    assert sources is not None
    assert {status.name: status.signals for status in sources.status} == {
        "os": ("cpu",),
        "os disk /": ("disk",),
        "file /sys/class/thermal/thermal_zone0/temp": ("heat", "heat_raw"),
        "systemd system": ("camera",),
        "systemd user": ("mine",),
        "gpio /dev/gpiochip0": ("estop",),
        "i2c 1": ("voltage", "current"),
        "i2c 2": ("other_bus",),
        "spi 0.0": ("adc",),
    }


def test_a_robot_without_sources_has_none() -> None:
    assert make_sources(RobotSettings(), ManualClock()) is None
