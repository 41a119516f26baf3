import math

import jsonschema_rs
import pytest

from api.recording import foxglove
from domain.vehicle import Pose

AT_NS = 1_767_225_600_250_000_001


@pytest.mark.parametrize("yaw_rad", [0.0, 1.0, -math.pi, 3.0])
def test_a_pose_is_turned_about_the_upright_axis(yaw_rad: float) -> None:
    message = foxglove.pose_message(AT_NS, Pose(1.5, -2.0, yaw_rad))

    turned = message["pose"]["orientation"]
    assert 2 * math.atan2(turned["z"], turned["w"]) == pytest.approx(yaw_rad)
    assert message["pose"]["position"] == {"x": 1.5, "y": -2.0, "z": 0.0}
    assert message["timestamp"] == {"sec": 1_767_225_600, "nsec": 250_000_001}
    assert jsonschema_rs.is_valid(foxglove.POSE_SCHEMA, message)


def test_a_path_and_a_log_fit_their_schemas() -> None:
    path = foxglove.path_message(AT_NS, [(0.0, 0.0, 0.0), (1.0, 0.5, 0.1)])
    log = foxglove.log_message(AT_NS, foxglove.INFO, "hold.set", "hold gate set: closed")

    assert jsonschema_rs.is_valid(foxglove.PATH_SCHEMA, path)
    assert jsonschema_rs.is_valid(foxglove.LOG_SCHEMA, log)
    assert (log["name"], log["message"]) == ("hold.set", "hold gate set: closed")
