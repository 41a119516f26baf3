"""Only the service is restarted: what was true of the robot before is no error after it."""

import pytest

from domain.actor import Actor
from domain.inputs import AcknowledgeRequest, NodeReport
from domain.kept import KeptUnacknowledged
from domain.lifecycle import LifecycleState
from domain.simulation.node_settings import Fault
from domain.snapshot import ErrorKey, ErrorState, ErrorView
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.good import GOOD
from tests.support.models import ACTUATION, ARM, BASE, actuation_model, nested_model
from tests.support.restarting_robot import RestartingRobot

S = ErrorState
DEVIATES, LOST = "DEVIATES", "UNREACHABLE"


class Robot(RestartingRobot):
    """A robot in its mode, of which the nodes are heard late after a restart of the service."""

    def __init__(self, *, nested: bool = False) -> None:
        super().__init__(nested_model() if nested else actuation_model())
        self.read(**GOOD)
        self.ask_mode(*(("robot", "RACE") if nested else (ACTUATION, "PERFORMANCE")))
        self.advance(10)

    def restart_unheard(self) -> None:
        """Restart the service; nothing is heard of the nodes, which go on."""
        self.restart()
        for node in self.model.nodes:
            self.nodes.set_fault(node, Fault.SILENT, self.now)
        self.advance(0)

    def hear(self, *nodes: str) -> None:
        """Let these nodes be heard, each with a complete report; without names, all are."""
        for node in nodes or self.model.nodes:
            self.fault(node, None)

    def error(self, part: str, error: str = DEVIATES) -> ErrorView:
        return self.core.error(ErrorKey(PartName(part), error))

    def open(self) -> dict[str, str]:
        """Return the state of each open error of a part."""
        views = self.core.open_errors().items()
        return {name: str(view.state) for name, view in views if "." in name}

    def told(self) -> list[tuple[str, str]]:
        """Return kind and error of all of parts that was told since the restart."""
        return [
            (event.kind.partition(".")[2], f"{event.data['part']}.{event.data['error']}")
            for event in self.events
            if event.kind.startswith("error.") and event.data["part"]
        ]

    def to_see(self) -> list[str]:
        """Return the errors of parts that are kept until somebody acknowledges them."""
        return [name for kind, name in self.kept if kind is KeptUnacknowledged and "." in name]


@pytest.mark.parametrize("nested", [False, True], ids=["one system", "nested systems"])
@pytest.mark.parametrize("after_s", [0.0, 0.5, 0.999, 1.0, 1.64, 3.0, 30.0])
def test_a_restart_leaves_no_error_however_late_the_nodes_are_heard(
    after_s: float, *, nested: bool
) -> None:
    robot = Robot(nested=nested)
    for _ in range(3):
        robot.restart_unheard()
        robot.advance(after_s)
        robot.hear()
        robot.advance(5)
        assert (robot.told(), robot.open(), robot.to_see()) == ([], {}, [])


def test_nodes_that_are_heard_one_after_the_other_leave_none_either() -> None:
    robot = Robot(nested=True)
    robot.restart_unheard()
    for node in robot.model.nodes:
        robot.advance(1.7)
        robot.hear(node)
    robot.advance(5)
    assert (robot.told(), robot.open(), robot.to_see()) == ([], {}, [])


def test_a_node_whose_state_is_known_only_after_it_is_found_is_given_a_second_for_that() -> None:
    robot = Robot()
    robot.restart_unheard()
    robot.advance(4)
    found = robot.now
    for node in (BASE, ARM):
        robot.give(NodeReport(node, reachable=True))
    assert (robot.error(ACTUATION).state, robot.error(ACTUATION).since) == (S.PENDING, found)
    robot.advance(0.9)
    robot.hear()
    robot.advance(5)
    assert (robot.told(), robot.open(), robot.to_see()) == ([], {}, [])


@pytest.mark.parametrize("nodes", [(BASE, ARM), (ARM, BASE)], ids=["base first", "arm first"])
@pytest.mark.parametrize("gap_s", [0.1, 0.5, 0.8, 1.5])
def test_whichever_node_is_found_first_its_system_waits_for_both(
    gap_s: float, nodes: tuple[PartName, PartName]
) -> None:
    robot = Robot()
    robot.restart_unheard()
    robot.advance(4)
    began = robot.now
    found = [(seconds(gap_s * number), False, node) for number, node in enumerate(nodes)]
    known = [(at + seconds(0.9), True, node) for at, _, node in found]
    for at, is_known, node in sorted(found + known):
        robot.advance((began + at - robot.now) / seconds(1))
        if is_known:
            robot.hear(node)
        else:
            robot.give(NodeReport(node, reachable=True))
    robot.advance(5)
    assert (robot.told(), robot.open(), robot.to_see()) == ([], {}, [])


def test_a_node_that_never_comes_back_is_the_root_of_all_that_deviates() -> None:
    robot = Robot()
    for _ in range(2):
        robot.restart_unheard()
        robot.advance(2)
        robot.hear(ARM)
        robot.advance(60)
        assert robot.open() == {
            "drive_base.UNREACHABLE": "active",
            "actuation.DEVIATES": "active",
            "drive_base.DEVIATES": "active",
        }
        lost = (ErrorKey(BASE, LOST),)
        assert (robot.error(BASE).roots, robot.error(ACTUATION).roots) == (lost, lost)
        assert (robot.told(), robot.to_see()) == ([], [])


def test_a_node_that_comes_back_in_another_state_deviates_a_second_later() -> None:
    robot = Robot()
    robot.restart_unheard()
    robot.advance(4)
    robot.hear(ARM)
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE, reachable=True))
    robot.advance(0.999)
    assert robot.told() == []
    robot.advance(0.001)
    deviates = robot.error(BASE)
    assert (deviates.state, deviates.since, deviates.roots) == (S.ACTIVE, robot.now, ())
    assert deviates.message == "drive_base is inactive, target active.FAST"
    assert robot.error(ACTUATION).roots == (ErrorKey(BASE, DEVIATES),)
    assert sorted(robot.told()) == [
        ("raised", "actuation.DEVIATES"),
        ("raised", "drive_base.DEVIATES"),
    ]
    assert robot.to_see() == ["drive_base.DEVIATES"]
    robot.hear(BASE)
    robot.advance(5)
    assert robot.open() == {"drive_base.DEVIATES": "returned", "actuation.DEVIATES": "returned"}


@pytest.mark.parametrize(("heard", "later"), [(BASE, ARM), (ARM, BASE)])
def test_a_system_that_deviates_also_because_of_a_node_that_was_heard_is_told(
    heard: PartName, later: PartName
) -> None:
    robot = Robot()
    robot.restart_unheard()
    robot.advance(4)
    robot.give(NodeReport(heard, state=LifecycleState.INACTIVE, reachable=True))
    robot.advance(2)
    both = {f"{heard}.DEVIATES", "actuation.DEVIATES"}
    assert sorted(robot.told()) == [("raised", name) for name in sorted(both)]
    robot.hear(later)
    robot.advance(5)
    assert robot.open() == dict.fromkeys(both, "active")
    assert len(robot.told()) == 2


def test_what_nobody_acknowledged_before_stays_to_be_seen_as_it_was() -> None:
    robot = Robot()
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.advance(2)
    since = robot.error(BASE).since
    robot.give(NodeReport(BASE, state=LifecycleState.ACTIVE))
    for after_s in (0.5, 1.64, 4):
        robot.restart_unheard()
        robot.advance(after_s)
        assert robot.to_see() == ["drive_base.DEVIATES"]
        robot.hear()
        robot.advance(5)
        kept = robot.error(BASE)
        assert (robot.open(), robot.told()) == ({"drive_base.DEVIATES": "returned"}, [])
        assert kept.message == "drive_base is inactive, target active.FAST"
        assert (kept.since, kept.roots, kept.count) == (since, (), 0)
    robot.give(AcknowledgeRequest(DEVIATES, Actor("ada"), BASE))
    assert (robot.open(), robot.to_see()) == ({}, [])


def test_who_acknowledges_it_before_the_node_is_heard_has_seen_it() -> None:
    robot = Robot()
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.advance(2)
    robot.restart_unheard()
    robot.advance(2)
    robot.give(AcknowledgeRequest(DEVIATES, Actor("ada"), BASE))
    assert robot.to_see() == []
    robot.hear()
    robot.advance(5)
    assert (robot.open(), robot.to_see()) == ({}, [])


def test_a_node_that_is_lost_once_it_was_heard_is_told_as_ever() -> None:
    robot = Robot()
    robot.restart_unheard()
    robot.advance(2)
    robot.hear()
    robot.advance(2)
    robot.fault(BASE, Fault.SILENT)
    robot.advance(8)
    assert ("raised", "drive_base.UNREACHABLE") in robot.told()
    assert ("raised", "drive_base.DEVIATES") in robot.told()
    robot.hear(BASE)
    assert robot.open()["drive_base.UNREACHABLE"] == "returned"
