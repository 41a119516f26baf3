"""Work on posted waypoints, as the worker does it."""

import json
import pickle
from dataclasses import replace

import pytest

from api.http.body_parsing import InvalidBodyError
from api.http.task_jobs import (
    TaskOptions,
    encode_waypoints,
    preview_posted,
    read_posted_task,
    thinned,
)
from domain.vehicle import Pose
from service.files.csv_table import InvalidWaypointsError
from tests.support.approach_limits import approach_limits
from tests.support.paths import straight

LINE = b"0,0,0\n5,0,0\n10,0,0\n"
OPTIONS = TaskOptions("stanley", 2.8, 1)


def test_a_csv_takes_what_the_query_says() -> None:
    task = read_posted_task(LINE, OPTIONS)

    assert (task.controller, task.speed_mps, task.start_index) == ("stanley", 2.8, 1)
    assert task.path.length_m == 10.0


def test_json_says_all_of_it_itself() -> None:
    body = {"waypoints": [{"x_m": 0, "y_m": 0, "yaw_rad": 0}, {"x_m": 3, "y_m": 4, "yaw_rad": 0}]}
    task = read_posted_task(json.dumps(body).encode(), None)

    assert (task.controller, task.path.length_m) == ("pure_pursuit", 5.0)


def test_a_byte_order_mark_is_no_part_of_the_first_number() -> None:
    assert read_posted_task(b"\xef\xbb\xbf" + LINE, OPTIONS).path.count == 3


def test_a_task_can_be_sent_from_the_worker() -> None:
    task = pickle.loads(pickle.dumps(read_posted_task(LINE, OPTIONS)))

    assert task.path.point_at(7.5).x_m == 7.5


def test_a_file_that_is_none_is_refused_with_its_lines() -> None:
    with pytest.raises(InvalidWaypointsError):
        read_posted_task(b"no waypoints", OPTIONS)


def test_a_preview_of_an_impossible_speed_is_refused() -> None:
    fast = TaskOptions("stanley", 99.0, 0)
    with pytest.raises(InvalidBodyError, match=r"11\.2 m/s"):
        preview_posted(LINE, fast, None, approach_limits())


def test_a_preview_of_an_unknown_controller_is_refused() -> None:
    unknown = TaskOptions("carrot", 2.8, 0)
    with pytest.raises(InvalidBodyError, match="no controller 'carrot'") as caught:
        preview_posted(LINE, unknown, None, approach_limits())

    assert caught.value.code == "UNKNOWN_CONTROLLER"
    assert [fault.pointer for fault in caught.value.faults] == ["/controller"]


def test_a_preview_tells_how_the_file_was_read() -> None:
    text = b"# s_m; x_m; y_m; yaw_deg\n0;0;0;90\n1;0;1;90\n2;0;2;90\n"
    shown = json.loads(preview_posted(text, OPTIONS, None, approach_limits()))["csv"]

    assert (shown["separator"], shown["decimal"], shown["header_line"]) == ("semicolon", "point", 1)
    assert (shown["heading"], shown["headings_from"]) == ("deg", "column")
    assert shown["columns"][0] == {
        "name": "s_m",
        "meaning": "distance",
        "used": False,
        "unit": "m",
    }
    assert shown["columns"][3]["unit"] == "deg"
    assert "degrees counter-clockwise" in shown["message"]


def test_a_preview_shows_what_a_task_would_be_refused_for() -> None:
    text = b"0,0,2\n0,1,2\n0,2,2\n1,3,2\n2,3,2\n3,3,2\n4,2,2\n4,1,2\n"
    shown = json.loads(preview_posted(text, OPTIONS, None, approach_limits()))

    assert shown["waypoint_count"] == 8
    assert shown["warnings"][0]["code"] == "HEADINGS_MISFIT"
    assert "?columns=x,y" in shown["warnings"][0]["hint"]
    with pytest.raises(InvalidWaypointsError, match="third column"):
        read_posted_task(text, OPTIONS)


def test_a_preview_of_json_has_no_columns() -> None:
    body = json.dumps({"waypoints": [{"x_m": x, "y_m": 0, "yaw_rad": 0} for x in (0, 3)]})
    shown = json.loads(preview_posted(body.encode(), None, None, approach_limits()))

    assert shown["csv"] is None


def test_a_preview_knows_how_far_the_vehicle_is() -> None:
    pose, options = Pose(0.0, 2.5, 0.0), replace(OPTIONS, start_index=0)
    shown = json.loads(preview_posted(LINE, options, pose, approach_limits()))

    assert shown["start"]["distance_m"] == 2.5
    assert shown["approach"]["distance_m"] == pytest.approx(2.5)
    assert shown["approach"]["turn_rad"] == 0.0
    # It drives onto the path at 1 m/s, and then the rest of it.
    assert shown["approach"]["speed_mps"] == pytest.approx(1.0)
    assert shown["approach"]["length_m"] <= shown["duration_s"] < 10 / 2.8 + 2.8 + 10


def test_thinned_points_keep_the_first_and_the_last() -> None:
    assert thinned(1_001, 3).tolist() == [0, 500, 1000]
    assert thinned(3, 10).tolist() == [0, 1, 2]
    assert thinned(5, None).tolist() == [0, 1, 2, 3, 4]


def test_waypoints_are_encoded_with_their_indices() -> None:
    shown = json.loads(encode_waypoints(straight().waypoints, 2))

    assert (shown["waypoint_count"], shown["indices"]) == (21, [0, 20])
    assert shown["items"][1] == {"x_m": 20.0, "y_m": 0.0, "yaw_rad": 0.0}
