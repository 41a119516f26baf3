import pytest

from service.ros.interface.interface import RosInterface
from service.ros.interface.message_sets import MessageSet, own_type, type_in
from service.ros.interface.settings import InterfaceSettings
from tests.support.live_robot import make_supervisor


@pytest.mark.parametrize(
    ("topic", "type_name"),
    [
        ("/battery_level", "gem_state_msgs/msg/BatteryLevelStamped"),
        ("/estop", "gem_state_msgs/msg/EstopStamped"),
        ("/gps_accuracy", "gem_state_msgs/msg/GpsAccuracyStamped"),
        ("/signal_strength", "gem_state_msgs/msg/SignalStrengthStamped"),
        ("/temperature", "gem_state_msgs/msg/TemperatureStamped"),
        ("/system_state", "gem_state_msgs/msg/SystemStateStamped"),
        ("/task_planner_status", "gem_state_msgs/msg/TaskPlannerStatus"),
    ],
)
def test_a_robot_may_name_its_messages_as_smart_polaris_does(topic: str, type_name: str) -> None:
    interface = RosInterface(make_supervisor(), InterfaceSettings(MessageSet.GEM))

    types = {name: offered.type for name, offered in interface.topics.items()}
    types |= {name: heard.type for name, heard in interface.heard.items()}
    assert types[topic] == type_name


def test_each_message_of_smart_polaris_has_one_of_our_own() -> None:
    given = type_in(MessageSet.GEM, "EmergencyStop")

    assert given == "gem_state_msgs/msg/EstopStamped"
    assert own_type(given) == "pilothouse_msgs/msg/EmergencyStop"


def test_other_types_have_no_second_name() -> None:
    assert own_type("std_msgs/msg/String") == "std_msgs/msg/String"
