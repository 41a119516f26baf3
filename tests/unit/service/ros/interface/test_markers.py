from math import pi

import pytest

from api.rosbridge.definitions import MESSAGES
from domain.vehicle import Pose
from service.ros.interface.markers import Color, Kind, Look, Size, marker, no_marker, pose

HEADER = {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "map"}
LOOK = Look(7, Kind.LINE_STRIP, Size(0.2, 0.0, 0.0), Color(1.0, 0.5, 0.0))
FIELDS = {line.partition(" ")[2] for line in MESSAGES["visualization_msgs/msg/Marker"]}


def test_a_marker_has_all_fields_of_its_type() -> None:
    constants = {name for name in FIELDS if "=" in name}

    assert {*marker(HEADER, LOOK)} == {*no_marker(HEADER, LOOK)} == FIELDS - constants


def test_a_line_has_its_points_and_is_not_moved() -> None:
    line = marker(HEADER, LOOK, points=[{"x": 1.0, "y": 2.0, "z": 0.0}])

    assert (line["id"], line["type"], line["action"]) == (7, 4, 0)
    assert line["points"] == [{"x": 1.0, "y": 2.0, "z": 0.0}]
    assert line["pose"]["position"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    assert line["pose"]["orientation"]["w"] == 1.0
    assert line["scale"]["x"] == 0.2
    assert line["color"] == {"r": 1.0, "g": 0.5, "b": 0.0, "a": 1.0}


def test_viewers_drop_a_marker_that_is_not_repeated() -> None:
    assert marker(HEADER, LOOK)["lifetime"] == {"sec": 3, "nanosec": 0}


def test_a_marker_is_removed_by_its_number() -> None:
    gone = no_marker(HEADER, LOOK)

    assert (gone["ns"], gone["id"], gone["action"]) == ("pilothouse", 7, 2)


def test_a_heading_is_a_turn_about_the_vertical_axis() -> None:
    turned = pose(Pose(3.0, 4.0, pi / 2), 0.5)

    assert turned["position"] == {"x": 3.0, "y": 4.0, "z": 0.5}
    assert turned["orientation"]["z"] == pytest.approx(turned["orientation"]["w"])


def test_a_smaller_robot_is_drawn_smaller() -> None:
    assert LOOK.scaled(0.5).size == Size(0.1, 0.0, 0.0)
    assert LOOK.scaled(0.5).number == LOOK.number
