"""The file for RViz shows what is published."""

from typing import Any

import yaml

from domain.vehicle import DEFAULT_FRAME
from service.ros.interface.interface import RosInterface
from tests.support.live_robot import make_supervisor
from tests.support.shared import PROJECT

RVIZ = PROJECT / "examples" / "ros2" / "pilothouse.rviz"
TYPES = {
    "rviz_default_plugins/MarkerArray": "visualization_msgs/msg/MarkerArray",
    "rviz_default_plugins/Path": "nav_msgs/msg/Path",
}


def manager() -> Any:  # noqa: ANN401  # as in YAML
    """Return what the file says of displays and frames."""
    return yaml.safe_load(RVIZ.read_text())["Visualization Manager"]


def test_each_topic_that_is_drawn_is_offered_with_this_type_and_durability() -> None:
    topics = RosInterface(make_supervisor()).topics
    drawn = [each for each in manager()["Displays"] if "Topic" in each]

    assert len(drawn) == len(TYPES)
    for display in drawn:
        topic = topics[display["Topic"]["Value"]]
        is_latched = display["Topic"]["Durability Policy"] == "Transient Local"
        assert (topic.type, topic.latched) == (TYPES[display["Class"]], is_latched)


def test_the_fixed_frame_is_the_one_of_a_robot_file_without_a_frame() -> None:
    assert manager()["Global Options"]["Fixed Frame"] == DEFAULT_FRAME
