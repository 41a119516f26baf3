from domain.changes.plan import NodeGoal
from domain.changes.record import Change, NodeBefore
from domain.changes.rollback import goals_before
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest
from domain.lifecycle import LifecycleState
from domain.state_and_mode import PartName
from tests.support.models import ACTUATION, ARM, BASE, FAST, SLOW


def test_nodes_that_were_asked_for_something_go_back_and_no_other() -> None:
    goals = {BASE: NodeGoal(LifecycleState.ACTIVE), ARM: NodeGoal(LifecycleState.ACTIVE)}
    change = Change(ChangeId("c1"), ACTUATION, ModeRequest(ACTUATION, FAST), {}, 0, 1)
    change.set_out(goals)
    change.pursue(ARM)
    was = NodeBefore(LifecycleState.ACTIVE, SLOW, {"max_speed": 0.2})
    change.pursue(BASE).before = was

    assert goals_before(change) == {BASE: NodeGoal(LifecycleState.ACTIVE, SLOW, was.parameters)}


def test_a_node_that_was_on_its_way_goes_to_where_that_led() -> None:
    lidar = PartName("lidar")
    change = Change(ChangeId("c1"), lidar, ModeRequest(lidar, FAST), {}, 0, 1)
    change.set_out({lidar: NodeGoal(None)})
    change.pursue(lidar).before = NodeBefore(LifecycleState.ACTIVATING, None, {})

    assert goals_before(change) == {lidar: NodeGoal(LifecycleState.ACTIVE)}
