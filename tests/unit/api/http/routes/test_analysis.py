"""`/analysis`: what leads to the errors that stop the task."""

from tests.support.http_robot import HttpRobot, http_robot

CARRIER = """\
carrier:
  ros__parameters:
    type: system
    modes: {__DEFAULT__: {lidar: active, camera: active}}
    errors: {BLIND: {caused_by: [lidar.SILENT, camera.SILENT, ESTOP], severity: fatal}}
lidar: {ros__parameters: {type: node, errors: {SILENT: {when: "not lidar.reachable"}}}}
camera: {ros__parameters: {type: node, errors: {SILENT: {caused_by: [camera.UNREACHABLE]}}}}
"""


async def test_each_error_that_stops_the_task_has_its_cut_sets(robot: HttpRobot) -> None:
    errors = (await robot.get("/analysis"))["errors"]

    assert {
        "part": None,
        "error": "ESTOP",
        "severity": "critical",
        "cut_sets": [[{"part": None, "error": "ESTOP"}]],
        "incomplete": None,
    } in errors
    assert len(errors) == 7


async def test_an_error_that_follows_is_resolved_into_those_that_raise_it() -> None:
    async with http_robot(CARRIER) as robot:
        *_, blind = (await robot.get("/analysis"))["errors"]

    assert (blind["part"], blind["error"], blind["severity"]) == ("carrier", "BLIND", "fatal")
    assert blind["cut_sets"] == [
        [{"part": None, "error": "ESTOP"}],
        [{"part": "lidar", "error": "SILENT"}],
        [{"part": "camera", "error": "UNREACHABLE"}],
    ]
