"""A simulated robot is found where it was, as a real one that outlives its supervisor."""

import json
from math import pi

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from domain.commands import AskParameters, AskTransition, Drive, NodeCommand
from domain.inputs import NodeReport, VehicleReport
from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import NodeModel, SmhModel
from domain.simulation.memory import Memory, NodeMemory, plain_vehicle, read_memory, rest_of
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.state_and_mode import DEFAULT_MODE, PartName
from domain.timebase import seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits, VehicleState
from tests.support.big_model import big_model
from tests.support.models import ARM, BASE, actuation_model

S, T = LifecycleState, Transition
MODEL = actuation_model()
LISTS = SmhModel({BASE: NodeModel(BASE, {DEFAULT_MODE: {"gains": (0.5, 1.0), "on": True}})}, {})
EMPTY = SmhModel({}, {})
VEHICLE = {"x_m": 1.0, "y_m": -2.0, "yaw_rad": 0.5, "steering_angle_rad": 0.1}


def memory_of(robot: SimulatedRobot) -> dict[str, object]:
    """Return what is kept of a robot."""
    return {"nodes": robot.nodes.memory(), "vehicle": plain_vehicle(robot.vehicle.state)}


def revision_of(robot: SimulatedRobot) -> object:
    """Return what differs when the memory does."""
    state = robot.vehicle.state
    return robot.nodes.revision, state.pose, state.steering_angle_rad


def restarted(robot: SimulatedRobot, model: SmhModel = MODEL) -> SimulatedRobot:
    """Return the robot of the next run, which starts at 100 s."""
    return SimulatedRobot(model, seconds(100), memory=json.loads(json.dumps(memory_of(robot))))


def reports(robot: SimulatedRobot) -> dict[PartName, NodeReport]:
    """Return what the nodes say at first."""
    said = [m for m in robot.advance(seconds(100)) if isinstance(m, NodeReport)]
    assert len(said) == len({report.node for report in said}), "each says once what it is in"
    return {report.node: report for report in said}


def do(robot: SimulatedRobot, node: PartName, *transitions: Transition, at_s: float = 0) -> None:
    """Let a node execute transitions, the last of which may not have ended."""
    for number, transition in enumerate(transitions):
        robot.handle(AskTransition(1, node, transition), seconds(at_s + number))


# --- nodes ---------------------------------------------------------------------------------------


def test_nodes_are_in_the_state_and_have_the_parameters_that_they_had() -> None:
    robot = SimulatedRobot(MODEL, 0)
    do(robot, BASE, T.CONFIGURE, T.ACTIVATE)
    robot.handle(AskParameters(1, BASE, {"max_speed": 0.7}), seconds(2))
    robot.advance(seconds(5))

    said = reports(restarted(robot))
    assert (said[BASE].state, said[ARM].state) == (S.ACTIVE, S.UNCONFIGURED)
    assert said[BASE].parameters == {"max_speed": 0.7, "controller": "none"}
    assert said[BASE].reachable is True


@pytest.mark.parametrize(
    ("before", "interrupted", "found"),
    [
        ((), T.CONFIGURE, S.INACTIVE),
        ((T.CONFIGURE,), T.ACTIVATE, S.INACTIVE),
        ((T.CONFIGURE, T.ACTIVATE), T.DEACTIVATE, S.INACTIVE),
        ((T.CONFIGURE,), T.CLEANUP, S.UNCONFIGURED),
        ((), T.SHUTDOWN, S.FINALIZED),
    ],
)
def test_a_transition_ends_where_it_was_going_but_nothing_becomes_active_unwatched(
    before: tuple[Transition, ...], interrupted: Transition, found: LifecycleState
) -> None:
    robot = SimulatedRobot(MODEL, 0)
    do(robot, BASE, *before, interrupted)

    assert reports(restarted(robot))[BASE].state is found


@pytest.mark.parametrize("state", LifecycleState)
def test_a_node_is_found_at_rest_from_wherever_it_was(state: LifecycleState) -> None:
    assert rest_of(state).is_primary or state is S.UNKNOWN
    assert rest_of(state) is not S.ACTIVE or state is S.ACTIVE


def test_a_list_of_values_is_a_list_again() -> None:
    robot = SimulatedRobot(LISTS, 0)
    robot.nodes.set_parameters(BASE, {"gains": (2.0, 3.0)}, 0)

    said = reports(restarted(robot, LISTS))
    assert said[BASE].parameters == {"gains": (2.0, 3.0), "on": False}


def test_a_plain_node_keeps_its_parameters() -> None:
    plain = {BASE: NodeSettings(plain=True)}
    robot = SimulatedRobot(MODEL, 0, plain)
    robot.nodes.set_parameters(BASE, {"max_speed": 0.7}, 0)
    again = SimulatedRobot(MODEL, seconds(100), plain, memory=memory_of(robot))

    said = reports(again)[BASE]
    assert (said.state, said.has_lifecycle) == (None, False)
    assert said.parameters == {"max_speed": 0.7, "controller": "none"}


def test_a_node_that_was_plain_and_has_a_lifecycle_now_begins_unconfigured() -> None:
    robot = SimulatedRobot(MODEL, 0, {BASE: NodeSettings(plain=True)})

    assert reports(restarted(robot))[BASE].state is S.UNCONFIGURED


def test_a_node_that_is_dead_from_the_start_is_not_brought_to_life() -> None:
    dead = {BASE: NodeSettings(fault=Fault.DIE)}
    robot = SimulatedRobot(MODEL, 0, dead)
    assert [alike["nodes"] for alike in robot.nodes.memory()] == [[ARM]]

    again = SimulatedRobot(MODEL, seconds(100), dead, memory=memory_of(SimulatedRobot(MODEL, 0)))
    assert set(reports(again)) == {ARM}


def test_nodes_that_the_model_no_longer_has_are_ignored() -> None:
    robot = SimulatedRobot(MODEL, 0)
    do(robot, BASE, T.CONFIGURE)
    robot.advance(seconds(1))
    again = restarted(robot, SmhModel({BASE: MODEL.nodes[BASE]}, {}))

    assert again.left_out == ()
    assert {node: report.state for node, report in reports(again).items()} == {BASE: S.INACTIVE}


def test_nodes_that_are_in_the_same_are_remembered_together() -> None:
    robot = SimulatedRobot(big_model(100), 0)
    assert len(robot.nodes.memory()) == 1

    do(robot, PartName("node_7"), T.SHUTDOWN)
    robot.advance(seconds(1))
    told = [(alike["state"], alike["nodes"]) for alike in robot.nodes.memory()]
    others = [f"node_{number}" for number in range(100) if number != 7]
    assert told == [("unconfigured", others), ("finalized", ["node_7"])]


def test_values_that_are_equal_but_of_different_types_are_not_the_same() -> None:
    whole, part = PartName("whole"), PartName("part")
    model = SmhModel(
        {
            whole: NodeModel(whole, {DEFAULT_MODE: {"rate": 1}}),
            part: NodeModel(part, {DEFAULT_MODE: {"rate": 1.0}}),
        },
        {},
    )
    said = reports(restarted(SimulatedRobot(model, 0), model))

    assert {name: repr(report.parameters) for name, report in said.items()} == {
        whole: "mappingproxy({'rate': 0})",
        part: "mappingproxy({'rate': 0.0})",
    }


# --- vehicle -------------------------------------------------------------------------------------


def test_the_vehicle_stands_where_it_was() -> None:
    robot = SimulatedRobot(MODEL, 0)
    for tick in range(40):
        robot.handle(Drive(DriveCommand(2.0, 0.2)), seconds(tick * 0.05))
        robot.advance(seconds(tick * 0.05))
    was = robot.vehicle.state
    again = restarted(robot)
    said = [m for m in again.advance(seconds(110)) if isinstance(m, VehicleReport)]

    assert was.speed_mps == 2.0
    assert {report.state for report in said} == {VehicleState(was.pose, 0.0, 0.2)}


def test_the_vehicle_is_within_its_limits_also_if_they_were_wider() -> None:
    narrow = VehicleSettings(limits=VehicleLimits(max_steering_angle_rad=0.05))
    robot = SimulatedRobot(MODEL, 0, vehicle=narrow, memory={"vehicle": VEHICLE})

    assert robot.vehicle.state == VehicleState(Pose(1.0, -2.0, 0.5), 0.0, 0.05)


def test_without_a_memory_it_begins_where_the_settings_say() -> None:
    pose = Pose(3.0, 4.0, 1.0)
    robot = SimulatedRobot(MODEL, 0, vehicle=VehicleSettings(pose))

    assert (robot.vehicle.state, robot.left_out) == (VehicleState(pose, 0.0, 0.0), ())


# --- what changed --------------------------------------------------------------------------------


def test_a_robot_at_rest_has_nothing_new_to_remember() -> None:
    robot = SimulatedRobot(MODEL, 0, vehicle=VehicleSettings(plant=Plant(steering_lag_s=0.2)))
    revision = revision_of(robot)
    robot.advance(seconds(60))

    assert revision_of(robot) == revision


@pytest.mark.parametrize(
    "command",
    [AskTransition(1, BASE, T.CONFIGURE), AskParameters(1, BASE, {"max_speed": 0.3})],
)
def test_a_node_that_changes_is_something_new(command: NodeCommand) -> None:
    robot = SimulatedRobot(MODEL, 0)
    revision, memory = revision_of(robot), memory_of(robot)
    robot.handle(command, 0)
    robot.advance(seconds(1))

    assert memory_of(robot) != memory
    assert revision_of(robot) != revision


def test_a_vehicle_that_drives_is_something_new() -> None:
    robot = SimulatedRobot(MODEL, 0)
    revision = revision_of(robot)
    robot.handle(Drive(DriveCommand(1.0, 0.0)), 0)
    robot.advance(seconds(0.1))

    assert revision_of(robot) != revision


# --- nonsense ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("memory", "reason"),
    [
        ("x", "the memory of the simulated robot is not a mapping"),
        ({"nodes": {}}, "the memory of the simulated nodes is not a list"),
        ({"nodes": [3]}, "the memory of some simulated nodes: it is not a mapping"),
        (
            {"nodes": [{"state": "active", "nodes": 3, "parameters": {}}]},
            "the memory of some simulated nodes: its nodes are not a list",
        ),
        (
            {"nodes": [{"state": "flying", "nodes": [BASE], "parameters": {}}]},
            "the memory of some simulated nodes: 'flying' is not a state to rest in",
        ),
        (
            {"nodes": [{"state": "activating", "nodes": [BASE], "parameters": {}}]},
            "the memory of some simulated nodes: 'activating' is not a state to rest in",
        ),
        (
            {"nodes": [{"state": "active", "nodes": [BASE], "parameters": 1}]},
            "the memory of some simulated nodes: its parameters are not a mapping",
        ),
        (
            {"nodes": [{"state": "active", "nodes": [BASE], "parameters": {"max_speed": 1}}]},
            "the memory of the simulated node drive_base: max_speed is of type double, not integer",
        ),
        (
            {"vehicle": {**VEHICLE, "x_m": float("nan")}},
            "the memory of the simulated vehicle is not a pose that it can have",
        ),
        (
            {"vehicle": {**VEHICLE, "yaw_rad": 2 * pi}},
            "the memory of the simulated vehicle is not a pose that it can have",
        ),
        ({"vehicle": 5}, "the memory of the simulated vehicle is not a pose that it can have"),
    ],
)
def test_nonsense_is_left_out_with_a_reason(memory: object, reason: str) -> None:
    robot = SimulatedRobot(MODEL, 0, memory=memory)

    assert robot.left_out == (reason,)
    assert memory_of(robot) == memory_of(SimulatedRobot(MODEL, 0))


def test_of_very_much_nonsense_some_is_told() -> None:
    left_out = read_memory({"nodes": [1] * 30}, EMPTY).left_out

    assert (len(left_out), left_out[-1]) == (21, "and 10 more")


def test_one_node_that_is_nonsense_keeps_no_other_from_being_remembered() -> None:
    alike = {"state": "inactive", "parameters": {"max_speed": 1}, "nodes": [BASE, ARM]}
    memory = {"nodes": [3, alike], "vehicle": VEHICLE}
    read = read_memory(memory, MODEL)

    assert read.nodes == {ARM: NodeMemory(S.INACTIVE)}
    assert read.vehicle == VehicleState(Pose(1.0, -2.0, 0.5), 0.0, 0.1)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inside: (
        st.lists(inside, max_size=3)
        | st.dictionaries(
            st.sampled_from(
                ["nodes", "vehicle", BASE, "state", "parameters", "max_speed", *VEHICLE]
            ),
            inside,
            max_size=6,
        )
    ),
)


@settings(max_examples=500)
@given(JSON)
def test_whatever_is_remembered_a_robot_starts(memory: object) -> None:
    robot = SimulatedRobot(MODEL, 0, memory=memory)
    assert len(robot.advance(0)) == 3
    assert isinstance(read_memory(memory, MODEL), Memory)


COMMANDS = st.one_of(
    st.builds(AskTransition, st.just(1), st.sampled_from([BASE, ARM]), st.sampled_from(Transition)),
    st.builds(lambda speed: AskParameters(1, BASE, {"max_speed": speed}), st.floats(0, 1)),
    st.builds(lambda v, a: Drive(DriveCommand(v, a)), st.floats(-3, 12), st.floats(-1, 1)),
)


@settings(max_examples=200)
@given(st.lists(st.tuples(st.integers(0, seconds(0.4)), COMMANDS), max_size=20))
def test_whatever_it_did_it_is_found_there_and_stays_there(
    story: list[tuple[int, NodeCommand | Drive]],
) -> None:
    robot, now = SimulatedRobot(MODEL, 0), seconds(0)
    revision, memory = revision_of(robot), memory_of(robot)
    for after, command in story:
        now += after
        robot.handle(command, now)
        robot.advance(now)
        assert revision_of(robot) != revision or memory_of(robot) == memory
        revision, memory = revision_of(robot), memory_of(robot)
    again = restarted(robot)

    assert again.left_out == ()
    assert memory_of(again) == memory
    again.advance(seconds(200))
    assert memory_of(again) == memory
