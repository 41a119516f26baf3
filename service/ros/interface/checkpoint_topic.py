"""The topic on which the programs of nodes report the checkpoints that they pass."""

from functools import partial

from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError
from domain.inputs import CheckpointReport
from domain.state_and_mode import PartName
from service.ros.interface.endpoints import Fields, SubscribedTopic
from service.ros.interface.message_check import Kind, checked
from service.supervisor import Supervisor

TOPIC = "/pilothouse/checkpoints"


def checkpoint_topic(supervisor: Supervisor) -> SubscribedTopic:
    """Return the topic; each message is the name of a node, a blank, and that of a checkpoint."""
    take = partial(_take, supervisor)
    return SubscribedTopic(TOPIC, "std_msgs/msg/String", take, needs_all=True)


def _take(supervisor: Supervisor, fields: Fields, sender: Actor) -> None:
    """Submit a report.

    Raises:
        PilothouseError: It is rejected.
    """
    try:
        text = str(checked({"data": Kind.TEXT}, fields)["data"])
        node, _, checkpoint = text.strip().rpartition(" ")
        node = node.strip().lstrip("/")
        if not node:
            message = (
                f"a checkpoint is NODE CHECKPOINT, as in 'planner plan_done', not {text!r:.60}"
            )
            raise InvalidValueError(message, "data")
        supervisor.submit(CheckpointReport(PartName(node), checkpoint, sender))
    except PilothouseError as error:
        supervisor.refused_readings.note(sender, error.message)
        raise
