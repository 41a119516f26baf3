"""`/tasks` as an operator uses it."""

import threading
from math import pi
from typing import Any

import httpx
import pytest

from service.files.waypoint_file import read_waypoints_csv
from tests.support.http_robot import HttpRobot
from tests.support.numpy_loads import numpy_not_loaded

CSV = {"Content-Type": "text/csv"}
LINE = "".join(f"{x},0,0\n" for x in range(11))
WAYPOINTS = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(11)]
TASK_FIELDS = {
    "id",
    "status",
    "controller",
    "speed_mps",
    "waypoint_count",
    "length_m",
    "start_index",
    "target_index",
    "progress",
    "distance_m",
    "cross_track_error_m",
    "reason",
    "created_at",
    "ended_at",
}


async def post(robot: HttpRobot, csv: str = LINE, **query: str | float) -> httpx.Response:
    return await robot.http.post("/tasks", content=csv, headers=CSV, params=query)


# --- serving -------------------------------------------------------------------------------------


async def test_a_task_of_json_is_served_and_shown(robot: HttpRobot) -> None:
    answer = await robot.http.post("/tasks", json={"waypoints": WAYPOINTS})
    task = answer.json()

    assert answer.status_code == 201
    assert answer.headers["location"] == "/tasks/t1"
    assert set(task) == TASK_FIELDS
    assert (task["status"], task["controller"], task["speed_mps"]) == (
        "RUNNING",
        "pure_pursuit",
        2.8,
    )
    assert (task["waypoint_count"], task["length_m"], task["progress"]) == (11, 10.0, 0.0)


async def test_a_task_of_csv_takes_its_options_from_the_query(robot: HttpRobot) -> None:
    answer = await post(robot, controller="stanley", speed_mps=1.5, start_index=2)
    task = answer.json()

    assert answer.status_code == 201
    assert (task["controller"], task["speed_mps"], task["start_index"]) == ("stanley", 1.5, 2)


async def test_curl_needs_no_content_type_for_json(robot: HttpRobot) -> None:
    body = (
        b'{"waypoints": [{"x_m": 0, "y_m": 0, "yaw_rad": 0}, {"x_m": 5, "y_m": 0, "yaw_rad": 0}]}'
    )
    form = {"Content-Type": "application/x-www-form-urlencoded"}
    answer = await robot.http.post("/tasks", content=body, headers=form)

    assert answer.status_code == 201


async def test_a_large_task_goes_through_the_worker_and_is_the_same(robot: HttpRobot) -> None:
    csv = "".join(f"{x / 100:.2f},0,0\n" for x in range(3_000))
    task = (await post(robot, csv)).json()

    assert task["waypoint_count"] == 3_000
    assert task["length_m"] == pytest.approx(29.99)


@pytest.mark.parametrize("points", [11, 3_000])
async def test_the_first_task_makes_a_thread_load_numpy(robot: HttpRobot, points: int) -> None:
    csv = "".join(f"{x},0,0\n" for x in range(points))
    with numpy_not_loaded() as numpy:
        answers = [await post(robot, csv) for _ in range(2)]

    assert [answer.status_code for answer in answers] == [201, 201]
    (thread,) = numpy.threads
    assert thread is not threading.current_thread()


async def test_a_robot_that_is_only_watched_needs_no_numpy(robot: HttpRobot) -> None:
    with numpy_not_loaded() as numpy:
        await robot.get("/tasks")
        preview = await robot.http.post("/tasks/preview", content=LINE, headers=CSV)
        await robot.http.delete("/tasks/current")

    assert preview.status_code == 200
    assert numpy.threads == []


async def test_a_compass_is_converted_when_told(robot: HttpRobot) -> None:
    north = "0,0,0\n0,2,0\n0,4,0\n"
    assert (await post(robot, north, heading="compass")).status_code == 201
    items = (await robot.get("/tasks/t1/waypoints"))["items"]

    assert items[0]["yaw_rad"] == pytest.approx(1.570796, abs=1e-6)


@pytest.mark.parametrize(
    ("csv", "line", "word"),
    [
        ("a,b,c\n0,0,0\n1,0,0\n", 1, "columns"),
        ("0,0,0\n1,zero,0\n", 2, "zero"),
        ("0,0,0\nnan,0,0\n2,0,0\n", 2, "nan"),
        ("0,0,0\n1,0\n", 2, "column"),
        ("", 1, ""),
        ("0,0,0\n", 1, ""),
    ],
)
async def test_a_refused_file_names_the_line_and_changes_nothing(
    robot: HttpRobot, csv: str, line: int, word: str
) -> None:
    answer = await post(robot, csv)
    problem = answer.json()

    assert answer.status_code == 422
    assert problem["code"] == "INVALID_WAYPOINTS"
    assert problem["findings"][0]["line"] == line
    assert word in (problem["findings"][0]["message"] + problem.get("hint", "")).lower()
    assert (await robot.get("/tasks"))["items"] == []


async def test_headings_that_fit_in_no_unit_are_refused_until_it_is_said_what_they_are(
    robot: HttpRobot,
) -> None:
    widths = "".join(f"{x},0,2.0\n" for x in range(6))
    widths += "".join(f"5,{y},2.0\n" for y in range(1, 9))
    answer = await post(robot, widths)

    assert answer.status_code == 422
    assert answer.json()["findings"][0]["code"] == "HEADINGS_MISFIT"
    assert "?columns=x,y" in answer.json()["hint"]
    assert (await robot.get("/tasks"))["items"] == []
    assert (await post(robot, widths, columns="x,y,width")).status_code == 201
    assert (await post(robot, widths, heading="rad")).status_code == 201


async def test_columns_are_taken_from_a_header_or_from_the_query(robot: HttpRobot) -> None:
    rows = "".join(f"{x};{x},5;0,0\n" for x in range(11))
    assert (await post(robot, "# s_m; x_m; y_m\n" + rows)).status_code == 201
    assert (await post(robot, rows)).status_code == 422
    assert (await post(robot, rows, columns="s,x,y")).status_code == 201
    items = (await robot.get("/tasks/t2/waypoints"))["items"]

    assert items[1] == {"x_m": 1.5, "y_m": 0.0, "yaw_rad": 0.0}


async def test_columns_without_x_and_y_are_refused(robot: HttpRobot) -> None:
    answer = await post(robot, LINE, columns="s,yaw")

    assert answer.status_code == 422
    assert "query columns: no column is named x" in answer.json()["detail"]


async def test_columns_of_json_are_refused(robot: HttpRobot) -> None:
    answer = await robot.http.post("/tasks?columns=x,y", json={"waypoints": WAYPOINTS})

    assert answer.status_code == 422
    assert "columns in the query is for a CSV" in answer.json()["detail"]


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"waypoints": WAYPOINTS[:1]}, "/waypoints"),
        ({"waypoints": []}, "/waypoints"),
        ({"waypoints": [WAYPOINTS[0], {**WAYPOINTS[1], "x_m": 2e7}]}, "/waypoints/1/x_m"),
        ({"waypoints": [WAYPOINTS[0], {"x_m": 1.0}]}, "/waypoints/1/y_m"),
        ({"waypoints": [WAYPOINTS[0]] * 3}, "/waypoints"),
        ({"start_index": -1}, "/start_index"),
        ({"start_index": 10}, "/start_index"),
        ({"controller": "magic"}, "/controller"),
        ({"speed_mps": 0}, "/speed_mps"),
        ({"speed_mps": 12}, "/speed_mps"),
        ({"speed_mps": "fast"}, "/speed_mps"),
        ({"colour": "red"}, "/colour"),
    ],
)
async def test_what_cannot_be_driven_is_refused_with_the_place_in_the_body(
    robot: HttpRobot, change: dict[str, Any], pointer: str
) -> None:
    answer = await robot.http.post("/tasks", json={"waypoints": WAYPOINTS, **change})

    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert (await robot.get("/tasks"))["items"] == []


async def test_a_path_that_begins_far_away_is_refused_with_a_hint(robot: HttpRobot) -> None:
    answer = await post(robot, "50,0,0\n60,0,0\n")

    assert (answer.status_code, answer.json()["code"]) == (422, "FAR_START")
    assert "start_index" in answer.json()["hint"]
    assert "available" not in answer.json(), "all of it is far away"


async def test_a_path_that_passes_by_can_be_begun_where_it_is_nearest(robot: HttpRobot) -> None:
    passing = "".join(f"{x},1,0\n" for x in range(-20, 21))
    refused = (await post(robot, passing)).json()
    assert refused["hint"] == "waypoint 20 is 1.0 m away: start there with start_index"
    assert refused["errors"][0]["pointer"] == "/waypoints"
    answer = await post(robot, passing, start_index=int(refused["available"][0]))

    assert answer.status_code == 201


async def test_options_in_the_query_are_not_silently_ignored_beside_json(
    robot: HttpRobot,
) -> None:
    answer = await robot.http.post("/tasks?controller=stanley", json={"waypoints": WAYPOINTS})

    assert answer.status_code == 422
    assert "controller in the query is for a CSV" in answer.json()["detail"]


@pytest.mark.parametrize("times", [1, 100])
async def test_a_csv_that_does_not_say_so_is_refused_with_what_to_say(
    robot: HttpRobot, times: int
) -> None:
    answer = await robot.http.post("/tasks", content=LINE * times)

    assert (answer.status_code, answer.json()["code"]) == (400, "MALFORMED")
    assert answer.json()["hint"] == "send a CSV with Content-Type: text/csv"


# --- looking and ending --------------------------------------------------------------------------


async def test_a_task_shows_how_far_it_is_and_how_it_ended(robot: HttpRobot) -> None:
    await post(robot)
    await robot.pass_time(3)
    current = await robot.get("/tasks/current")
    assert 0.2 < current["progress"] < 0.9
    assert current["progress"] == pytest.approx(current["distance_m"] / 10, abs=1e-5)
    await robot.pass_time(8)
    ended = await robot.get("/tasks/t1")

    assert (ended["status"], ended["progress"]) == ("SUCCEEDED", 1.0)
    assert ended["ended_at"] > ended["created_at"]


async def test_without_a_task_there_is_no_current_one(robot: HttpRobot) -> None:
    answer = await robot.http.get("/tasks/current")

    assert (answer.status_code, answer.json()["code"]) == (404, "UNKNOWN_TASK")


async def test_cancel_is_right_with_and_without_a_task(robot: HttpRobot) -> None:
    await post(robot)
    assert (await robot.http.delete("/tasks/current")).status_code == 204
    assert (await robot.http.delete("/tasks/current")).status_code == 204

    assert (await robot.get("/tasks/t1"))["status"] == "CANCELED"


async def test_tasks_are_listed_the_newest_first(robot: HttpRobot) -> None:
    await post(robot)
    await post(robot)
    items = (await robot.get("/tasks"))["items"]

    assert [(item["id"], item["status"]) for item in items] == [
        ("t2", "RUNNING"),
        ("t1", "CANCELED"),
    ]


@pytest.mark.parametrize("path", ["/tasks/t9", "/tasks/t9/waypoints", "/tasks/current/waypoints"])
async def test_a_task_that_is_not_there_is_404(robot: HttpRobot, path: str) -> None:
    assert (await robot.http.get(path)).status_code == 404


async def test_waypoints_come_back_as_they_were_sent(robot: HttpRobot) -> None:
    await post(robot)
    answer = await robot.get("/tasks/current/waypoints")

    assert answer == {
        "waypoint_count": 11,
        "indices": list(range(11)),
        "items": WAYPOINTS,
    }


async def test_waypoints_can_be_thinned_for_drawing(robot: HttpRobot) -> None:
    await post(robot, "".join(f"{x / 10},0,0\n" for x in range(2_001)))
    answer = await robot.get("/tasks/t1/waypoints?max_points=5")

    assert (answer["waypoint_count"], answer["indices"]) == (2_001, [0, 500, 1000, 1500, 2000])


# --- preview -------------------------------------------------------------------------------------


async def test_a_preview_tells_of_the_path_and_starts_nothing(robot: HttpRobot) -> None:
    answer = await robot.http.post("/tasks/preview", content=LINE, headers=CSV)
    shown = answer.json()

    assert answer.status_code == 200
    assert (shown["waypoint_count"], shown["length_m"]) == (11, 10.0)
    assert shown["start"] == {"distance_m": 0.0, "heading_error_rad": 0.0}
    assert shown["steerable"] is True
    assert shown["items"][1] == {"x_m": 1.0, "y_m": 0.0}
    assert (await robot.get("/tasks"))["items"] == []


async def test_a_preview_warns_of_a_bend_that_the_vehicle_cannot_steer(robot: HttpRobot) -> None:
    corner = [(x / 2, 0.0) for x in range(11)] + [(5.0, y / 2) for y in range(1, 11)]
    body = {"waypoints": [{"x_m": x, "y_m": y, "yaw_rad": 0.0} for x, y in corner]}
    shown = (await robot.http.post("/tasks/preview", json=body)).json()

    assert shown["steerable"] is False
    assert "TOO_TIGHT" in [warning["code"] for warning in shown["warnings"]]


@pytest.mark.parametrize("yaw_rad", [0.0, pi / 2, pi])
async def test_a_preview_says_how_a_path_beside_the_vehicle_is_approached(
    robot: HttpRobot, yaw_rad: float
) -> None:
    beside = f"0,3.5,{yaw_rad}\n50,3.5,0\n100,3.5,0\n"
    answer = await robot.http.post("/tasks/preview", content=beside, headers=CSV)
    approach = answer.json()["approach"]

    assert approach["distance_m"] == pytest.approx(3.5)
    assert 0 < approach["speed_mps"] <= 1.0
    assert 3.5 < approach["length_m"] < 15.0
    assert (await post(robot, beside)).status_code == 201


@pytest.mark.parametrize("start_index", [0, 5])
async def test_a_preview_says_from_where_a_task_is_refused(
    robot: HttpRobot, start_index: int
) -> None:
    far = "".join(f"{x},5.1,0\n" for x in range(11))
    query = {"start_index": start_index}
    answer = await robot.http.post("/tasks/preview", content=far, headers=CSV, params=query)
    shown = answer.json()

    assert shown["approach"] is None
    (warning,) = [found for found in shown["warnings"] if found["code"] == "FAR_START"]
    assert warning["index"] == start_index
    assert warning["message"].endswith("and is approached from at most 5 m")
    refused = await post(robot, far, start_index=start_index)
    assert (refused.status_code, refused.json()["code"]) == (422, "FAR_START")


async def test_a_preview_refuses_a_start_that_does_not_exist(robot: HttpRobot) -> None:
    query = {"start_index": 10}
    answer = await robot.http.post("/tasks/preview", content=LINE, headers=CSV, params=query)

    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/start_index"


async def test_a_preview_refuses_what_a_task_would(robot: HttpRobot) -> None:
    answer = await robot.http.post("/tasks/preview", content="x,y,yaw\n", headers=CSV)

    assert (answer.status_code, answer.json()["code"]) == (422, "INVALID_WAYPOINTS")


def test_the_line_of_these_tests_is_a_waypoint_file() -> None:
    assert read_waypoints_csv(LINE).shape == (11, 3)
