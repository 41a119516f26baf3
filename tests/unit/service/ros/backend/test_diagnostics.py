"""Errors of parts that drivers report by diagnostics."""

from domain.inputs import ErrorReport
from domain.state_and_mode import PartName
from service.files.ros2_block import DiagnosticsBlock
from service.ros.backend.diagnostics import ReportedDiagnostics
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph

LINK, MOTOR = "lidar_driver: Connection", "lidar_driver: Motor"
OK, WARN, ERROR, STALE = range(4)


class Robot:
    """A robot that listens to diagnostics, and what it took from there."""

    def __init__(self, errors: dict[str, str]) -> None:
        self.graph = FakeGraph(ManualClock())
        self.heard: list[ErrorReport] = []
        settings = DiagnosticsBlock.model_validate({"errors": errors})
        ReportedDiagnostics(settings, self.graph).start(self.heard.append)

    def say(self, **levels: int) -> None:
        """Publish statuses, each with its level."""
        names = {"link": LINK, "motor": MOTOR, "other": "gps: Fix"}
        status = [
            {"name": names[name], "level": bytes([level]), "message": f"level {level}"}
            for name, level in levels.items()
        ]
        self.graph.publish("/diagnostics", {"status": status})

    @property
    def told(self) -> list[tuple[str, bool, str]]:
        return [(report.error, report.active, report.message) for report in self.heard]


def test_a_status_that_is_not_ok_is_the_error_of_its_part() -> None:
    robot = Robot({LINK: "left/lidar.LINK"})

    robot.say(link=ERROR)

    (report,) = robot.heard
    assert (report.part, report.error, report.active) == (PartName("left/lidar"), "LINK", True)
    assert report.message == "lidar_driver: Connection: ERROR: level 2"
    assert report.actor.label == "ros"


def test_only_a_change_of_the_level_is_told() -> None:
    robot = Robot({LINK: "lidar.LINK"})

    for level in (OK, OK, WARN, WARN, ERROR, STALE, OK, OK):
        robot.say(link=level)

    words = [
        "",
        "lidar_driver: Connection: WARN: level 1",
        "lidar_driver: Connection: ERROR: level 2",
        "lidar_driver: Connection: STALE: level 3",
        "",
    ]
    assert robot.told == [("LINK", bool(text), text) for text in words]


def test_an_error_of_several_statuses_is_on_while_one_of_them_is_not_ok() -> None:
    robot = Robot({LINK: "lidar.BAD", MOTOR: "lidar.BAD"})

    robot.say(link=WARN, motor=OK)
    robot.say(motor=ERROR)
    robot.say(motor=OK)
    robot.say(link=OK)

    assert [active for _, active, _ in robot.told] == [True, True, True, False]
    assert "Motor" in robot.told[1][2]
    assert "Connection" in robot.told[2][2]


def test_statuses_of_others_are_left_alone() -> None:
    robot = Robot({LINK: "lidar.LINK"})

    robot.say(other=ERROR)
    robot.say(other=ERROR, link=OK)

    assert robot.told == [("LINK", False, "")]


def test_a_level_that_nobody_knows_is_not_ok() -> None:
    robot = Robot({LINK: "lidar.LINK"})

    robot.say(link=200)

    assert robot.told == [("LINK", True, "lidar_driver: Connection: STALE: level 200")]


def test_a_robot_that_takes_no_diagnostics_joins_nothing() -> None:
    graph = FakeGraph(ManualClock())
    heard: list[ErrorReport] = []

    ReportedDiagnostics(None, graph).start(heard.append)

    assert graph.nodes == {}
