"""What calls for reactions."""

from domain.inputs import Reading, Readings, TimePassed
from domain.reactions.settings import HEARD_WITHIN
from domain.simulation.node_settings import Fault
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from service.files.model_file import read_model
from tests.support.reacting_robot import ReactingRobot, flag_signals, reacting_text

LOST = 'LOST: {when: "not lidar.reachable", action: hold}'


def test_a_node_that_is_lost_calls_for_a_reaction() -> None:
    robot = ReactingRobot(LOST)
    robot.fault("lidar", Fault.SILENT)
    robot.wait(12)
    assert (robot.state("LOST"), robot.holds) == ("acting", ["reaction:LOST"])

    robot.fault("lidar", None)
    robot.wait(3)
    assert (robot.state("LOST"), robot.holds) == ("idle", [])


def test_a_condition_that_counts_while_a_node_is_not_yet_heard_of_is_judged_in_time() -> None:
    lost, soon = 'LOST: {when: "not lidar.reachable", action: hold}', "{when: a, for_s: 0.5"
    model = read_model(reacting_text(lost, f"SOON: {soon}, action: hold}}"), flag_signals()).model
    settings = SupervisionSettings(flag_signals())
    core = Supervision(model, settings, 0)
    core.handle(Readings((Reading("a", True),), "test"), 1)
    first, second = (core.reaction_of(model.parts[0], name) for name in ("LOST", "SOON"))
    assert (first.state, second.state) == ("idle", "pending")

    core.handle(TimePassed(), seconds(0.6))
    assert core.reaction_of(model.parts[0], "SOON").state == "acting"
    assert core.reaction_of(model.parts[0], "SOON").since == 1 + seconds(0.5)
    core.handle(TimePassed(), HEARD_WITHIN)
    assert core.reaction_of(model.parts[0], "LOST").state == "acting"


def test_a_condition_that_is_true_for_a_moment_begins_nothing() -> None:
    robot = ReactingRobot('LIMP: {when: "a", for_s: 1, action: mode, target: active.SLOW}')
    robot.see(0.9, a=True).see(0.9, a=False).see(0.9, a=True)

    assert robot.state("LIMP") == "pending"
    assert robot.told("LIMP") == []


def test_the_time_of_a_condition_begins_with_its_own_reading() -> None:
    robot = ReactingRobot('LIMP: {when: "a", for_s: 1, action: mode, target: active.SLOW}')
    began = robot.now
    robot.see(a=True)

    assert robot.reaction("LIMP").since == began + 1_000_000_000
