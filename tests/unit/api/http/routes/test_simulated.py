"""`/simulated`: faults of what is simulated, while it runs."""

import pytest

from tests.support.http_robot import HttpRobot


async def change(robot: HttpRobot, what: str, **body: object) -> tuple[int, object]:
    answer = await robot.http.patch(f"/simulated/{what}", json=body)
    return answer.status_code, answer.json()


async def test_what_is_simulated_is_listed_with_its_faults(robot: HttpRobot) -> None:
    await change(robot, "nodes/manipulator", fault="slow")
    await change(robot, "vehicle", fault="weak_brakes")

    assert await robot.get("/simulated") == {
        "nodes": [
            {"node": "drive_base", "fault": None},
            {"node": "manipulator", "fault": "slow"},
        ],
        "vehicle": {"fault": "weak_brakes"},
    }


async def test_a_node_dies_and_recovers(robot: HttpRobot) -> None:
    died = await change(robot, "nodes/drive_base", fault="die")
    await robot.pass_time(2)

    assert died == (200, {"node": "drive_base", "fault": "die"})
    assert (await robot.get("/nodes/drive_base"))["reachable"] is False

    recovered = await change(robot, "nodes/drive_base", fault="recover")
    await robot.pass_time(1)

    assert recovered == (200, {"node": "drive_base", "fault": None})
    assert (await robot.get("/nodes/drive_base"))["actual"]["state"] == "unconfigured"


async def test_parameters_change_as_another_program_would_do_it(robot: HttpRobot) -> None:
    await robot.bring_to("drive_base", "SLOW")

    await change(robot, "nodes/drive_base", parameters={"max_speed": 0.9, "controller": "MPC"})
    await robot.pass_time(0.1)

    assert (await robot.get("/nodes/drive_base/mode"))["mode"] == "FAST"


async def test_a_parameter_that_there_is_not_is_told_and_changes_nothing(robot: HttpRobot) -> None:
    status, problem = await change(robot, "nodes/drive_base", parameters={"speed": 1.0})

    assert (status, isinstance(problem, dict)) == (422, True)


async def test_the_vehicle_loses_its_pose_and_finds_it(robot: HttpRobot) -> None:
    await robot.pass_time(0.2)
    before = (await robot.get("/vehicle"))["at"]

    await change(robot, "vehicle", fault="silent")
    await robot.pass_time(2)
    assert (await robot.get("/vehicle"))["at"] == before

    await change(robot, "vehicle", fault="recover")
    await robot.pass_time(0.2)
    assert (await robot.get("/vehicle"))["at"] > before


@pytest.mark.parametrize(
    ("node", "status", "code"),
    [("gripper", 404, "UNKNOWN_PART"), ("actuation", 404, "UNKNOWN_PART")],
)
async def test_what_is_no_node_is_told(node: str, status: int, code: str, robot: HttpRobot) -> None:
    found, problem = await change(robot, f"nodes/{node}", fault="die")

    assert isinstance(problem, dict)
    assert (found, problem["code"]) == (status, code)


@pytest.mark.parametrize("what", ["nodes/drive_base", "vehicle"])
async def test_what_is_real_gets_no_fault(what: str, robot: HttpRobot) -> None:
    robot.supervisor.live_faults = None

    status, problem = await change(robot, what, fault="silent")

    assert isinstance(problem, dict)
    assert (status, problem["code"]) == (409, "NOT_SIMULATED")
    assert await robot.get("/simulated") == {"nodes": [], "vehicle": None}


async def test_where_the_vehicle_is_elsewhere_only_nodes_get_faults(robot: HttpRobot) -> None:
    robot.supervisor.simulated = ("nodes",)

    status, _ = await change(robot, "vehicle", fault="silent")

    assert status == 409
    assert (await robot.get("/simulated"))["vehicle"] is None


async def test_a_fault_is_on_record(robot: HttpRobot) -> None:
    await change(robot, "nodes/drive_base", fault="refuse")

    written = (await robot.get("/events?kind=audit.write"))["items"]
    assert [event["data"]["path"] for event in written] == ["/simulated/nodes/drive_base"]


async def test_a_scenario_sets_faults_by_requests_as_well(robot: HttpRobot) -> None:
    body = {
        "until_s": 3,
        "steps": [
            {
                "t_s": 1,
                "request": {
                    "method": "PATCH",
                    "path": "/simulated/nodes/drive_base",
                    "body": {"fault": "die"},
                },
            },
            {"t_s": 3, "expect": {"events": {"node.unreachable": 1}}},
        ],
    }

    answer = (await robot.http.post("/simulations", json=body)).json()

    assert answer["refusals"] == []
    assert [each["differences"] for each in answer["expectations"]] == [[]]
    assert (await robot.get("/nodes/drive_base"))["reachable"] is True, "the live one is untouched"
