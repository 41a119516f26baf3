"""Checkpoints of nodes, as an operator sees what is wrong with them."""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from domain.errors import NotReportedError, UnknownCheckpointError, UnknownPartError
from domain.health.checkpoints import AliveLimits, CheckpointSettings
from domain.inputs import CheckpointReport, ErrorReport, ServiceStall
from domain.parts.declared_errors import DeclaredError
from domain.simulation.node_settings import Fault
from domain.snapshot import ErrorKey, ErrorView, Severity
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from service.checkpoint import checkpoint_of, core_of_checkpoint
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ARM, BASE, actuation_model

FEW, ORDER = "CHECKPOINT_TOO_FEW", "CHECKPOINT_WRONG_ORDER"
SETTINGS = CheckpointSettings(
    alive=(AliveLimits("cycle", seconds(1), at_least=5, at_most=20),),
    order={"sense": ("act",), "act": ("sense",)},
)
NOTHING_DECLARED: Mapping[str, DeclaredError] = {}


class Robot(CoreRobot):
    """A robot whose drive base has checkpoints."""

    def __init__(self, errors: Mapping[str, DeclaredError] = NOTHING_DECLARED) -> None:
        model = replace(actuation_model(), errors={BASE: errors})
        super().__init__(model, SupervisionSettings(checkpoints={BASE: SETTINGS}))

    def reach(self, *names: str) -> None:
        for name in names:
            self.give(CheckpointReport(BASE, name))

    def work(self, duration_s: float, every_s: float = 0.1) -> None:
        """Let the program of the drive base go round."""
        for _ in range(round(duration_s / every_s)):
            self.reach("cycle")
            self.advance(every_s)

    def activate(self) -> None:
        self.ask_transition(BASE, "activate")
        self.advance(0.6)

    def error(self, name: str) -> ErrorView:
        return self.core.error(ErrorKey(BASE, name))

    @property
    def on(self) -> list[str]:
        return [view.key.error for view in self.core.errors_of(BASE) if view.state.is_on]


@pytest.fixture
def robot() -> Robot:
    """Return a robot whose drive base is active, and works."""
    robot = Robot()
    robot.activate()
    robot.work(1)
    return robot


def test_a_node_that_works_has_no_error(robot: Robot) -> None:
    robot.work(5)

    assert robot.on == []
    assert robot.happened("checkpoint.reached") == []


def test_a_node_that_hangs_has_an_error_with_its_reason(robot: Robot) -> None:
    robot.advance(1)

    found = robot.error(FEW)
    assert robot.on == [FEW]
    assert (
        found.message == "cycle was reached 4 times in 1 s, and should have been at least 5 times"
    )
    assert (found.value, found.threshold) == (4, 5)
    assert [event["part"] for event in robot.happened("error.raised")] == [BASE]


def test_the_error_clears_when_the_node_works_again(robot: Robot) -> None:
    robot.advance(2)

    robot.work(2)

    assert robot.on == []
    assert [event["error"] for event in robot.happened("error.cleared")] == [FEW]


def test_what_is_reached_in_the_wrong_order_is_the_cause_of_the_error(robot: Robot) -> None:
    robot.reach("sense", "sense")

    (raised,) = (event for event in robot.events if event.kind == "error.raised")
    cause = next(event for event in robot.events if event.id == raised.cause)
    assert cause.kind == "checkpoint.reached"
    assert cause.data == {"node": BASE, "checkpoint": "sense"}


def test_a_node_that_is_not_active_is_not_supervised() -> None:
    robot = Robot()

    robot.reach("sense", "sense")
    robot.advance(10)

    assert robot.on == []


def test_errors_clear_when_the_node_is_deactivated(robot: Robot) -> None:
    robot.advance(2)
    assert robot.on == [FEW]

    robot.ask_transition(BASE, "deactivate")
    robot.advance(1)

    assert robot.on == []


def test_a_node_that_dies_has_the_error_that_it_is_unreachable(robot: Robot) -> None:
    robot.work(1)
    robot.fault(BASE, Fault.DIE)
    robot.work(1.2)  # It is another process that still reports.
    robot.advance(10)

    assert "UNREACHABLE" in robot.on
    assert FEW not in robot.on


def test_nodes_without_checkpoints_have_none_of_these_errors(robot: Robot) -> None:
    assert ORDER in [view.key.error for view in robot.core.errors_of(BASE)]
    assert ORDER not in [view.key.error for view in robot.core.errors_of(ARM)]


def test_the_model_file_says_how_bad_it_is() -> None:
    robot = Robot({FEW: DeclaredError(severity=Severity.CRITICAL, hint="restart the planner")})
    robot.read(**GOOD)
    robot.activate()

    robot.advance(1.5)

    assert robot.error(FEW).hint == "restart the planner"
    assert f"{BASE}.{FEW}" in robot.core.system_state().errors


def test_nobody_but_the_node_itself_reports_them(robot: Robot) -> None:
    with pytest.raises(NotReportedError):
        robot.give(ErrorReport(BASE, FEW, active=True))


@pytest.mark.parametrize("node", [BASE, ARM])
def test_a_checkpoint_that_nobody_declared_is_rejected(robot: Robot, node: PartName) -> None:
    with pytest.raises(UnknownCheckpointError):
        robot.give(CheckpointReport(node, "no_such"))


def test_a_system_has_no_checkpoints(robot: Robot) -> None:
    with pytest.raises(UnknownPartError):
        robot.give(CheckpointReport(PartName("actuation"), "cycle"))


def test_a_service_that_hung_raises_nothing_for_what_it_did_not_hear(robot: Robot) -> None:
    late = robot.now + seconds(3)

    for _ in range(30):
        robot.onboard.take_in(CheckpointReport(BASE, "cycle"), late)
    robot.now = late
    robot.give(ServiceStall(seconds(3)))
    robot.work(2)

    assert robot.happened("error.raised") == []


def test_a_core_goes_on_from_a_checkpoint_of_its_state(robot: Robot) -> None:
    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1"), "1")
    later = robot.now + seconds(5)

    outputs = [core.handle(ServiceStall(1), later) for core in (robot.onboard, copy)]

    assert outputs[0] == outputs[1]
    raised = [event.data["error"] for event in outputs[0].events if event.kind == "error.raised"]
    assert FEW in raised
