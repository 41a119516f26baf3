"""Messages of ROS itself, filled and read, and sent in between."""

from typing import Any

import pytest

from service.ros.graph.conversion import fields_of, find_type
from service.ros.graph.graph import Lane, Qos
from tests.ros2.support.links import POLL_S, Link
from tests.support.waiting import until

pytestmark = pytest.mark.ros2


@pytest.mark.parametrize(
    ("type_name", "fields"),
    [
        (
            "lifecycle_msgs/msg/TransitionEvent",
            {"timestamp": 2**63, "goal_state": {"id": 3, "label": "active"}},
        ),
        (
            "diagnostic_msgs/msg/DiagnosticArray",
            {
                "header": {"stamp": {"sec": 1, "nanosec": 2}},
                "status": [
                    {"level": 2, "name": "arm", "values": [{"key": "reason", "value": "späte"}]}
                ],
            },
        ),
        (
            "sensor_msgs/msg/NavSatFix",
            {"latitude": 48, "position_covariance": [0.5] * 9, "status": {"status": -1}},
        ),
        ("nav_msgs/msg/Odometry", {"pose": {"pose": {"orientation": {"w": 0.5}}}}),
        ("rcl_interfaces/msg/ParameterValue", {"byte_array_value": [0, 255], "type": 5}),
        ("sensor_msgs/msg/Temperature", {"temperature": float("inf")}),
    ],
)
async def test_a_real_message_crosses_the_graph_as_it_was(
    link: Link, type_name: str, fields: dict[str, Any]
) -> None:
    heard: list[dict[str, Any]] = []
    link.node("hearing", Lane.SENSORS).subscribe(
        "/thing", type_name, Qos.EVENTS, fields_of, heard.append
    )
    publisher = link.node("saying", Lane.GATEWAY).publisher("/thing", type_name, Qos.EVENTS)

    async def said_and_heard() -> bool:
        publisher.publish(fields)
        return bool(heard)

    await until(said_and_heard, POLL_S)

    assert holds(heard[0], fields)
    assert set(heard[0]) == set(find_type(type_name).get_fields_and_field_types())


def holds(found: Any, given: Any) -> bool:  # noqa: ANN401  # values of fields
    """Tell whether all that was given was found, whatever else was."""
    match given:
        case dict():
            return all(holds(found[name], value) for name, value in given.items())
        case list():
            return len(found) == len(given) and all(map(holds, found, given))
    return bool(found == given)
